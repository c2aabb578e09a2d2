/* Follower loads and loads along a beam: closed forms, virtual work, tangents against finite differences. */
#include "scene.h"

#include "member/applied_loads.h"
#include "member/body.h"
#include "member/structure.h"

#include <stdio.h>
#include <unistd.h>

/* A curved, twisted beam of coupled sections, 2 elements of 5 nodes */
static spar_member *curved(spar_session *s) {
    const double eta[4] = {0, 0.3, 0.7, 1}, xyz[12] = {0, 0, 0, 1, 0.2, 0.1, 2.1, 0.3, 0.6, 3, 0.2, 1.4},
                 twist[4] = {0, 0.2, 0.5, 0.4};
    double K[36], M[36];
    spar_member *b = NULL;
    scene_box(K, M);
    OK(s, spar_beam_create(s, "curved", 2, 5, &b));
    OK(s, spar_beam_set_axis(b, 4, eta, xyz, twist));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_commit(b));
    return b;
}

static double noise(unsigned *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / (1 << 24) * 2 - 1;
}

/* Random nodal motion with turns of more than a half revolution from end to end; quaternions of either sign */
static void scatter(const spar_member *m, unsigned seed, double *q) {
    int n = m->body->unique;
    for (int i = 0; i < n; i++) {
        double psi[3];
        for (int c = 0; c < 3; c++) {
            q[7 * i + c] = 0.3 * noise(&seed);
            psi[c] = 0.2 * noise(&seed) + (c == 1 ? 0.5 * i : 0);
        }
        spari_quat_exp(psi, q + 7 * i + 3);
        for (int c = 0; c < 4 && i % 3 == 1; c++) {
            q[7 * i + 3 + c] *= -1;
        }
    }
}

static void turn_node(double *q, int dof, double by) {
    if (dof < 3) {
        q[dof] += by;
        return;
    }
    double psi[3] = {0}, p[4];
    psi[dof - 3] = by;
    spari_quat_exp(psi, p);
    spari_quat_mul(p, q + 3, q + 3);
}

static void load_all(spar_session *s, spar_member *b, int which) {
    const double nodal[6] = {3, -2, 1, 0.5, 0.7, -0.4}, eta[5] = {0.1, 0.35, 0.35, 0.6, 1};
    const double line[30] = {1, 2, 3, 0.1, 0.2, 0.3, -1, 1,  0.5, 0.4, -0.3, 0.2, 2, 2, -2,
                             0, 0, 0, 4,   1,   0,   1,  -1, 1,   0.3, 0.2,  0.1, 1, 1, 1};
    if (which == 0) {
        OK(s, spar_member_set_load(b, 9, SPAR_LOAD_FOLLOWER, nodal));
        OK(s, spar_member_set_load(b, 4, SPAR_LOAD_FOLLOWER, nodal));
    } else {
        OK(s, spar_beam_set_line_load(b, which == 1 ? SPAR_LOAD_DEAD : SPAR_LOAD_FOLLOWER, 5, eta, line));
    }
}

/* Tangent of each kind against central differences of the forces, h = 1e-5: truncation h^2 and rounding eps/h, both
   1e-10 of loads of size 10. */
static void test_tangent(void **state) {
    (void)state;
    for (int which = 0; which < 3; which++) {
        spar_session *s = scene_session();
        spar_member *b = curved(s);
        load_all(s, b, which);
        double q[9 * 7], r[2][54], S[2][900] = {{0}}, h = 1e-5;
        scatter(b, 7u + (unsigned)which, q);
        for (int e = 0; e < 2; e++) {
            spari_applied_tangent(b, e, q, 0.7, S[e]);
        }
        for (int j = 0; j < 54; j++) {
            for (int k = 0; k < 2; k++) {
                double p[63];
                memcpy(p, q, sizeof p);
                memset(r[k], 0, sizeof r[k]);
                turn_node(p + (ptrdiff_t)7 * (j / 6), j % 6, k ? h : -h);
                spari_applied_residual(b, p, 0.7, r[k]);
            }
            for (int i = 0; i < 54; i++) {
                double exact = 0;
                for (int e = 0; e < 2; e++) {
                    int row = i - 24 * e, col = j - 24 * e;
                    exact += row >= 0 && row < 30 && col >= 0 && col < 30 ? S[e][30 * row + col] : 0;
                }
                NEAR((r[1][i] - r[0][i]) / (2 * h), exact, 1e-8);
            }
        }
        spar_session_destroy(&s);
    }
}

