/* A verification case: figures of the literature or of mathematics, with what spar gives beside them. Every figure goes
   into a table that `ctest -L verification` prints and tests/verification/table turns into
   docs/evidence/verification.md. */
#ifndef VERIFICATION_H
#define VERIFICATION_H

#include "scene.h"

#include <errno.h>
#include <stdio.h>
#include <sys/stat.h>

static FILE *verification_file;
static int verification_failures;

/* The table's next line: |got - expected| <= tolerance. All figures of a test are taken before it fails. */
static inline void verify(const char *what, double got, double expected, double tolerance, const char *source) {
    double error = fabs(got - expected);
    int ok = error <= tolerance;
    verification_failures += !ok;
    printf("%-44s %18.11g %18.11g %9.1e %9.1e %s  %s\n", what, expected, got, error, tolerance, ok ? "ok  " : "FAIL",
           source);
    if (verification_file) {
        fprintf(verification_file, "%s\t%.11g\t%.11g\t%.1e\t%.1e\t%s\t%s\n", what, expected, got, error, tolerance,
                ok ? "ok" : "FAIL", source);
    }
}

static inline void verify_3(const char *what, const double got[3], const double expected[3], double tolerance,
                            const char *source) {
    for (int i = 0; i < 3; i++) {
        char line[96];
        snprintf(line, sizeof line, "%s, %c", what, "xyz"[i]);
        verify(line, got[i], expected[i], tolerance, source);
    }
}

/* Each test ends with it. */
static inline void verified(void) {
    int failures = verification_failures;
    verification_failures = 0;
    assert_int_equal(failures, 0);
}

/* Extrapolates to dt = 0 a figure at dt and dt/2 whose error is of order 2. */
static inline double richardson(double coarse, double fine) {
    return fine + (fine - coarse) / 3;
}

/* The same from three steps dt, dt/2, dt/4, with errors of order 2 and then of order `next`. */
static inline double richardson_3(double a, double b, double c, int next) {
    double first = richardson(a, b), second = richardson(b, c);
    return second + (second - first) / (pow(2, next) - 1);
}

/* The long, converged form of a case: SPAR_VERIFICATION=long in the environment. */
static inline int verification_long(void) {
    const char *form = getenv("SPAR_VERIFICATION");
    return form && strcmp(form, "long") == 0;
}

/* Runs the tests of one file under its title; lines go to verification/<program>.tsv in the working directory. */
static inline int verification_main(const char *program, const char *title, const struct CMUnitTest *tests, size_t n) {
    char path[512];
    const char *slash = strrchr(program, '/');
    if (mkdir("verification", 0777) == 0 || errno == EEXIST) {
        snprintf(path, sizeof path, "verification/%s.tsv", slash ? slash + 1 : program);
        verification_file = fopen(path, "w");
    }
    if (verification_file) {
        fprintf(verification_file, "%s\n", title);
    }
    printf("%s\n%-44s %18s %18s %9s %9s\n", title, "figure", "expected", "got", "error", "tolerance");
    int failed = _cmocka_run_group_tests(title, tests, n, NULL, NULL);
    if (verification_file) {
        fclose(verification_file);
    }
    return failed;
}

#define VERIFICATION_MAIN(title, ...)                                                                                  \
    int main(int argc, char **argv) {                                                                                  \
        const struct CMUnitTest tests[] = {__VA_ARGS__};                                                               \
        (void)argc;                                                                                                    \
        return verification_main(argv[0], title, tests, sizeof tests / sizeof *tests);                                 \
    }

#endif
