/* Static solutions of what its weight alone holds: bodies, chains and beams on hinges, from any start. They end at a
   stable equilibrium, or are refused with the motion that nothing holds, or that leaves an unstable one. */
#include "scene.h"

#include <math.h>
#include <stdio.h>

enum { LINKS = 5 };
static const double gravity = 9.81;

/* A chain of bodies of 2 kg, one a unit below the other where `angle` is 0; x: in its reference. */
typedef struct chain {
    spar_session *session;
    spar_member *link[LINKS];
    spar_joint *joint[LINKS];
    double x[LINKS][3];
    int n;
} chain;

static chain hang(int n, double angle, int free) {
    static const double J[3] = {0.1, 0.2, 0.3};
    const double g[3] = {0, 0, -gravity};
    chain p = {.session = scene_session(), .n = n};
    OK(p.session, spar_session_set_gravity(p.session, g));
    for (int i = 0; i < n; i++) {
        char name[2][8];
        double at[3] = {i * sin(angle), 0, -i * cos(angle)};
        (void)snprintf(name[0], sizeof name[0], "l%d", i);
        (void)snprintf(name[1], sizeof name[1], "j%d", i);
        p.x[i][0] = (i + 1) * sin(angle), p.x[i][1] = 0, p.x[i][2] = -(i + 1) * cos(angle);
        p.link[i] = scene_body(p.session, name[0], p.x[i], 2, J);
        p.joint[i] = scene_joint_at(p.session, name[1], p.link[i], 0, i ? p.link[i - 1] : NULL, 0, free, at);
    }
    return p;
}

/* Straight down, each joint with the weight below it, and it stays so. */
static void assert_hangs(const chain *p, double tolerance) {
    for (int step = 0; step < 2; step++) {
        for (int i = 0; i < p->n; i++) {
            double q[7], load[6];
            OK(p->session, spar_member_get_motion(p->link[i], q, NULL, NULL));
            OK(p->session, spar_joint_get_load(p->joint[i], load));
            NEAR(p->x[i][0] + q[0], 0, tolerance);
            NEAR(p->x[i][1] + q[1], 0, tolerance);
            NEAR(p->x[i][2] + q[2], -(i + 1), tolerance);
            NEAR(sqrt(load[0] * load[0] + load[1] * load[1] + load[2] * load[2]), 2 * gravity * (p->n - i),
                 100 * tolerance);
        }
        scene_run(p->session, 0.01, 20);
    }
}

/* From straight down to 3 rad off, by a hinge and a universal joint, in 1 and 4 load steps. */
static void a_body_hangs(void **state) {
    (void)state;
    static const double angle[] = {0, 1e-6, 0.3, 1.5, -2, 3, 3.1};
    static const int joint[] = {SPAR_FREE_RY, SPAR_FREE_RX | SPAR_FREE_RY};
    for (int i = 0; i < 7 * 2 * 2; i++) {
        chain p = hang(1, angle[i % 7], joint[i / 7 % 2]);
        OK(p.session, spar_session_solve_static(p.session, i / 14 ? 4 : 1, NULL, NULL, NULL));
        assert_hangs(&p, 1e-9);
        spar_session_destroy(&p.session);
    }
}

static void by_the_member(void **state) {
    (void)state;
    chain p = hang(1, 0.7, SPAR_FREE_RY);
    OK(p.session, spar_member_solve_static(p.link[0], 1));
    assert_hangs(&p, 1e-9);
    spar_session_destroy(&p.session);
}

static void a_chain_hangs(void **state) {
    (void)state;
    static const double angle[] = {0, 0.5, 1.5707963267948966, 2.5};
    for (int i = 0; i < 4; i++) {
        chain p = hang(LINKS, angle[i], SPAR_FREE_RY);
        OK(p.session, spar_session_solve_static(p.session, 1, NULL, NULL, NULL));
        assert_hangs(&p, 1e-8);
        spar_session_destroy(&p.session);
    }
}

/* Upside down to rounding: an equilibrium that no run keeps. On a ball joint nothing holds the turn about the vertical.
   Nothing has changed in either. */
static void refused_with_the_cure(void **state) {
    (void)state;
    double q[7];
    chain p = hang(1, 3.14159265358979323846, SPAR_FREE_RY);
    assert_int_equal(spar_session_solve_static(p.session, 1, NULL, NULL, NULL), SPAR_ERR_NUMERIC);
    assert_non_null(
        strstr(spar_session_message(p.session), "the equilibrium is unstable in the rotation about y of joint 'j0'"));
    OK(p.session, spar_member_get_motion(p.link[0], q, NULL, NULL));
    NEAR(fabs(q[0]) + fabs(q[1]) + fabs(q[2]), 0, 0);
    spar_session_destroy(&p.session);
    p = hang(1, 0.2, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ);
    assert_int_equal(spar_session_solve_static(p.session, 1, NULL, NULL, NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(p.session), "the rotation about z of joint 'j0' is not constrained"));
    spar_session_destroy(&p.session);
}

/* Above its hinge, on a spring k: upright where k > m g l; else, from a little off, k z = m g l sin(z); upright itself
   is refused. */
static void above_its_hinge(void **state) {
    (void)state;
    const double weight = 2 * gravity, k[] = {1.1 * weight, 0.8 * weight, 0.8 * weight}, off[] = {0, 0.01, 0};
    for (int i = 0; i < 3; i++) {
        double K[36], z[6], exact = 1;
        chain p = hang(1, 3.14159265358979323846 - off[i], SPAR_FREE_RY);
        scene_diagonal(K, 0, 0, 0, 0, k[i], 0);
        OK(p.session, spar_joint_set_spring(p.joint[0], K, NULL, NULL));
        int status = spar_session_solve_static(p.session, 1, NULL, NULL, NULL);
        assert_int_equal(status, i == 2 ? SPAR_ERR_NUMERIC : SPAR_OK);
        for (int it = 0; it < 50; it++) {
            exact -= (k[i] * exact - weight * sin(exact + off[i])) / (k[i] - weight * cos(exact + off[i]));
        }
        OK(p.session, spar_joint_get_motion(p.joint[0], z, NULL, NULL));
        NEAR(fabs(z[4]), i == 1 ? exact : 0, 1e-9);
        spar_session_destroy(&p.session);
    }
}

/* A beam of 8 kg on a hinge, level in its reference, hangs down by its weight: its end a length below, and the stretch
   m g L / (2 EA). */
static void a_beam_hangs(void **state) {
    (void)state;
    const double g[3] = {0, 0, -gravity}, x[3] = {0};
    double K[36], M[36], tip[7];
    spar_session *s = scene_session();
    scene_diagonal(K, 1e5, 1e5, 1e5, 500, 400, 400);
    scene_diagonal(M, 4, 4, 4, 0.2, 0.1, 0.1);
    spar_member *b = scene_beam(s, "beam", 1, 6, 2, K, M);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    (void)scene_joint_at(s, "hinge", b, 0, NULL, 0, SPAR_FREE_RY, x);
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    scene_tip(b, tip);
    NEAR(2 + tip[0], 0, 1e-8);
    NEAR(tip[2], -2 - 8 * gravity * 2 / (2 * 1e5), 1e-7);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_body_hangs),          cmocka_unit_test(by_the_member),
                                       cmocka_unit_test(a_chain_hangs),         cmocka_unit_test(a_beam_hangs),
                                       cmocka_unit_test(refused_with_the_cure), cmocka_unit_test(above_its_hinge)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