/* A dead line load in a deformed state gives nodal loads of the same resultant: forces sum to f L, and a virtual turn
   of all nodes turns every section by it (exact), so that sum (x x f + m) is the integral of x x f + m, here along a
   straight line, where Gauss' sums are exact. Rounding: 1e-12. Taken away again, nothing is left to compute. */
static void test_resultants(void **state) {
    (void)state;
    spar_session *s = scene_session();
    const double eta[1] = {0}, line[6] = {1, -2, 3, 0.4, 0.5, -0.6}, L = 3;
    double K[36], M[36], x[30], q[70], load[60] = {0}, unique[63], force[3] = {0}, moment[3] = {0}, place[3] = {0},
                                       first[3];
    scene_box(K, M);
    spar_member *b = scene_beam(s, "b", 2, 5, L, K, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 1, eta, line));
    OK(s, spar_member_get_reference(b, x, NULL));
    scatter(b, 3, unique);
    spari_member_from_unique(b, 7, unique, q);
    spari_applied_nodal(b, q, load);
    for (int i = 0; i < 10; i++) {
        double c[3], now[3] = {x[3 * i] + q[7 * i], x[3 * i + 1] + q[7 * i + 1], x[3 * i + 2] + q[7 * i + 2]};
        spari_cross(now, load + (ptrdiff_t)6 * i, c);
        for (int k = 0; k < 3; k++) {
            force[k] += load[6 * i + k];
            moment[k] += load[6 * i + 3 + k] + c[k];
        }
    }
    for (int e = 0; e < 2; e++) {
        for (int k = b->body->first[e]; k < b->body->first[e + 1]; k++) {
            for (int l = 0; l < 5; l++) {
                for (int c = 0; c < 3; c++) {
                    int node = 5 * e + l;
                    place[c] += b->body->weight[b->body->slot[e] + k - b->body->first[e]] * b->body->phi[5 * k + l] *
                                (x[3 * node + c] + q[7 * node + c]);
                }
            }
        }
    }
    spari_cross(place, line, first);
    for (int k = 0; k < 3; k++) {
        NEAR(force[k], L * line[k], 1e-12);
        NEAR(moment[k], L * line[3 + k] + first[k], 1e-12);
    }
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 0, NULL, NULL));
    OK(s, spar_member_get_loads(b, load));
    for (int i = 0; i < 60; i++) {
        assert_true(load[i] == 0);
    }
    assert_null(b->load.applied);
    spar_session_destroy(&s);
}

static spar_member *slender(spar_session *s, int elements, int nodes, double L, double EI) {
    double K[36];
    scene_diagonal(K, 1e8 * EI / L / L, 1e8 * EI / L / L, 1e8 * EI / L / L, EI, EI, EI);
    spar_member *b = scene_beam(s, "b", elements, nodes, L, K, NULL);
    OK(s, spar_member_commit(b));
    return b;
}

/* Small loads: a cantilever under a part of uniform load w on [a, L] has the tip deflection
   w [3 L^4 - 4 a^3 L + a^4] / (24 EI), and -w (L^3 - a^3) / (6 EI) of slope; a line moment m on all of it m L^3/(3 EI)
   (theta' = m (L - s)/EI, w' = theta). The polynomials have degree 4 and 5: exact with 8 nodes, the jump at
   the joint, but for the square of the small load and for rounding at a stiffness ratio of 1e5: 1e-7. */
