/* Section matrices from engineering numbers and from shapes, and numbers from matrices. */
#include "scene.h"

static const double pi = 3.14159265358979323846;

static double draw(double least, double most) {
    return least + (most - least) * rand() / RAND_MAX;
}

/* a section without couplings; principal axes within 45 degrees of y */
static void draw_section(double p[SPAR_SECTION_COUNT]) {
    for (int i = 0; i < SPAR_SECTION_COUNT; i++) {
        p[i] = draw(-1, 1);
    }
    for (int i = SPAR_SECTION_EA; i <= SPAR_SECTION_EI_Z; i++) {
        p[i] = pow(10, draw(6, 8));
    }
    p[SPAR_SECTION_ANGLE] *= 0.7, p[SPAR_SECTION_SHEAR_ANGLE] *= 0.7, p[SPAR_SECTION_INERTIA_ANGLE] *= 0.7;
    p[SPAR_SECTION_MASS] = draw(1, 100);
    p[SPAR_SECTION_INERTIA_Y] = draw(0.1, 10), p[SPAR_SECTION_INERTIA_Z] = draw(0.1, 10);
}

/* A bundle of fibres, each with a stiffness E A along x and a mass at (y, z): the 6x6 of stretch and bending is the sum
   over the fibres of that of one fibre, e = e0 + z k_y - y k_z; the mass is that of points. Tension centre, EI and
   angle come from the moments of the bundle by Mohr's formulas. Sums against spar_section_build, to 1e-12 of the
   diagonal. */
static void test_fibres(void **state) {
    (void)state;
    enum { FIBRES = 7 };
    double p[SPAR_SECTION_COUNT] = {0}, K[36], M[36], sum[36] = {0}, mass[36] = {0};
    double ea = 0, y0 = 0, z0 = 0, yy = 0, zz = 0, yz = 0, y[FIBRES], z[FIBRES], a[FIBRES];
    srand(1);
    for (int f = 0; f < FIBRES; f++) {
        y[f] = draw(-1, 2), z[f] = draw(-0.5, 0.2), a[f] = draw(1, 5);
        ea += a[f], y0 += a[f] * y[f], z0 += a[f] * z[f];
        const double row[6] = {1, 0, 0, 0, z[f], -y[f]},
                     v[3][6] = {{1, 0, 0, 0, z[f], -y[f]}, {0, 1, 0, -z[f], 0, 0}, {0, 0, 1, y[f], 0, 0}};
        for (int i = 0; i < 36; i++) {
            sum[i] += a[f] * row[i / 6] * row[i % 6];
            for (int k = 0; k < 3; k++) {
                mass[i] += 10 * a[f] * v[k][i / 6] * v[k][i % 6];
            }
        }
    }
    y0 /= ea, z0 /= ea;
    for (int f = 0; f < FIBRES; f++) {
        yy += a[f] * (y[f] - y0) * (y[f] - y0), zz += a[f] * (z[f] - z0) * (z[f] - z0);
        yz += a[f] * (y[f] - y0) * (z[f] - z0);
    }
    double mean = 0.5 * (yy + zz),
           radius = hypot(0.5 * (zz - yy), yz); /* Mohr's circle of int z^2, int y^2, -int y z */
    p[SPAR_SECTION_EA] = ea, p[SPAR_SECTION_TENSION_Y] = y0, p[SPAR_SECTION_TENSION_Z] = z0;
    p[SPAR_SECTION_EI_Y] = mean - radius, p[SPAR_SECTION_EI_Z] = mean + radius;
    p[SPAR_SECTION_ANGLE] = 0.5 * atan2(2 * yz, yy - zz);
    p[SPAR_SECTION_GA_Y] = p[SPAR_SECTION_GA_Z] = p[SPAR_SECTION_GJ] = 1;
    p[SPAR_SECTION_MASS] = 10 * ea, p[SPAR_SECTION_MASS_Y] = y0, p[SPAR_SECTION_MASS_Z] = z0;
    p[SPAR_SECTION_INERTIA_Y] = 10 * (mean - radius), p[SPAR_SECTION_INERTIA_Z] = 10 * (mean + radius);
    OK(NULL, spar_section_build(SPAR_SECTION_COUNT, p, K, M));
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            double fibres = sum[6 * i + j] + (i == j && i > 0 && i < 4 ? 1 : 0);
            NEAR(K[6 * i + j], fibres, 1e-12 * 100);
            NEAR(M[6 * i + j], mass[6 * i + j], 1e-12 * 1000);
        }
    }
}

