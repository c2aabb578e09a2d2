/* A clamped beam with a library free of GSL: its first bending frequency, as a mode and as an eigenvalue of the small
   motions, against 1.8751^2 sqrt(EI / (rho A L^4)) / (2 pi). */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_structure.h>
#include <stdio.h>

#define PI 3.14159265358979323846

static int off(const char *what, double value, double exact, double tolerance) {
    printf("%s %.9f, exact %.9f\n", what, value, exact);
    return !(fabs(value - exact) <= tolerance * fabs(exact));
}

int main(void) {
    enum { POINTS = 9 };
    double eta[POINTS], xyz[3 * POINTS] = {0}, K[36] = {0}, M[36] = {0}, frequency[2], eigenvalue[4];
    const double EI = 100, one = 0, shift[2] = {0, 0};
    spar_session *s = NULL;
    spar_member *beam = NULL;
    for (int i = 0; i < POINTS; i++) {
        eta[i] = i / (POINTS - 1.0);
        xyz[3 * i] = 10 * eta[i];
    }
    for (int i = 0; i < 6; i++) {
        K[7 * i] = i < 4 ? 1e7 : i < 5 ? EI : 4 * EI;
        M[7 * i] = i < 3 ? 1 : 1e-6;
    }
    if (spar_has("gsl") || !spar_has("lapack") || spar_session_create(&s) || spar_beam_create(s, "beam", 2, 7, &beam) ||
        spar_beam_set_axis(beam, POINTS, eta, xyz, NULL) || spar_beam_set_sections(beam, 1, &one, K, M) ||
        spar_member_set_root(beam, SPAR_ROOT_FIXED) || spar_member_commit(beam) ||
        spar_member_solve_modes(beam, 2, frequency, NULL) ||
        spar_member_solve_eigenvalues(beam, 2, shift, eigenvalue, NULL, NULL)) {
        fprintf(stderr, "%s\n", spar_session_message(s));
        return 1;
    }
    double first = 1.8751040687 * 1.8751040687 * sqrt(EI) / 100 / (2 * PI);
    int bad = off("mode", frequency[0], first, 1e-4) + off("second mode", frequency[1], 2 * first, 1e-4) +
              off("eigenvalue", eigenvalue[1] / (2 * PI), first, 1e-4);
    spar_session_destroy(&s);
    return bad;
}
