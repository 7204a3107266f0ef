/* CVODE of SUNDIALS (6 or newer) in plain C: dense matrix, exact Jacobian. Reads lines `METHOD RTOL RUNS` (METHOD: BDF or
 * Adams) and answers `SECONDS STATE...`, the median of the runs, or `failed CODE`. system.h is written by cvode_runner.py:
 * N, STRETCHES, start, sizes, ends, set_parameters, rates, jacobian. */
#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <time.h>

#include "system.h"

enum { RUNS_AT_MOST = 99 };
static const double LONG = 0.05;     /* seconds: a run as long is made once */
static const double SHORTEST = 0.002; /* seconds of each measurement */

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

static int f(realtype t, N_Vector y, N_Vector ydot, void *data) {
    (void)data;
    double *out = N_VGetArrayPointer(ydot);
    rates(t, N_VGetArrayPointer(y), out);
    /* a trial state outside of the formulas: a shorter step is wanted */
    for (int i = 0; i < N; i++)
        if (!isfinite(out[i])) return 1;
    return 0;
}

static int jac(realtype t, N_Vector y, N_Vector fy, SUNMatrix matrix, void *data, N_Vector a, N_Vector b, N_Vector c) {
    (void)fy, (void)data, (void)a, (void)b, (void)c;
    double entries[N * N];
    jacobian(t, N_VGetArrayPointer(y), entries);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) SM_ELEMENT_D(matrix, i, j) = entries[N * i + j];
    return 0;
}

static int solve(void *solver, N_Vector y) {
    realtype t = 0.0;
    memcpy(N_VGetArrayPointer(y), start, sizeof start);
    for (int i = 0; i < STRETCHES; i++) {
        set_parameters(i);
        int code = CVodeReInit(solver, t, y);
        if (code == CV_SUCCESS) code = CVodeSetStopTime(solver, ends[i]);
        if (code == CV_SUCCESS) code = CVode(solver, ends[i], y, &t, CV_NORMAL);
        if (code != CV_SUCCESS && code != CV_TSTOP_RETURN) return code;
    }
    return 0;
}

static void silent(int code, const char *module, const char *function, char *message, void *data) {
    (void)code, (void)module, (void)function, (void)message, (void)data;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(void) {
    char method[16];
    double rtol, times[RUNS_AT_MOST];
    int runs;
    SUNContext context;
    if (SUNContext_Create(NULL, &context)) return 1;
    N_Vector y = N_VNew_Serial(N, context), atol = N_VNew_Serial(N, context);
    SUNMatrix matrix = SUNDenseMatrix(N, N, context);
    SUNLinearSolver linear = SUNLinSol_Dense(y, matrix, context);
    while (scanf("%15s %lf %d", method, &rtol, &runs) == 3 && runs <= RUNS_AT_MOST) {
        void *solver = CVodeCreate(strcmp(method, "BDF") ? CV_ADAMS : CV_BDF, context);
        for (int i = 0; i < N; i++) {
            NV_Ith_S(atol, i) = rtol * sizes[i];
            NV_Ith_S(y, i) = start[i];
        }
        set_parameters(0);
        if (!solver || CVodeInit(solver, f, 0.0, y) || CVodeSVtolerances(solver, rtol, atol) ||
            CVodeSetLinearSolver(solver, linear, matrix) || CVodeSetJacFn(solver, jac) || CVodeSetMaxNumSteps(solver, 10000000) ||
            CVodeSetErrHandlerFn(solver, silent, NULL))
            return 1;
        double begin = now();
        int code = solve(solver, y);
        double seconds = now() - begin;
        if (code) {
            printf("failed %d\n", code);
        } else {
            if (seconds < LONG) {
                int repeat = seconds < SHORTEST ? (int)(SHORTEST / (seconds + 1e-9)) + 1 : 1;
                for (int run = 0; run < runs; run++) {
                    begin = now();
                    for (int i = 0; i < repeat; i++) solve(solver, y);
                    times[run] = (now() - begin) / repeat;
                }
                qsort(times, runs, sizeof times[0], ascending);
                seconds = times[runs / 2];
            }
            printf("%.6e", seconds);
            for (int i = 0; i < N; i++) printf(" %.17g", NV_Ith_S(y, i));
            printf("\n");
        }
        fflush(stdout);
        CVodeFree(&solver);
    }
    return 0;
}