/* What centres mean: of a cantilever of 10 m, an axial force at the tension centre stretches without bending, N L / EA;
   a force across at the shear centre bends without twisting, F L^3 / 3 EI + F L / GA along z' to 1e-6 (strains of
   1e-7); a torque twists by M L / GJ. Rounding and second order: 1e-5 of the deflection. */
static void test_centres(void **state) {
    (void)state;
    const double L = 10, F = 10, angle = 0.4;
    double p[SPAR_SECTION_COUNT] = {1e9, 2e8, 3e8, 1e7, 2e7, 5e7}, K[36], q[7];
    p[SPAR_SECTION_ANGLE] = angle;
    p[SPAR_SECTION_TENSION_Y] = 0.3, p[SPAR_SECTION_TENSION_Z] = -0.2;
    p[SPAR_SECTION_SHEAR_Y] = -0.5, p[SPAR_SECTION_SHEAR_Z] = 0.1;
    OK(NULL, spar_section_build(12, p, K, NULL));
    const double c = cos(angle), s = sin(angle),
                 load[3][6] = {{F, 0, 0, 0, F * -0.2, F * -0.3},
                               {0, -s * F, c * F, F * (-0.5 * c + 0.1 * s), 0, 0},
                               {0, 0, 0, F, 0, 0}};
    for (int k = 0; k < 3; k++) {
        spar_session *session = scene_session();
        spar_member *b = scene_beam(session, "b", 1, 8, L, K, NULL);
        OK(session, spar_member_commit(b));
        OK(session, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load[k]));
        OK(session, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        double u = F * L / 1e9, w = F * L * L * L / (3 * 2e7) + F * L / 3e8, t = F * L / 1e7;
        if (k == 0) {
            NEAR(q[0], u, 1e-5 * u);
            NEAR(hypot(q[1], q[2]), 0, 1e-5 * u);
        } else if (k == 1) {
            NEAR(c * q[2] - s * q[1], w, 1e-5 * w);
            NEAR(s * q[2] + c * q[1], 0, 1e-5 * w);
            NEAR(2 * q[4], 0, 1e-5 * w / L);
        } else {
            NEAR(2 * q[4], t, 1e-5 * t);
        }
        spar_session_destroy(&session);
    }
}

/* Build, then describe: 1000 sections drawn at random give their numbers back, to 1e-8 of them (stiffnesses of 1e6 to
   1e8, centres up to 1 m from the line), with no finding of a coupling (numbers at random may look like other units or
   another order). */
static void test_round_trip(void **state) {
    (void)state;
    srand(2);
    for (int k = 0; k < 1000; k++) {
        double p[SPAR_SECTION_COUNT], got[SPAR_SECTION_COUNT + 2], K[36], M[36];
        int findings;
        draw_section(p);
        OK(NULL, spar_section_build(SPAR_SECTION_COUNT, p, K, M));
        OK(NULL, spar_section_describe(K, M, SPAR_SECTION_COUNT + 2, got, &findings));
        assert_int_equal(findings & ~(SPAR_FINDING_UNITS | SPAR_FINDING_ORDER), 0);
        for (int i = 0; i < SPAR_SECTION_COUNT; i++) {
            NEAR(got[i], p[i], 1e-8 * (i <= SPAR_SECTION_EI_Z ? p[i] : 1 + fabs(p[i])));
        }
        assert_true(got[SPAR_SECTION_COUNT] == 0 && got[SPAR_SECTION_COUNT + 1] == 0);
    }
}

/* Seen from another line and in other axes, a section keeps EA, GA, GJ, EI, mass and inertia; its centres and angle
   move the other way; and the way back gives the matrices again. 200 draws, 1e-8. */
