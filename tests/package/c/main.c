/* A body of 2 kg falls for one second under 9.81 m/s^2: -4.905 m, exact for the integrator (constant acceleration). */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_aero.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <string.h>

int main(void) {
    spar_session *session = NULL;
    spar_member *body = NULL;
    const double g[3] = {0.0, 0.0, -9.81};
    double mass[36] = {0.0}, q[7];
    for (int i = 0; i < 6; i++) {
        mass[7 * i] = 2.0;
    }
    if (strcmp(spar_version(), "0.9.0") != 0 || spar_session_create(&session) || spar_session_set_gravity(session, g) ||
        spar_rigid_create(session, "body", NULL, NULL, mass, &body) || spar_member_commit(body)) {
        fprintf(stderr, "%s\n", spar_session_message(session));
        return 1;
    }
    for (int i = 0; i < 10; i++) {
        if (spar_step(session, 0.1, NULL, NULL, NULL)) {
            fprintf(stderr, "%s\n", spar_session_message(session));
            return 1;
        }
    }
    spar_member_get_motion(body, q, NULL, NULL);
    spar_session_destroy(&session);
    printf("fell %.12f m\n", q[2]);
    return fabs(q[2] + 4.905) < 1e-9 ? 0 : 1;
}
