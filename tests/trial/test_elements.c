/* A beam made anew with other elements: it is the beam that would have been described so, and goes on from where it is.
 */
#include "scene.h"

#include "exchange/session_private.h"
#include "member/body.h"
#include "trial/rebuild.h"
#include "tune/apply.h"

enum { MOST = 64 };

/* A curved, twisted beam of two sections, which jump at a place that no element ends at, with a body on it, springs
   along a part and a load at its tip. */
static spar_member *describe(spar_session *s, int elements, int nodes) {
    enum { AXIS = 9 };
    const double eta[3] = {0, 0.37, 1}, point_mass_eta = 0.55, bed_eta[2] = {0.2, 0.7}, bed[6] = {9, 9, 9, 4, 4, 4},
                 tip[6] = {0, 4, 7, 0.2, 0, 0};
    double axis[AXIS], xyz[3 * AXIS], twist[AXIS], K[3 * 36], M[3 * 36], lump[36], J[3] = {1e-3, 2e-3, 3e-3},
                                                                                   centre[3] = {0, 0.02, 0};
    spar_member *b = NULL;
    for (int i = 0; i < AXIS; i++) {
        axis[i] = i / (AXIS - 1.0);
        xyz[3 * i] = 3 * axis[i], xyz[3 * i + 1] = 0.2 * axis[i] * axis[i], xyz[3 * i + 2] = 0.1 * axis[i];
        twist[i] = 0.3 * axis[i];
    }
    for (int i = 0; i < 3; i++) {
        double c = i == 2 ? 0.5 : 1;
        scene_diagonal(K + 36 * i, c * 1e5, c * 1e4, c * 1e4, c * 60, c * 80, c * 90);
        scene_diagonal(M + 36 * i, c, c, c, 2e-3, 1e-3, 1e-3);
    }
    scene_mass(lump, 0.4, centre, J);
    OK(s, spar_beam_create(s, "b", elements, nodes, &b));
    OK(s, spar_beam_set_axis(b, AXIS, axis, xyz, twist));
    OK(s, spar_beam_set_sections(b, 3, eta, K, M));
    OK(s, spar_beam_set_masses(b, 1, &point_mass_eta, lump));
    OK(s, spar_beam_set_foundation(b, 2, bed_eta, bed));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, (int64_t)elements * nodes - 1, SPAR_LOAD_DEAD, tip));
    return b;
}

/* Made anew it is the one that is described so, whatever it was: places, and the shape under its loads. With 4 elements
   of 9 nodes that is the converged one. */
static void test_as_described_so(void **state) {
    (void)state;
    const int divided[][2] = {{1, 8}, {3, 6}, {4, 9}, {5, 4}};
    double tip[4][7], last[7];
    for (int k = 0; k < 4; k++) {
        int elements = divided[k][0], nodes = divided[k][1];
        spar_session *s = scene_session(), *other = scene_session();
        spar_member *b = describe(s, 2, 6), *so = describe(other, elements, nodes), old;
        OK(s, spar_member_solve_static(b, 2));
        OK(other, spar_member_solve_static(so, 2));
        spari_rebuild wish = spari_rebuild_of(b);
        wish.elements = elements, wish.per_element = nodes;
        OK(s, spari_member_rebuild(b, &wish, &old));
        assert_int_equal(b->nodes, elements * nodes);
        assert_memory_equal(b->xr, so->xr, 3 * (size_t)b->nodes * sizeof(double));
        assert_memory_equal(b->qr, so->qr, 4 * (size_t)b->nodes * sizeof(double));
        for (int64_t i = 0; i < b->nodes; i++) { /* where the interpolation brings it */
            for (int c = 0; c < 3; c++) {
                NEAR(b->now.q[7 * i + c], so->now.q[7 * i + c], 2e-2 * fabs(so->now.q[7 * (so->nodes - 1) + 2]));
            }
        }
        OK(s, spar_member_solve_static(b, 1));
        for (int64_t i = 0; i < 7 * b->nodes; i++) {
            NEAR(b->now.q[i], so->now.q[i], 1e-10);
        }
        memcpy(tip[k], b->now.q + 7 * (b->nodes - 1), sizeof tip[k]);
        spari_member_restore(b, &old);
        spar_session_destroy(&s);
        spar_session_destroy(&other);
    }
    spar_session *s = scene_session();
    spar_member *b = describe(s, 12, 8);
    OK(s, spar_member_solve_static(b, 2));
    memcpy(last, b->now.q + 7 * (b->nodes - 1), sizeof last);
    spar_session_destroy(&s);
    print_message("tip %.6g m, off by %.2g, %.2g, %.2g and %.2g\n", last[2], tip[0][2] - last[2], tip[1][2] - last[2],
                  tip[2][2] - last[2], tip[3][2] - last[2]);
    for (int c = 0; c < 7; c++) { /* the jump lies within an element: order 3 of its size */
        NEAR(tip[2][c], last[c], 1e-4 * fabs(last[2]));
    }
}

