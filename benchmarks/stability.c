/* Eigenvalues of small motions, as curves; CSV on standard output.

   stability campbell   angular frequencies of a turning uniform blade over its speed, units of sqrt(EI / m L^4)
   stability beck       growth rate and frequency of a column over the follower force at its tip, units of EI / L^2 */
#include "beam_scene.h"

#include <stdio.h>

enum { NODES = 14, FIRST = 5 };

static void diagonal(double m[36], double a, double d, double b) {
    const double x[6] = {a, a, a, d, b, b};
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = x[i];
    }
}

/* A slender beam of unit length, bending stiffness and mass. */
static spar_member *slender(spar_session *s, int root, double speed) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 1, 0, 0}, w[3] = {0, 0, speed};
    double K[36], M[36];
    spar_member *b;
    diagonal(K, 1e7, 1e4, 1);
    diagonal(M, 1, 2e-8, 1e-8);
    MUST(s, spar_beam_create(s, "beam", 1, NODES, &b));
    MUST(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
    MUST(s, spar_beam_set_sections(b, 1, eta, K, M));
    MUST(s, spar_member_set_root(b, root));
    MUST(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
    MUST(s, spar_member_commit(b));
    return b;
}

static void campbell(void) {
    printf("speed,first,second,third,fourth,fifth\n");
    for (double speed = 0; speed <= 12.01; speed += 0.25) {
        double value[FIRST][2];
        spar_session *s;
        MUST(NULL, spar_session_create(&s));
        spar_member *b = slender(s, SPAR_ROOT_DRIVEN, speed);
        MUST(s, spar_member_solve_static(b, 1));
        MUST(s, spar_member_solve_eigenvalues(b, FIRST, NULL, &value[0][0], NULL, NULL));
        printf("%g", speed);
        for (int i = 0; i < FIRST; i++) {
            printf(",%.8g", value[i][1]);
        }
        printf("\n");
        spar_session_destroy(&s);
    }
}

/* The four lowest: each of two planes alike, in one of which the growing and the decaying motion are a pair. */
static void beck(void) {
    printf("force,growth,frequency,symmetric\n");
    for (double force = 0; force <= 30.01; force += 0.25) {
        const double load[6] = {-force, 0, 0, 0, 0, 0};
        double value[4][2], mode[1];
        spar_session *s;
        MUST(NULL, spar_session_create(&s));
        spar_member *b = slender(s, SPAR_ROOT_FIXED, 0);
        MUST(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_FOLLOWER, load));
        MUST(s, spar_member_solve_static(b, 1));
        MUST(s, spar_member_solve_eigenvalues(b, 4, NULL, &value[0][0], NULL, NULL));
        MUST(s, spar_member_solve_modes(b, 1, mode, NULL));
        for (int i = 0; i < 4; i++) {
            printf("%g,%.8g,%.8g,%.8g\n", force, value[i][0], value[i][1], 6.283185307179586 * mode[0]);
        }
        spar_session_destroy(&s);
    }
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "campbell") == 0) {
        campbell();
    } else if (argc == 2 && strcmp(argv[1], "beck") == 0) {
        beck();
    } else {
        fprintf(stderr, "stability campbell | beck\n");
        return 2;
    }
    return 0;
}
