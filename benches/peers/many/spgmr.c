/* Interfaces under one stress by CVODE's BDF as one would write it in C: serial vectors, and SPGMR without preconditioner or a dense
 * matrix by differences. Variables are tau and ln psi of each.
 *
 *   spgmr N RTOL UNTIL spgmr|dense
 *
 * prints seconds, steps, evaluations of f, tau and ln psi of the first at the end. */
#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunlinsol/sunlinsol_spgmr.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <time.h>

/* The spinodal law (35) with the paper's constants. */
static const double a = 0.0349, b = 0.0489, a_v = 0.369, R = 100.0, c = 1e-3;
static double driving, stiffness, gamma0, beta;
static long n;

static int f(double t, N_Vector y, N_Vector dy, void *data) {
    (void)t, (void)data;
    const double *x = N_VGetArrayPointer(y);
    double *rate = N_VGetArrayPointer(dy);
    double s = gamma0 * sinh(x[0]), sum = 0.0;
    for (long i = 1; i <= n; i++) {
        double psi = exp(x[i]);
        double v = s * pow(c + (1.0 + R) * psi, -beta);
        rate[i] = (1.0 / psi - 1.0) / R - v;
        sum += v;
    }
    rate[0] = stiffness * (driving - sum);
    return 0;
}

int main(int count, char **words) {
    if (count != 5) return 2;
    n = atol(words[1]);
    double rtol = atof(words[2]), until = atof(words[3]), share = n / 10.0, t = 0.0;
    driving = 10.0 * share, stiffness = 0.14 / share, beta = b / a, gamma0 = 2.0 * exp(-a_v / a);
    SUNContext context;
    SUNContext_Create(NULL, &context);
    N_Vector y = N_VNew_Serial(n + 1, context);
    double *x = N_VGetArrayPointer(y);
    x[0] = 9.9;
    for (long i = 1; i <= n; i++) x[i] = log(0.002 * (1.0 + 1e-2 * ((i - 1) % 97)));
    void *m = CVodeCreate(CV_BDF, context);
    CVodeInit(m, f, 0.0, y);
    CVodeSStolerances(m, rtol, rtol);
    CVodeSetMaxNumSteps(m, 1000000);
    if (strcmp(words[4], "dense") == 0) {
        SUNMatrix j = SUNDenseMatrix(n + 1, n + 1, context);
        CVodeSetLinearSolver(m, SUNLinSol_Dense(y, j, context), j);
    } else {
        CVodeSetLinearSolver(m, SUNLinSol_SPGMR(y, SUN_PREC_NONE, 0, context), NULL);
    }
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    int code = CVode(m, until, y, &t, CV_NORMAL);
    clock_gettime(CLOCK_MONOTONIC, &end);
    long steps, evaluations;
    CVodeGetNumSteps(m, &steps);
    CVodeGetNumRhsEvals(m, &evaluations);
    printf("%.6f %ld %ld %.17g %.17g\n", (end.tv_sec - begin.tv_sec) + 1e-9 * (end.tv_nsec - begin.tv_nsec), steps, evaluations, x[0], x[1]);
    return code < 0;
}