static void test_transform(void **state) {
    (void)state;
    srand(3);
    for (int k = 0; k < 200; k++) {
        double p[SPAR_SECTION_COUNT], got[SPAR_SECTION_COUNT], K[36], M[36], moved[36], mass[36];
        double y = draw(-1, 1), z = draw(-1, 1), a = draw(-0.05, 0.05), c = cos(a), s = sin(a);
        draw_section(p);
        OK(NULL, spar_section_build(SPAR_SECTION_COUNT, p, K, M));
        OK(NULL, spar_section_transform(K, y, z, a, moved));
        OK(NULL, spar_section_transform(M, y, z, a, mass));
        OK(NULL, spar_section_describe(moved, mass, SPAR_SECTION_COUNT, got, NULL));
        for (int i = 0; i <= SPAR_SECTION_EI_Z; i++) {
            NEAR(got[i], p[i], 1e-8 * p[i]);
        }
        NEAR(got[SPAR_SECTION_ANGLE], p[SPAR_SECTION_ANGLE] - a, 1e-8);
        static const int centres[3] = {SPAR_SECTION_TENSION_Y, SPAR_SECTION_SHEAR_Y, SPAR_SECTION_MASS_Y};
        for (int i = 0; i < 3; i++) {
            double dy = p[centres[i]] - y, dz = p[centres[i] + 1] - z;
            NEAR(got[centres[i]], c * dy + s * dz, 1e-8);
            NEAR(got[centres[i] + 1], c * dz - s * dy, 1e-8);
        }
        NEAR(got[SPAR_SECTION_MASS], p[SPAR_SECTION_MASS], 1e-10 * p[SPAR_SECTION_MASS]);
        NEAR(got[SPAR_SECTION_INERTIA_Y], p[SPAR_SECTION_INERTIA_Y], 1e-8 * 100);
        NEAR(got[SPAR_SECTION_INERTIA_Z], p[SPAR_SECTION_INERTIA_Z], 1e-8 * 100);
        OK(NULL, spar_section_transform(moved, 0, 0, -a, moved)); /* in place: turned back first, then moved */
        OK(NULL, spar_section_transform(moved, -y, -z, 0, moved));
        for (int i = 0; i < 36; i++) {
            NEAR(moved[i], K[i], 1e-12 * sqrt(K[7 * (i / 6)] * K[7 * (i % 6)]) + 1e-6);
        }
    }
}

/* E = 200e9, nu = 0.25, rho = 8000, G = 80e9. Circle and tube: textbook moments; Cowper's factors by his formulas,
   worked by hand: circle 6(1.25)/(8.5) = 15/17; tube with inner half of outer, m = 1/4 of areas... k = 6 1.25 (25/16)^2
   / (8.5 (25/16)^2 + 23/4). Rectangle: J of a square 0.1405770 a^4, of 2:1 0.2286817 a b^3, of 10:1 0.3123 (Timoshenko
   and Goodier, table); k = 12.5/14.75. To 1e-12, tables to their digits. */
