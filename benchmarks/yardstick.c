/* How fast is this machine? Median time in microseconds of an LU factorisation of a 60 x 60 matrix by GSL over GSL's
   own CBLAS, which is compiled C without tuning. Figures of other codes were taken where it took 39. A program of its
   own, because the library is linked with a faster CBLAS of the same names. */
#include <gsl/gsl_linalg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { SIZE = 60, REPEATS = 2001 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(void) {
    gsl_matrix *A = gsl_matrix_alloc(SIZE, SIZE), *LU = gsl_matrix_alloc(SIZE, SIZE);
    gsl_permutation *p = gsl_permutation_alloc(SIZE);
    static double took[REPEATS];
    unsigned long long seed = 1;
    for (size_t i = 0; i < SIZE; i++) {
        for (size_t j = 0; j < SIZE; j++) {
            seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
            gsl_matrix_set(A, i, j, (double)(seed >> 11) / 9007199254740992.0 - 0.5 + (i == j ? 1 : 0));
        }
    }
    for (int k = 0; k < REPEATS; k++) {
        int sign;
        gsl_matrix_memcpy(LU, A);
        double start = now();
        gsl_linalg_LU_decomp(LU, p, &sign);
        took[k] = now() - start;
    }
    qsort(took, REPEATS, sizeof *took, ascending);
    printf("%.2f\n", took[REPEATS / 2]);
    gsl_matrix_free(A);
    gsl_matrix_free(LU);
    gsl_permutation_free(p);
    return 0;
}
