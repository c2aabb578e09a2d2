/* A wing held still in a wind of 10 m/s: chord 1 m, lift coefficient 1, so the lift is rho/2 V^2 chord span = 0.5 1.2
   100 N/m times the distance of its two stations. A refused call leaves its message in the session, as the calls of
   libspar do. */
#include <math.h>
#include <spar/spar_all.h>
#include <stdio.h>
#include <string.h>

int main(void) {
    spar_session *s = NULL;
    spar_member *wing = NULL;
    spar_fluid *air = NULL;
    spar_polar *polar = NULL;
    spar_aero *aero = NULL;
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 3, 0, 0}, alpha[2] = {-1, 1}, cl[2] = {1, 1}, cd[2] = {0, 0};
    const double inflow[6] = {0, 10, 0, 0, 10, 0};
    double K[36] = {0}, M[36] = {0}, force[6], x[6];
    for (int i = 0; i < 6; i++) {
        K[7 * i] = 1e9;
        M[7 * i] = 1;
    }
    if (spar_session_create(&s) || spar_beam_create(s, "wing", 1, 4, &wing) ||
        spar_beam_set_axis(wing, 2, eta, xyz, NULL) || spar_beam_set_sections(wing, 1, eta, K, M) ||
        spar_member_set_root(wing, SPAR_ROOT_FIXED) || spar_member_commit(wing) ||
        spar_fluid_create(wing, "air", &air) || spar_fluid_set_stations(air, 2, eta, NULL) || spar_fluid_map(air) ||
        spar_fluid_get_nearest(air, SPAR_NODES_MOTION, x, NULL, NULL) ||
        spar_polar_create(2, alpha, cl, cd, NULL, &polar) || spar_aero_create(1, &air, &aero) ||
        spar_aero_set_section(aero, 0, 1, 0, polar) || spar_aero_set_section(aero, 1, 1, 0, polar) ||
        spar_aero_solve(aero, 1.2, inflow, 0) || spar_aero_get_loads(aero, NULL, force, NULL)) {
        fprintf(stderr, "%s\n", spar_session_message(s));
        return 1;
    }
    double lift = fabs(force[2] + force[5]);
    printf("lift %.12f N\n", lift);
    int refused = spar_aero_solve(aero, -1, inflow, 0) == SPAR_ERR_ARGUMENT &&
                  strncmp(spar_session_message(s), "spar_aero_solve: ", 17) == 0;
    spar_aero_destroy(&aero);
    spar_polar_destroy(&polar);
    spar_session_destroy(&s);
    return fabs(lift - 60 * (x[3] - x[0])) < 1e-9 && lift > 80 && refused ? 0 : 1;
}
