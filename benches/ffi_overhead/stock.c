/* The two interfaces (19) by plain C and stock CVODES: serial vectors, dense direct solver, analytic Jacobian.
 *
 * A child of the benches. Reads lines "WHAT RTOL T REPEAT", WHAT one of bdf, adams and tangent, and answers each with
 * "SECONDS STEPS Y0 Y1 Y2 [M, 9 numbers by columns]", the time of all repeats together and the last result, or with what
 * failed. */
#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <time.h>

#if SUNDIALS_VERSION_MAJOR >= 7
#define NO_COMM SUN_COMM_NULL
#else
#define NO_COMM NULL
#endif
/* CLOCK_MONOTONIC, or CLOCK_THREAD_CPUTIME_ID. */
#ifndef CLOCK
#define CLOCK CLOCK_MONOTONIC
#endif
#define OK(call)                                                  \
  do {                                                            \
    if ((call) < 0) { fprintf(stderr, "%s failed\n", #call); exit(1); } \
  } while (0)

/* v = a(tau) / (c + p psi)^beta, dpsi/dt = h - (q + |v|) psi, with a = gamma0 sinh(tau) if odd, else gamma0/2 exp(tau) */
typedef struct {
  double k, v_h, beta, gamma0, c, p, h, q;
  int odd;
} Model;

static double activation(const Model* m, double tau) { return m->gamma0 * (m->odd ? sinh(tau) : 0.5 * exp(tau)); }

static double slope(const Model* m, double tau) { return m->gamma0 * (m->odd ? cosh(tau) : 0.5 * exp(tau)); }

/* v and dw/dt of one interface, with the derivatives of v by s and w, and of dw/dt by w at constant v */
typedef struct {
  double v, g, v_w, g_w;
} Response;

static Response response(const Model* m, double s, double w) {
  double psi = exp(w);
  double strength = m->c + m->p * psi;
  double v = s / pow(strength, m->beta);
  double heal = m->h / psi;
  Response out = {v, heal - m->q - fabs(v), -v * m->beta * m->p * psi / strength, -heal};
  return out;
}

static int f(double t, N_Vector y, N_Vector dy, void* data) {
  const Model* m = data;
  double *u = N_VGetArrayPointer(y), *out = N_VGetArrayPointer(dy);
  double s = activation(m, u[0]);
  Response a = response(m, s, u[1]), b = response(m, s, u[2]);
  out[0] = m->k * (m->v_h - a.v - b.v);
  out[1] = a.g;
  out[2] = b.g;
  return 0;
}

/* J by rows */
static void jacobian(const Model* m, const double* u, double j[9]) {
  double s = activation(m, u[0]), ds = slope(m, u[0]) / s;
  Response a = response(m, s, u[1]), b = response(m, s, u[2]);
  double sa = a.v > 0 ? 1.0 : -1.0, sb = b.v > 0 ? 1.0 : -1.0;
  double a_tau = a.v * ds, b_tau = b.v * ds;
  j[0] = -m->k * (a_tau + b_tau); j[1] = -m->k * a.v_w;         j[2] = -m->k * b.v_w;
  j[3] = -sa * a_tau;             j[4] = a.g_w - sa * a.v_w;    j[5] = 0.0;
  j[6] = -sb * b_tau;             j[7] = 0.0;                   j[8] = b.g_w - sb * b.v_w;
}

static int dense_jacobian(double t, N_Vector y, N_Vector fy, SUNMatrix a, void* data, N_Vector x1, N_Vector x2,
                          N_Vector x3) {
  double j[9], *out = SUNDenseMatrix_Data(a);
  jacobian(data, N_VGetArrayPointer(y), j);
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 3; column++) out[3 * column + row] = j[3 * row + column];
  return 0;
}

static int sensitivity(int count, double t, N_Vector y, N_Vector dy, N_Vector* s, N_Vector* ds, void* data, N_Vector x1,
                       N_Vector x2) {
  double j[9];
  jacobian(data, N_VGetArrayPointer(y), j);
  for (int i = 0; i < count; i++) {
    double *in = N_VGetArrayPointer(s[i]), *out = N_VGetArrayPointer(ds[i]);
    for (int row = 0; row < 3; row++)
      out[row] = j[3 * row] * in[0] + j[3 * row + 1] * in[1] + j[3 * row + 2] * in[2];
  }
  return 0;
}

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

static void start(N_Vector y, N_Vector* s, const double* y0) {
  memcpy(N_VGetArrayPointer(y), y0, 3 * sizeof(double));
  for (int i = 0; i < 3; i++) {
    N_VConst(0.0, s[i]);
    N_VGetArrayPointer(s[i])[i] = 1.0;
  }
}

int main(int argc, char** argv) {
  if (argc != 13) return 2;
  double x[12];
  for (int i = 0; i < 12; i++) x[i] = atof(argv[i + 1]);
  Model m = {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8] != 0.0};
  const double* y0 = x + 9;

  SUNContext context;
  OK(SUNContext_Create(NO_COMM, &context));
  N_Vector y = N_VNew_Serial(3, context);
  N_Vector* s = N_VCloneVectorArray(3, y);
  start(y, s, y0);
  SUNMatrix a = SUNDenseMatrix(3, 3, context);
  SUNLinearSolver solver = SUNLinSol_Dense(y, a, context);
  /* One memory for each thing to do. */
  enum { BDF, ADAMS, TANGENT, COUNT };
  const char* names[COUNT] = {"bdf", "adams", "tangent"};
  void* memory[COUNT];
  for (int i = 0; i < COUNT; i++) {
    memory[i] = CVodeCreate(i == ADAMS ? CV_ADAMS : CV_BDF, context);
    OK(CVodeInit(memory[i], f, 0.0, y));
    OK(CVodeSetUserData(memory[i], &m));
    OK(CVodeSStolerances(memory[i], 1e-8, 1e-8));
    OK(CVodeSetMaxNumSteps(memory[i], 100000000));
    OK(CVodeSetLinearSolver(memory[i], solver, a));
    OK(CVodeSetJacFn(memory[i], dense_jacobian));
  }
  OK(CVodeSensInit(memory[TANGENT], 3, CV_SIMULTANEOUS, sensitivity, s));
  OK(CVodeSetSensErrCon(memory[TANGENT], SUNTRUE));

  char what[16];
  double rtol, end;
  int repeat;
  while (scanf("%15s %lf %lf %d", what, &rtol, &end, &repeat) == 4) {
    int chosen = 0;
    while (chosen < COUNT && strcmp(what, names[chosen]) != 0) chosen++;
    if (chosen == COUNT) return 2;
    int tangent = chosen == TANGENT;
    void* mem = memory[chosen];
    double atol_s[3] = {rtol, rtol, rtol}, t;
    int flag = 0;
    double begin = seconds();
    for (int i = 0; i < repeat && flag >= 0; i++) {
      start(y, s, y0);
      OK(CVodeReInit(mem, 0.0, y));
      OK(CVodeSStolerances(mem, rtol, rtol));
      if (tangent) {
        OK(CVodeSensReInit(mem, CV_SIMULTANEOUS, s));
        OK(CVodeSensSStolerances(mem, rtol, atol_s));
      }
      flag = CVode(mem, end, y, &t, CV_NORMAL);
      if (tangent && flag >= 0) OK(CVodeGetSens(mem, &t, s));
    }
    double elapsed = seconds() - begin;
    if (flag < 0) {
      char* name = CVodeGetReturnFlagName(flag);
      printf("CVode returned %s at t = %g\n", name, t);
      free(name);
      fflush(stdout);
      continue;
    }
    long steps;
    OK(CVodeGetNumSteps(mem, &steps));
    double* u = N_VGetArrayPointer(y);
    printf("%.9e %ld %.17g %.17g %.17g", elapsed, steps, u[0], u[1], u[2]);
    if (tangent)
      for (int i = 0; i < 9; i++) printf(" %.17g", N_VGetArrayPointer(s[i / 3])[i % 3]);
    printf("\n");
    fflush(stdout);
  }
  for (int i = 0; i < COUNT; i++) CVodeFree(&memory[i]);
  SUNLinSolFree(solver);
  SUNMatDestroy(a);
  N_VDestroyVectorArray(s, 3);
  N_VDestroy(y);
  SUNContext_Free(&context);
  return 0;
}