static void test_small_uniform_loads(void **state) {
    (void)state;
    const double L = 4, EI = 3, w = 1e-6, a = 2, stiff = 1e5, eta[4] = {0, 0.5, 0.5, 1};
    for (int kind = 0; kind < 2; kind++) {
        for (int linear = 0; linear < 2; linear++) {
            double load[24] = {0}, moment[6] = {0, w, 0, 0, 0, 0}, K[36], q[7];
            load[14] = load[20] = w;
            spar_session *s = scene_session();
            scene_diagonal(K, stiff, stiff, stiff, EI, EI, EI);
            spar_member *b = scene_beam(s, "b", 2, 8, L, K, NULL);
            OK(s, spar_member_set_fidelity(b, linear ? SPAR_FIDELITY_LINEAR : SPAR_FIDELITY_EXACT, 0));
            OK(s, spar_member_commit(b));
            OK(s, spar_beam_set_line_load(b, kind, 4, eta, load));
            OK(s, spar_member_solve_static(b, 1));
            scene_tip(b, q);
            double shear = w * (L * L - a * a) / 2 / stiff;
            NEAR(q[2], w * (3 * L * L * L * L - 4 * a * a * a * L + a * a * a * a) / 24 / EI + shear, 1e-7 * w);
            NEAR(2 * q[5], -w * (L * L * L - a * a * a) / 6 / EI, 1e-7 * w);
            double r[6];
            OK(s, spar_member_get_reaction(b, r));
            NEAR(r[2], -w * (L - a), 1e-7 * w);
            NEAR(r[4], w * (L * L - a * a) / 2, 1e-7 * w);
            moment[1] = 0, moment[4] = -w;
            OK(s, spar_beam_set_line_load(b, kind, 1, eta, moment));
            OK(s, spar_beam_set_line_load(b, 1 - kind, 0, NULL, NULL));
            OK(s, spar_member_solve_static(b, 1));
            scene_tip(b, q);
            NEAR(q[2], w * L * L * L / 3 / EI, 1e-7 * w);
            spar_session_destroy(&s);
        }
    }
}

/* A cantilever (x, bending in x-z) under a follower force F across its tip. Seen from the tip, with psi the turn of the
   tangent and s the way back from it, EI psi'' = F cos psi, psi(0) = psi'(0) = 0: an initial value problem, solved by
   RK4 in 20 000 steps (1e-13). Argyris & Symeonidis, CMAME 26 (1981): L = 100, EI = 3.5e7, F to 130 e3; the tip comes
   to half a turn at F L^2/EI = 13.75 and then swings back. Inextensible limit by 1e8: tolerance 1e-6. */
static void elastica(double c, double L, double *turn, double *along, double *across) {
    const int n = 20000;
    double y[4] = {0}, h = L / n; /* psi, psi', along, across */
    for (int i = 0; i < n; i++) {
        double k[4][4], at[4];
        for (int j = 0; j < 4; j++) {
            double f = j == 0 ? 0 : j == 3 ? h : 0.5 * h;
            for (int d = 0; d < 4; d++) {
                at[d] = y[d] + (j ? f * k[j - 1][d] : 0);
            }
            k[j][0] = at[1], k[j][1] = c * cos(at[0]), k[j][2] = cos(at[0]), k[j][3] = sin(at[0]);
        }
        for (int d = 0; d < 4; d++) {
            y[d] += h / 6 * (k[0][d] + 2 * k[1][d] + 2 * k[2][d] + k[3][d]);
        }
    }
    *turn = y[0], *along = y[2], *across = y[3];
}

static void test_follower_cantilever(void **state) {
    (void)state;
    const double L = 100, EI = 3.5e7, force[] = {1e3, 10e3, 40e3, 80e3, 130e3};
    spar_session *s = scene_session();
    spar_member *b = slender(s, 2, 16, L, EI);
    for (int i = 0; i < 5; i++) {
        double load[6] = {0, 0, force[i], 0, 0, 0}, q[7], r[6], along, across, t;
        elastica(force[i] / EI, L, &t, &along, &across);
        OK(s, spar_member_set_load(b, 31, SPAR_LOAD_FOLLOWER, load));
        OK(s, spar_member_solve_static(b, 4));
        scene_tip(b, q);
        /* the tip is `along` ahead of the root and `across` to the side in the frame that has turned by t */
        NEAR(q[0], along * cos(t) + across * sin(t) - L, 1e-6 * L);
        NEAR(q[2], along * sin(t) - across * cos(t), 1e-6 * L);
        NEAR(fabs(q[5]), sin(0.5 * t), 1e-6);
        OK(s, spar_member_get_reaction(b, r));
        NEAR(r[0], force[i] * sin(t), 1e-6 * force[i]);
        NEAR(r[2], -force[i] * cos(t), 1e-6 * force[i]);
        NEAR(r[4], force[i] * along, 1e-6 * force[i] * L);
    }
    spar_session_destroy(&s);
}

