/* Hinged right-angle frame: two legs of 120, EA = 4.32e7, EI = 1.44e7, hinged at both feet, welded at the corner, a
   force at 24 from the corner that stays down (Lee's frame: Lee, Manuel & Rossow, J. Eng. Mech. Div. ASCE 94 (1968)) or
   stays across the beam (Argyris & Symeonidis, CMAME 26 (1981)). Limit loads of both: Simo & Vu-Quoc, CMAME 58 (1986),
   18.532e3 and 35.447e3, on ten elements: 0.2 %.
   Exact: the frame is an initial value problem from the foot (force, turn there), integrated by the classical
   Runge-Kutta method, with the far foot's place and moment and the force's way down as conditions: 1e-9 of a leg. The
   limit load is the largest over the way down, found by golden section. Under load control the frame is
   there 4e-6 of that load below and not above; u and v there are off by the root of that. */
#include "verification.h"

enum { P = 10, COLUMN = 3, BEAM = 5 }; /* nodes of an element, elements */

static const double leg = 120, EA = 4.32e7, EI = 1.44e7, GA = 1e10, half_pi = 1.57079632679489661923;

/* ---- exact ---- */

/* x, z, turn of the section, moment; N: force on the part behind a section by that before it */
static void slope(const double *y, const double N[2], double *dy) {
    double c = cos(y[2]), s = sin(y[2]), stretch = 1 + (N[0] * c + N[1] * s) / EA, shear = (N[1] * c - N[0] * s) / GA;
    dy[0] = stretch * c - shear * s;
    dy[1] = stretch * s + shear * c;
    dy[2] = y[3] / EI;
    dy[3] = dy[1] * N[0] - dy[0] * N[1];
}