static void test_shapes(void **state) {
    (void)state;
    const double E = 200e9, nu = 0.25, G = 80e9, rho = 8000;
    double p[SPAR_SECTION_COUNT], d = 0.2, t = 0.05, i = pi * (pow(d, 4) - pow(0.1, 4)) / 64,
                                  a = pi * (0.04 - 0.01) / 4;
    OK(NULL, spar_section_from_shape(SPAR_SHAPE_CIRCLE, 1, &d, E, nu, rho, SPAR_SECTION_COUNT, p));
    NEAR(p[SPAR_SECTION_EA] / (E * pi * d * d / 4), 1, 1e-12);
    NEAR(p[SPAR_SECTION_EI_Y] / (E * pi * pow(d, 4) / 64), 1, 1e-12);
    NEAR(p[SPAR_SECTION_EI_Z] / (E * pi * pow(d, 4) / 64), 1, 1e-12);
    NEAR(p[SPAR_SECTION_GJ] / (G * pi * pow(d, 4) / 32), 1, 1e-12);
    NEAR(p[SPAR_SECTION_GA_Y] / (G * pi * d * d / 4), 15.0 / 17, 1e-12);
    NEAR(p[SPAR_SECTION_MASS] / (rho * pi * d * d / 4), 1, 1e-12);
    NEAR(p[SPAR_SECTION_INERTIA_Z] / (rho * pi * pow(d, 4) / 64), 1, 1e-12);
    const double tube[2] = {d, t}, squared = pow(1.25, 2);
    OK(NULL, spar_section_from_shape(SPAR_SHAPE_TUBE, 2, tube, E, nu, rho, SPAR_SECTION_COUNT, p));
    NEAR(p[SPAR_SECTION_EA] / (E * a), 1, 1e-12);
    NEAR(p[SPAR_SECTION_EI_Y] / (E * i), 1, 1e-12);
    NEAR(p[SPAR_SECTION_GJ] / (2 * G * i), 1, 1e-12);
    NEAR(p[SPAR_SECTION_GA_Z] / (G * a), 7.5 * squared / (8.5 * squared + 23 * 0.25), 1e-12);
    static const double table[3][3] = {{1, 0.1405770, 1e-7}, {2, 0.2286817, 1e-7}, {10, 0.3123, 1e-4}};
    for (int k = 0; k < 3; k++) {
        const double lying[2] = {table[k][0] * 0.1, 0.1}, standing[2] = {0.1, table[k][0] * 0.1};
        OK(NULL, spar_section_from_shape(SPAR_SHAPE_RECTANGLE, 2, lying, E, nu, 0, SPAR_SECTION_COUNT, p));
        NEAR(p[SPAR_SECTION_GJ] / (G * lying[0] * 1e-3), table[k][1], table[k][2]);
        NEAR(p[SPAR_SECTION_EI_Y] / (E * lying[0] * 1e-3 / 12), 1, 1e-12);
        NEAR(p[SPAR_SECTION_GA_Y] / (G * lying[0] * 0.1), 12.5 / 14.75, 1e-12);
        double gj = p[SPAR_SECTION_GJ], ei = p[SPAR_SECTION_EI_Y];
        OK(NULL, spar_section_from_shape(SPAR_SHAPE_RECTANGLE, 2, standing, E, nu, 0, SPAR_SECTION_COUNT, p));
        NEAR(p[SPAR_SECTION_GJ], gj, 1e-12 * gj);
        NEAR(p[SPAR_SECTION_EI_Z], ei, 1e-12 * ei);
        assert_true(p[SPAR_SECTION_MASS] == 0 && p[SPAR_SECTION_INERTIA_Y] == 0);
    }
}

/* Boxes of E = 2, nu = 0 (G = 1). Torsion constant and shear factor along z from bilinear finite elements of the
   warping function and of the stress function of shear, 60 and 120 elements a side, extrapolated: J to 0.5 %, k less
   the stated 12 %, never above. Thin walls, to their thickness: Bredt's 4 A^2 / sum s/t, and the factor of Cowper for
   thin boxes at nu = 0. */