/* A dead uniform load on a stiff member is the weight of a member of that mass: the same answer, static and in a step,
   to the difference of their quadratures. */
static void test_weight_as_line_load(void **state) {
    (void)state;
    double K[36], M[36], tip[2][7], after[2][7], reaction[2][6];
    const double eta[1] = {0}, g[3] = {0, 0, -9.81};
    scene_box(K, M);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        if (k == 0) {
            OK(s, spar_session_set_gravity(s, g));
        }
        for (int i = 0; i < 3; i++) {
            M[7 * i] = 20;
        }
        spar_member *b = scene_beam(s, "b", 1, 9, 10, K, M);
        OK(s, spar_member_commit(b));
        if (k == 1) {
            double load[6] = {0, 0, 20 * g[2], 0, 0, 0};
            OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 1, eta, load));
        }
        scene_run(s, 0.01, 5);
        scene_tip(b, after[k]);
        OK(s, spar_member_solve_static(b, 2));
        scene_tip(b, tip[k]);
        OK(s, spar_member_get_reaction(b, reaction[k]));
        spar_session_destroy(&s);
    }
    assert_true(fabs(tip[0][2]) > 1);
    for (int i = 0; i < 7; i++) {
        NEAR(tip[0][i], tip[1][i], 1e-10);
        NEAR(after[0][i], after[1][i], 1e-6);
    }
    for (int i = 0; i < 6; i++) {
        NEAR(reaction[0][i], reaction[1][i], 1e-7);
    }
}

/* Newton with the exact tangent converges quadratically also in steps under follower loads: a step that has no more
   than 6 iterations allowed at 1e-12 passes, and a rigid body under a follower force turns it with itself: thrust F in
   its own axes of a body spinning at w about z from rest in place moves it on a circle: a = F/m (cos wt, sin wt). */
static void test_rigid_thrust(void **state) {
    (void)state;
    double M[36], c[3] = {0}, J[3] = {1, 1, 1}, F[6] = {2, 0, 0, 0, 0, 0}, q[7];
    const double w[3] = {0, 0, 1.5}, m = 4, T = 1;
    scene_mass(M, m, c, J);
    double error[2];
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = NULL;
        OK(s, spar_session_set_newton(s, 1e-12, 1e-12, 6));
        OK(s, spar_rigid_create(s, "b", NULL, NULL, M, &b));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 0, SPAR_LOAD_FOLLOWER, F));
        scene_run(s, T / (50 << k), 50 << k);
        OK(s, spar_member_get_motion(b, q, NULL, NULL));
        double x = F[0] / m * (1 - cos(w[2] * T)) / w[2] / w[2],
               y = F[0] / m * (T / w[2] - sin(w[2] * T) / w[2] / w[2]);
        error[k] = hypot(q[0] - x, q[1] - y);
        spar_session_destroy(&s);
    }
    assert_true(error[0] < 1e-4);
    NEAR(error[0] / error[1], 4, 0.4); /* order 2 in dt */
}

/* Saved in mid-motion and loaded into a session built anew, or into the same one whose loads have changed since, the
   member goes on with the loads it had: the same bits as without stopping. */
static void test_saved(void **state) {
    (void)state;
    const double zero[6] = {0};
    double q[3][70];
    char path[64];
    snprintf(path, sizeof path, "applied_%d.spar", (int)getpid());
    spar_session *s = scene_session();
    spar_member *b = curved(s);
    for (int k = 0; k < 3; k++) {
        load_all(s, b, k);
    }
    scene_run(s, 0.01, 3);
    OK(s, spar_session_save(s, path));
    scene_run(s, 0.01, 3);
    OK(s, spar_member_get_motion(b, q[0], NULL, NULL));
    OK(s, spar_member_set_load(b, 9, SPAR_LOAD_FOLLOWER, zero));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 0, NULL, NULL));
    OK(s, spar_session_load(s, path));
    scene_run(s, 0.01, 3);
    OK(s, spar_member_get_motion(b, q[1], NULL, NULL));
    spar_session_destroy(&s);
    s = scene_session();
    b = curved(s);
    OK(s, spar_session_load(s, path));
    scene_run(s, 0.01, 3);
    OK(s, spar_member_get_motion(b, q[2], NULL, NULL));
    spar_session_destroy(&s);
    remove(path);
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_memory_equal(q[0], q[2], sizeof q[0]);
}