static void march(double *y, const double N[2], double length) {
    enum { STEPS = 300 };
    double k[4][4], at[4], h = length / STEPS;
    for (int i = 0; i < STEPS; i++) {
        for (int r = 0; r < 4; r++) {
            for (int j = 0; j < 4; j++) {
                at[j] = r == 0 ? y[j] : y[j] + (r == 3 ? 1 : 0.5) * h * k[r - 1][j];
            }
            slope(at, N, k[r]);
        }
        for (int j = 0; j < 4; j++) {
            y[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
        }
    }
}

/* From force and turn at the foot and the load, w[4]: what is missing at the far foot, and where the load is, u to the
   right and v down. */
static void shoot(int follows, const double w[4], double missing[3], double uv[2]) {
    double y[4] = {0, 0, half_pi + w[2], 0}, N[2] = {w[0], w[1]};
    march(y, N, leg);
    y[2] -= half_pi;
    march(y, N, 0.2 * leg);
    uv[0] = y[0] - 0.2 * leg, uv[1] = leg - y[1];
    N[0] -= follows ? w[3] * sin(y[2]) : 0;
    N[1] += follows ? w[3] * cos(y[2]) : w[3];
    march(y, N, 0.8 * leg);
    missing[0] = (y[0] - leg) / leg, missing[1] = (y[1] - leg) / leg, missing[2] = y[3] * leg / EI;
}

/* As above and how far the load (control 0) or its way down (1) is from what it should be. */
static void gaps_of(int follows, int control, double wanted, const double w[4], double gap[4]) {
    double uv[2];
    shoot(follows, w, gap, uv);
    gap[3] = control ? (uv[1] - wanted) / leg : (w[3] - wanted) * leg * leg / EI;
}

/* Elimination with pivots; A[4][5] with the right-hand side last, the solution there. */
static void eliminate(double A[4][5]) {
    for (int c = 0; c < 4; c++) {
        int best = c;
        for (int i = c; i < 4; i++) {
            best = fabs(A[i][c]) > fabs(A[best][c]) ? i : best;
        }
        for (int j = 0; j < 5; j++) {
            double t = A[c][j];
            A[c][j] = A[best][j], A[best][j] = t;
        }
        for (int i = 0; i < 4; i++) {
            double f = i == c ? 0 : A[i][c] / A[c][c];
            for (int j = c; j < 5; j++) {
                A[i][j] -= f * A[c][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        A[i][4] /= A[i][i];
    }
}

/* Newton with differences, from w. */
static void find_exact(int follows, int control, double wanted, double w[4], double uv[2]) {
    static const double size[4] = {1e3, 1e3, 0.1, 1e3};
    double A[4][5], gap[4], up[4], down[4], worst = 1;
    for (int it = 0; it < 40 && worst > 1e-11; it++) {
        worst = 0;
        gaps_of(follows, control, wanted, w, gap);
        for (int j = 0; j < 4; j++) {
            double at = w[j];
            w[j] = at + 1e-5 * size[j];
            gaps_of(follows, control, wanted, w, up);
            w[j] = at - 1e-5 * size[j];
            gaps_of(follows, control, wanted, w, down);
            w[j] = at;
            for (int i = 0; i < 4; i++) {
                A[i][j] = (up[i] - down[i]) / 2e-5;
            }
            A[j][4] = gap[j];
            worst = fmax(worst, fabs(gap[j]));
        }
        eliminate(A);
        for (int j = 0; j < 4; j++) {
            w[j] -= size[j] * A[j][4];
        }
    }
    assert_true(worst <= 1e-11);
    shoot(follows, w, gap, uv);
}

/* The shape that leads from rest to v = `down`, in steps of 1. */
static void begin_exact(int follows, double down, double w[4], double uv[2]) {
    memset(w, 0, 4 * sizeof *w);
    for (int v = 1; v <= (int)down; v++) {
        find_exact(follows, 1, v, w, uv);
    }
}

/* The largest load between ways down of `from` and `to`. */
static double limit_of(int follows, double from, double to, double uv[2]) {
    const double golden = 0.6180339887498949;
    double w[4], a = from, b = to;
    begin_exact(follows, from, w, uv);
    while (b - a > 1e-4) {
        double low[4], high[4], x = b - golden * (b - a), y = a + golden * (b - a);
        memcpy(low, w, sizeof low);
        memcpy(high, w, sizeof high);
        find_exact(follows, 1, x, low, uv);
        find_exact(follows, 1, y, high, uv);
        *(low[3] > high[3] ? &b : &a) = low[3] > high[3] ? y : x;
        memcpy(w, low[3] > high[3] ? low : high, sizeof w);
    }
    find_exact(follows, 1, 0.5 * (a + b), w, uv);
    return w[3];
}

/* ---- spar ---- */

/* From rest, in `steps` load steps; whether there is something. Out of the plane the legs are stiff. */
static int solve(int follows, double load, int steps, double uv[2]) {
    const double eta[2] = {0, 1}, foot[3] = {0}, corner[3] = {0, 0, leg}, far[3] = {leg, 0, leg},
                 line[2][6] = {{0, 0, 0, 0, 0, leg}, {0, 0, leg, leg, 0, leg}}, force[6] = {0, 0, -load, 0, 0, 0};
    double K[36], q[7 * BEAM * P];
    scene_diagonal(K, EA, GA, GA, 100 * EI, EI, 100 * EI);
    spar_session *s = scene_session();
    spar_member *legs[2];
    for (int k = 0; k < 2; k++) {
        OK(s, spar_beam_create(s, k ? "beam" : "column", k ? BEAM : COLUMN, P, &legs[k]));
        OK(s, spar_beam_set_axis(legs[k], 2, eta, line[k], NULL));
        OK(s, spar_beam_set_sections(legs[k], 1, eta, K, NULL));
        OK(s, spar_member_set_root(legs[k], SPAR_ROOT_FREE));
        OK(s, spar_member_commit(legs[k]));
    }
    (void)scene_joint_at(s, "foot", legs[0], 0, NULL, 0, SPAR_FREE_RY, foot);
    (void)scene_joint_at(s, "corner", legs[1], 0, legs[0], COLUMN * P - 1, 0, corner);
    (void)scene_joint_at(s, "far foot", legs[1], BEAM * P - 1, NULL, 0, SPAR_FREE_RY, far);
    OK(s, spar_member_set_load(legs[1], P, follows ? SPAR_LOAD_FOLLOWER : SPAR_LOAD_DEAD, force));
    int status = spar_member_solve_static(legs[0], steps);
    OK(s, spar_member_get_motion(legs[1], q, NULL, NULL));
    uv[0] = q[7 * P], uv[1] = -q[7 * P + 2];
    spar_session_destroy(&s);
    return status == SPAR_OK;
}

/* A load just below which there is an equilibrium above `down`, and just above which there is none; NaN: `about` is not
   it. */
static double confirm(int follows, double about, double down, double uv[2]) {
    double beyond[2];
    int below = solve(follows, (1 - 4e-6) * about, 5, uv) && uv[1] < down,
        above = solve(follows, (1 + 4e-6) * about, 5, beyond) && beyond[1] < down;
    return below && !above ? about : NAN;
}

static void verify_path(const char *of, int follows, const double *load, int n) {
    double w[4], exact[2], uv[2];
    begin_exact(follows, 1, w, exact);
    for (int i = 0; i < n; i++) {
        char what[64];
        assert_true(solve(follows, load[i], 5, uv));
        for (double on = w[3] + 500; on < load[i]; on += 500) {
            find_exact(follows, 0, on, w, exact);
        }
        find_exact(follows, 0, load[i], w, exact);
        for (int k = 0; k < 2; k++) {
            snprintf(what, sizeof what, "%s, P = %g: %s", of, load[i], k ? "v" : "u");
            verify(what, uv[k], exact[k], 1e-5, "exact equations by shooting");
        }
    }
}

static void verify_limit(const char *of, int follows, const double down[2], double published) {
    static const char *const name[3] = {"limit load", "u at the limit", "v at the limit"};
    double got[3] = {0}, exact[3];
    char what[64];
    exact[0] = limit_of(follows, down[0], down[1], exact + 1);
    got[0] = confirm(follows, exact[0], down[1], got + 1);
    for (int i = 0; i < 3; i++) {
        snprintf(what, sizeof what, "%s: %s", of, name[i]);
        verify(what, got[i], exact[i], i == 0 ? 4e-6 * exact[0] : 0.15, "exact equations by shooting");
    }
    snprintf(what, sizeof what, "%s: limit load, published", of);
    verify(what, got[0], published, 2e-3 * published, "Simo & Vu-Quoc 1986, 10 elements");
}

static void test_dead(void **state) {
    (void)state;
    verify_path("force down", 0, (const double[]){5e3, 1e4, 1.5e4, 1.8e4, 1.85e4}, 5);
    verify_limit("force down", 0, (const double[]){45, 55}, 18532);
    verified();
}

static void test_follower(void **state) {
    (void)state;
    verify_path("force across", 1, (const double[]){1e4, 2e4, 3e4, 3.5e4, 3.54e4}, 5);
    verify_limit("force across", 1, (const double[]){65, 73}, 35447);
    verified();
}

VERIFICATION_MAIN("Hinged right-angle frame", cmocka_unit_test(test_dead), cmocka_unit_test(test_follower))