static void test_boxes(void **state) {
    (void)state;
    static const double boxes[][6] = {
        {1, 1, 0.05, 0.05, 0.04396, 0.4277}, {1, 1, 0.1, 0.1, 0.07709, 0.4439},  {1, 1, 0.2, 0.2, 0.11812, 0.5000},
        {2, 1, 0.2, 0.2, 0.34862, 0.2338},   {1, 2, 0.2, 0.2, 0.34862, 0.6707},  {4, 1, 0.1, 0.1, 0.52506, 0.0878},
        {1, 1, 0.05, 0.2, 0.06549, 0.1928},  {1, 1, 0.2, 0.05, 0.06549, 0.7097}, {3, 1, 0.05, 0.2, 0.40455, 0.0581}};
    double p[SPAR_SECTION_COUNT];
    for (size_t k = 0; k < sizeof boxes / sizeof *boxes; k++) {
        const double *b = boxes[k], area = b[0] * b[1] - (b[0] - 2 * b[2]) * (b[1] - 2 * b[3]);
        OK(NULL, spar_section_from_shape(SPAR_SHAPE_BOX, 4, b, 2, 0, 0, SPAR_SECTION_COUNT, p));
        NEAR(p[SPAR_SECTION_GJ], b[4], 5e-3 * b[4]);
        NEAR(p[SPAR_SECTION_EA], 2 * area, 1e-12);
        double inner = (b[0] - 2 * b[2]) * pow(b[1] - 2 * b[3], 3);
        NEAR(p[SPAR_SECTION_EI_Y], 2 * (b[0] * pow(b[1], 3) - inner) / 12, 1e-12);
        double factor = p[SPAR_SECTION_GA_Z] / area / b[5];
        assert_true(factor > 0.91 && factor < 1.001);
    }
    const double w = 2, h = 1, t_y = 2e-4, t_z = 1e-4, thin[4] = {w, h, t_y, t_z}, m = w * t_z / (h * t_y), n = w / h;
    double area = 2 * (w * t_z + h * t_y), bredt = 4 * w * w * h * h / (2 * w / t_z + 2 * h / t_y);
    double cowper =
        10 * pow(1 + 3 * m, 2) / (12 + 72 * m + 150 * m * m + 90 * m * m * m + 10 * n * n * (3 * m + 3 * m * m));
    OK(NULL, spar_section_from_shape(SPAR_SHAPE_BOX, 4, thin, 2, 0, 0, SPAR_SECTION_COUNT, p));
    NEAR(p[SPAR_SECTION_GJ] / bredt, 1, 1e-3);
    NEAR(p[SPAR_SECTION_GA_Z] / area / cowper, 1, 2e-3);
}

/* A matrix as BeamDyn's guide writes it: order shear x, shear y, axial, bending x, bending y, torsion, its z the beam's
   x, mass centre (X, Y): m Y and -m X couple. Given as it stands, it is found to be of that order; in spar's order
   (axes z, x, y) it is described by what it was made of. */
static void test_beamdyn(void **state) {
    (void)state;
    static const int from[6] = {2, 0, 1, 5, 3, 4};
    const double m = 50, X = 0.2, Y = -0.1, edge = 20, flap = 4; /* inertias about BeamDyn's x and y, at the line */
    double K[36], M[36], k[36], mass[36], p[SPAR_SECTION_COUNT];
    char text[1000];
    int findings;
    scene_diagonal(K, 2e8, 3e8, 4e9, 5e8, 2e8, 1e8);
    scene_diagonal(M, m, m, m, edge, flap, edge + flap);
    M[6 * 3 + 2] = M[6 * 2 + 3] = m * Y;
    M[6 * 4 + 2] = M[6 * 2 + 4] = -m * X;
    M[6 * 5] = M[5] = -m * Y;
    M[6 * 5 + 1] = M[6 + 5] = m * X;
    M[6 * 3 + 4] = M[6 * 4 + 3] = -m * X * Y;
    OK(NULL, spar_section_describe(K, NULL, 0, NULL, &findings));
    assert_int_equal(findings & SPAR_FINDING_ORDER, SPAR_FINDING_ORDER);
    OK(NULL, spar_section_report(K, M, 1000, text));
    assert_non_null(strstr(text, "the order looks like BeamDyn's"));
    for (int i = 0; i < 36; i++) {
        k[i] = K[6 * from[i / 6] + from[i % 6]];
        mass[i] = M[6 * from[i / 6] + from[i % 6]];
    }
    OK(NULL, spar_section_describe(k, mass, SPAR_SECTION_COUNT, p, &findings));
    assert_int_equal(findings, 0);
    NEAR(p[SPAR_SECTION_EA], 4e9, 1);
    NEAR(p[SPAR_SECTION_EI_Y], 5e8, 1); /* about BeamDyn's x: edge */
    NEAR(p[SPAR_SECTION_EI_Z], 2e8, 1); /* flap */
    NEAR(p[SPAR_SECTION_GJ], 1e8, 1);
    NEAR(p[SPAR_SECTION_MASS_Y], X, 1e-12);
    NEAR(p[SPAR_SECTION_MASS_Z], Y, 1e-12);
    double c = cos(p[SPAR_SECTION_INERTIA_ANGLE]), s = sin(p[SPAR_SECTION_INERTIA_ANGLE]);
    NEAR(c * c * p[SPAR_SECTION_INERTIA_Y] + s * s * p[SPAR_SECTION_INERTIA_Z], edge - m * Y * Y, 1e-9);
    NEAR(c * s * (p[SPAR_SECTION_INERTIA_Y] - p[SPAR_SECTION_INERTIA_Z]), 0, 1e-9);
}