/* Momentum and angular momentum about the origin: the mass matrix, as forces of unit time, times the velocity. */
static void momentum(const spar_member *m, double p[6]) {
    double q[7 * MOST], v[6 * MOST], none[6 * MOST] = {0}, r[6 * MOST];
    spari_member_to_unique(m, 6, m->now.v, v);
    memset(p, 0, 6 * sizeof *p);
    for (int i = 0; i < m->body->unique; i++) {
        memset(q + 7 * i, 0, 7 * sizeof *q);
        q[7 * i + 3] = 1;
    }
    (void)spari_body_residual(m->body, q, none, v, 0, r, NULL);
    int P = m->mesh.per_element;
    for (int i = 0; i < m->body->unique; i++) {
        int e = i == 0 ? 0 : (i - 1) / (P - 1);
        const double *x = m->xr + 3 * (e * P + i - e * (P - 1));
        double t[3];
        spari_cross(x, r + 6 * i, t);
        for (int c = 0; c < 3; c++) {
            p[c] += r[6 * i + c];
            p[3 + c] += r[6 * i + 3 + c] + t[c];
        }
    }
}

/* A free beam in motion: elements that are halves of those there were have the same velocity everywhere, and so all of
   its momentum; others to what their nodes can show of a motion whose polynomials end elsewhere. The momentum is taken
   in the reference place, where mass and arms are known. */
static void test_momentum(void **state) {
    (void)state;
    const int divided[][2] = {{2, 9}, {4, 6}, {6, 7}, {3, 8}, {1, 12}};
    const double within[] = {1e-13, 1e-13, 1e-13, 1e-4, 1e-3};
    double K[36], M[36];
    scene_diagonal(K, 1e5, 1e4, 1e4, 60, 80, 90);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    for (int k = 0; k < 5; k++) {
        const double v[3] = {0.3, -0.2, 0.7}, omega[3] = {0.1, 0.9, -0.4}, push[6] = {0, 5, 9, 0, 0, 0};
        double before[6], after[6];
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 2, 6, 3, K, M), old;
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(b, NULL, v, omega));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 4, SPAR_LOAD_DEAD, push));
        scene_run(s, 0.01, 20);
        momentum(b, before);
        spari_rebuild wish = spari_rebuild_of(b);
        wish.elements = divided[k][0], wish.per_element = divided[k][1];
        OK(s, spari_member_rebuild(b, &wish, &old));
        momentum(b, after);
        for (int c = 0; c < 6; c++) {
            NEAR(after[c], before[c], within[k] * 10);
        }
        assert_true(spari_norm(before) + spari_norm(before + 3) > 1);
        spari_member_restore(b, &old);
        spar_session_destroy(&s);
    }
}

/* What was comes back byte by byte, and the run goes on. Nodes that the host gave stay where they are. */
static void test_comes_back(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_member *b = describe(s, 2, 6), old, before;
    scene_run(s, 0.01, 3);
    before = *b;
    const int fidelity[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_MODAL, SPAR_FIDELITY_LINEAR};
    for (int k = 0; k < 3; k++) {
        spari_rebuild wish = {
            .per_element = 4 + k, .elements = 1 + 2 * k, .fidelity = fidelity[k], .modes = 4 * (k == 1)};
        OK(s, spari_member_rebuild(b, &wish, &old));
        assert_int_equal(b->mesh.elements, 1 + 2 * k);
        spari_member_restore(b, &old);
        assert_memory_equal(b, &before, sizeof before);
    }
    scene_run(s, 0.01, 3);
    spar_session_destroy(&s);
    s = scene_session();
    b = describe(s, 2, 6);
    double x[3 * 12], K[36], M[36], eta = 0;
    memcpy(x, b->xr, sizeof x);
    scene_diagonal(K, 1e5, 1e4, 1e4, 60, 80, 90);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    spar_member *given = NULL;
    OK(s, spar_beam_create(s, "given", 2, 6, &given));
    OK(s, spar_beam_set_nodes(given, 12, x, NULL));
    OK(s, spar_beam_set_sections(given, 1, &eta, K, M));
    OK(s, spar_member_commit(given));
    before = *given;
    spari_rebuild wish = spari_rebuild_of(given);
    wish.elements = 3;
    REFUSED(s, SPAR_ERR_STATE, "were set by the host", spari_member_rebuild(given, &wish, &old));
    spari_member_restore(given, &old);
    assert_memory_equal(given, &before, sizeof before);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_described_so),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_comes_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