static void test_refusals(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_member *b = curved(s);
    const double eta[3] = {0, 0.5, 0.4}, load[18] = {0}, bad[6] = {0, NAN, 0, 0, 0, 0};
    double q[4] = {1, 0, 0, 0}, x[3] = {0};
    spar_member *p = NULL;
    OK(s, spar_point_create(s, "p", x, q, &p));
    assert_int_equal(spar_member_set_load(p, 0, SPAR_LOAD_FOLLOWER, load), SPAR_ERR_STATE);
    OK(s, spar_member_commit(p));
    assert_int_equal(spar_beam_set_line_load(p, SPAR_LOAD_DEAD, 1, eta, load), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 3, eta, load), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "eta 2"));
    assert_int_equal(spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 1, eta, bad), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_line_load(b, 2, 1, eta, load), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_line_load(b, 0, 1, NULL, load), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_line_load(b, 0, -1, eta, load), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_set_load(b, 10, SPAR_LOAD_FOLLOWER, load), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_set_load(b, 0, SPAR_LOAD_FOLLOWER, bad), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_set_load(b, 0, SPAR_LOAD_FOLLOWER, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_set_load(NULL, 0, SPAR_LOAD_FOLLOWER, load), SPAR_ERR_ARGUMENT);
    assert_null(b->load.applied);
    spar_session_destroy(&s);
}

/* A force and a moment along the line from eta 0.3 to 0.6, inside elements: section forces are those of statics
   everywhere, on both sides of the jumps, for any nodes. Shares of nodal sums were 3 to 11 % off. */
static void section_forces_know_where_a_line_load_ends(void **state) {
    (void)state;
    const int fidelities[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL},
              meshes[][2] = {{1, 4}, {1, 9}, {3, 5}};
    const double eta[2] = {0.3, 0.6}, p[12] = {0, 0, 2, 0, 0, 0.3, 0, 0, 2, 0, 0, 0.3}, L = 2;
    double stiffness[36], mass[36];
    scene_diagonal(stiffness, 1e8, 4e7, 4e7, 6e7, 1.2e8, 2e8);
    scene_diagonal(mass, 1, 1, 1, 1e-3, 1e-3, 1e-3);
    for (int run = 0; run < 18; run++) {
        const int *mesh = meshes[run % 3], kind = run / 3 % 2 ? SPAR_LOAD_FOLLOWER : SPAR_LOAD_DEAD;
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", mesh[0], mesh[1], L, stiffness, mass);
        OK(s, spar_member_set_fidelity(b, fidelities[run / 6], 6 * mesh[0] * (mesh[1] - 1)));
        OK(s, spar_member_commit(b));
        OK(s, spar_beam_set_line_load(b, kind, 2, eta, p));
        OK(s, spar_member_solve_static(b, 1));
        for (int i = 0; i <= 80; i++) {
            const double at = i / 80.0, x = L * at, from = fmax(x, 0.6), over = fmax(1.2 - from, 0);
            double f[6];
            OK(s, spar_beam_evaluate(b, 1, &at, NULL, f, NULL, NULL));
            NEAR(f[2], 2 * over, 2e-8);
            NEAR(f[4], -2 * over * ((from + 1.2) / 2 - x), 2e-8);
            NEAR(f[5], 0.3 * over, 2e-8);
        }
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tangent),
        cmocka_unit_test(test_resultants),
        cmocka_unit_test(test_small_uniform_loads),
        cmocka_unit_test(test_follower_cantilever),
        cmocka_unit_test(test_weight_as_line_load),
        cmocka_unit_test(test_rigid_thrust),
        cmocka_unit_test(test_saved),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(section_forces_know_where_a_line_load_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