/* A matrix as VABS writes it, in spar's order: the composite box of Wang et al., bending and torsion coupled. Without
   other loads GJ is that less what free bending takes away, K33 - k B^-1 k; the coupling coefficient 17.61 /
   sqrt(16.96 59.12) = 0.556 in axes turned by half a thousandth. */
static void test_coupled(void **state) {
    (void)state;
    double K[36], M[36], p[SPAR_SECTION_COUNT];
    char text[1000];
    int findings;
    scene_box(K, M);
    OK(NULL, spar_section_describe(K, M, SPAR_SECTION_COUNT, p, &findings));
    assert_int_equal(findings & (SPAR_FINDING_BEND_TWIST | SPAR_FINDING_STRETCH_TWIST | SPAR_FINDING_STRETCH_SHEAR |
                                 SPAR_FINDING_BEND_SHEAR | SPAR_FINDING_ORDER | SPAR_FINDING_MASS),
                     SPAR_FINDING_BEND_TWIST);
    double b = 59.12e3, c = 141.47e3, d = -0.37e3, k = 17.61e3, l = -0.351e3;
    NEAR(p[SPAR_SECTION_GJ], 16.96e3 - (k * k * c - 2 * k * l * d + l * l * b) / (b * c - d * d), 1e-6);
    OK(NULL, spar_section_report(K, M, 1000, text));
    assert_non_null(strstr(text, "bending and torsion are coupled, coefficient 0.556\n"));
}

static int found(const double *K, const double *M) {
    int findings;
    OK(NULL, spar_section_describe(K, M, 0, NULL, &findings));
    return findings;
}

/* Each finding by itself, on a section that has none. */
static void test_findings(void **state) {
    (void)state;
    double p[SPAR_SECTION_COUNT], K[36], M[36], k[36], m[36];
    char text[1000];
    const double size[2] = {0.3, 0.2};
    OK(NULL, spar_section_from_shape(SPAR_SHAPE_RECTANGLE, 2, size, 70e9, 0.3, 2700, SPAR_SECTION_COUNT, p));
    OK(NULL, spar_section_build(SPAR_SECTION_COUNT, p, K, M));
    assert_int_equal(found(K, M), 0);
    assert_int_equal(found(K, NULL), 0);
    OK(NULL, spar_section_report(K, M, 1000, text));
    assert_string_equal(text, "");
    static const int pair[4][2] = {{3, 4}, {0, 3}, {0, 2}, {1, 5}};
    for (int i = 0; i < 4; i++) {
        memcpy(k, K, sizeof k);
        k[6 * pair[i][0] + pair[i][1]] = k[6 * pair[i][1] + pair[i][0]] =
            0.1 * sqrt(K[7 * pair[i][0]] * K[7 * pair[i][1]]);
        assert_int_equal(found(k, M), SPAR_FINDING_BEND_TWIST << i);
    }
    memcpy(k, K, sizeof k);
    k[1] = 1e-3 * K[0];
    assert_int_equal(found(k, M) & ~SPAR_FINDING_STRETCH_SHEAR, SPAR_FINDING_ASYMMETRIC);
    memcpy(k, K, sizeof k);
    k[35] = -k[35];
    OK(NULL, spar_section_describe(k, M, SPAR_SECTION_COUNT, p, NULL));
    assert_int_equal(found(k, M), SPAR_FINDING_INDEFINITE);
    assert_true(p[SPAR_SECTION_EA] == 0 && p[SPAR_SECTION_MASS] == M[0]);
    memcpy(m, M, sizeof m);
    m[21] *= 1.5;
    assert_int_equal(found(K, m), SPAR_FINDING_POLAR);
    m[0] *= 2;
    assert_int_equal(found(K, m), SPAR_FINDING_MASS);
    for (int i = 3; i < 6; i++) { /* N mm^2 beside N */
        memcpy(k, K, sizeof k);
        k[7 * i] *= 1e6;
        assert_int_equal(found(k, M), SPAR_FINDING_UNITS);
    }
    for (int i = 0; i < 36; i++) { /* MPa */
        k[i] = 1e-6 * K[i];
    }
    assert_int_equal(found(k, M), SPAR_FINDING_UNITS);
    OK(NULL, spar_section_report(k, M, 1000, text));
    assert_non_null(strstr(text, "the speed of sound sqrt(EA/mass) is 5.09 m/s"));
}

/* Refusals, by message; outputs stay. */
static void test_refusals(void **state) {
    (void)state;
    double p[SPAR_SECTION_COUNT + 1] = {1e9, 2e8, 0, 1e7, 1e7, 1e7}, K[36] = {7}, M[36] = {7}, x[4] = {1, 1, 0.4, 0.1};
    char text[1000];
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "SPAR_SECTION_GA_Z is 0; it must be positive (if", spar_section_build(6, p, K, M));
    p[SPAR_SECTION_GA_Z] = 1e8;
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "SPAR_SECTION_MASS is 0", spar_section_build(6, p, K, M));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "0 properties", spar_section_build(0, p, K, NULL));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "19 properties", spar_section_build(SPAR_SECTION_COUNT + 1, p, K, NULL));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "property is NULL", spar_section_build(6, NULL, K, NULL));
    p[SPAR_SECTION_MASS] = 1;
    p[SPAR_SECTION_INERTIA_Z] = -1;
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "INERTIA_Z is -1", spar_section_build(SPAR_SECTION_COUNT, p, K, M));
    p[SPAR_SECTION_INERTIA_Z] = NAN;
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "INERTIA_Z is not", spar_section_build(SPAR_SECTION_COUNT, p, K, M));
    p[SPAR_SECTION_INERTIA_Z] = 0;
    p[SPAR_SECTION_TENSION_Y] = 1e9;
    REFUSED(NULL, SPAR_ERR_NUMERIC, "lost in rounding", spar_section_build(SPAR_SECTION_COUNT, p, K, M));
    assert_true(K[0] == 7 && M[0] == 7);
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "shape 4", spar_section_from_shape(4, 4, x, 1, 0, 0, 18, p));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "2 dimensions for a box; give its width",
            spar_section_from_shape(3, 2, x, 1, 0, 0, 18, p));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "thicker than a fifth", spar_section_from_shape(3, 4, x, 1, 0, 0, 18, p));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "below half", spar_section_from_shape(1, 2, x, 1, 0, 0, 18, p));
    x[0] = 0;
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "dimension 0 of a circle is 0", spar_section_from_shape(0, 1, x, 1, 0, 0, 18, p));
    x[0] = 1e-100;
    REFUSED(NULL, SPAR_ERR_NUMERIC, "too small", spar_section_from_shape(0, 1, x, 1, 0, 0, 18, p));
    x[0] = 1;
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "Poisson", spar_section_from_shape(0, 1, x, 1, 0.6, 0, 18, p));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "Young", spar_section_from_shape(0, 1, x, -1, 0.3, 0, 18, p));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "density", spar_section_from_shape(0, 1, x, 1, 0.3, -1, 18, p));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "capacity", spar_section_from_shape(0, 1, x, 1, 0.3, 1, -1, p));
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "needs", spar_section_report(K, K, 5, text));
    K[3] = NAN;
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "entry 3 of stiffness", spar_section_describe(K, NULL, 18, p, NULL));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "entry 3", spar_section_transform(K, 0, 0, 0, M));
    REFUSED(NULL, SPAR_ERR_ARGUMENT, "stiffness is NULL", spar_section_describe(NULL, NULL, 18, p, NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fibres),     cmocka_unit_test(test_centres),
                                       cmocka_unit_test(test_round_trip), cmocka_unit_test(test_transform),
                                       cmocka_unit_test(test_shapes),     cmocka_unit_test(test_boxes),
                                       cmocka_unit_test(test_beamdyn),    cmocka_unit_test(test_coupled),
                                       cmocka_unit_test(test_findings),   cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
