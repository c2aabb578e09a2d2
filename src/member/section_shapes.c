/* Properties of sections of one isotropic material (spar_structure.h): circle, tube, rectangle, box. */
#include "../base/environment.h"
#include "../base/status.h"
#include "check_arguments.h"

#include <string.h>

static const double PI = 3.14159265358979323846;

/* Area, second moments about y and z, torsion constant, shear factors along y and z */
typedef struct geometry {
    double area, i_y, i_z, j, k_y, k_z;
} geometry;

/* G. R. Cowper, The shear coefficient in Timoshenko's beam theory, J. Appl. Mech. 33 (1966) 335-340. `hollow` is inner
   over outer diameter. */
static void circle(double d, double wall, double poisson, geometry *s) {
    double hollow = 1 - 2 * wall / d, m = hollow * hollow, squared = (1 + m) * (1 + m);
    s->area = PI * wall * (d - wall);
    s->i_y = s->i_z = s->area * d * d * (1 + m) / 16;
    s->j = 2 * s->i_y;
    s->k_y = s->k_z = 6 * (1 + poisson) * squared / ((7 + 6 * poisson) * squared + (20 + 12 * poisson) * m);
}

/* Saint-Venant's series, with sum 1/n^5 over odd n subtracted: the rest converges like exp(-n pi a/b). */
static double torsion_of_rectangle(double width, double height) {
    double a = fmax(width, height), b = fmin(width, height), sum = 31.0 / 32 * 1.0369277551433699263;
    for (int n = 1; n <= 13; n += 2) {
        sum -= 2 / (pow(n, 5) * (exp(n * PI * a / b) + 1));
    }
    return a * b * b * b * (1.0 / 3 - 64 / pow(PI, 5) * b / a * sum);
}

static void rectangle(double width, double height, double poisson, geometry *s) {
    s->area = width * height;
    s->i_y = s->area * height * height / 12;
    s->i_z = s->area * width * width / 12;
    s->j = torsion_of_rectangle(width, height);
    s->k_y = s->k_z = 10 * (1 + poisson) / (12 + 11 * poisson); /* Cowper */
}

/* With psi the function that is 1 at the cavity, 0 outside and harmonic between, and S the flux of its gradient, the
   torsion constant is 4 (A + int psi)^2 / S plus that of the wall cut open. Walls have their closed forms between the
   corners. Flux of a corner: conformal map (Cockcroft 1928). Its other two integrals: limits for one thin wall, and a
   fit for equal walls; all within 0.5 % of finite elements (docs/reference/sections.md). */
static double torsion_of_box(double w, double h, double t_y, double t_z) {
    double wi = w - 2 * t_y, hi = h - 2 * t_z, both = t_y * t_z, squares = t_y * t_y + t_z * t_z;
    double corner = 2 / PI * (log(squares / (4 * both)) + t_y / t_z * atan(t_z / t_y) + t_z / t_y * atan(t_y / t_z));
    double flux = 2 * wi / t_z + 2 * hi / t_y + 4 * corner;
    double enclosed = wi * hi + wi * t_z + hi * t_y + 4 * (0.44 * both - 0.13569 * squares);
    double open = 2 * (wi * t_z * t_z * t_z + hi * t_y * t_y * t_y) / 3 +
                  4 * (both * squares / 3 - 0.10504 * (squares * squares - 2 * both * both) - 0.19 * both * both);
    return 4 * enclosed * enclosed / flux + open;
}

/* Shear factor along z by the energy of shear stresses in equilibrium with bending: along z in the webs and in the
   corners above them, along y in the flanges (docs/reference/sections.md). Thin walls: Cowper's with Poisson's ratio
   0. */
static double shear_of_box(double w, double h, double t_y, double t_z) {
    double wi = w - 2 * t_y, e = 0.5 * h - t_z, half = 0.5 * h, a = w * h - 4 * wi * 0.5 * e;
    double i_y = (w * h * h * h - 8 * wi * e * e * e) / 12, first = 0.5 * w * t_z * (half + e);
    double webs = (first * first * e + 4.0 / 3 * first * t_y * pow(e, 3) + 8.0 / 15 * t_y * t_y * pow(e, 5)) / t_y;
    double corners = w * w / (4 * t_y) * (4.0 / 3 * half * half * pow(t_z, 3) - half * pow(t_z, 4) + pow(t_z, 5) / 5);
    double flanges = (pow(half, 3) - pow(e, 3)) / 18 * wi * wi * (wi + 2 * t_y);
    return i_y * i_y / (a * (webs + corners + flanges));
}

static void box(double w, double h, double t_y, double t_z, geometry *s) {
    double wi = w - 2 * t_y, hi = h - 2 * t_z;
    s->area = 2 * (w * t_z + hi * t_y);
    s->i_y = (w * h * h * h - wi * hi * hi * hi) / 12;
    s->i_z = (h * w * w * w - hi * wi * wi * wi) / 12;
    s->j = torsion_of_box(w, h, t_y, t_z);
    s->k_z = shear_of_box(w, h, t_y, t_z);
    s->k_y = shear_of_box(h, w, t_z, t_y);
}

static int check_shape(const char *call, int kind, int64_t n, const double *x) {
    static const struct {
        const char *name, *dimensions;
        int count;
    } shapes[] = {
        {"a circle", "its diameter", 1},
        {"a tube", "its outer diameter and wall thickness", 2},
        {"a rectangle", "its width along y and height along z", 2},
        {"a box", "its width along y, height along z and the thicknesses of the walls along z and along y", 4}};
    SPARI_REQUIRE(NULL, kind >= SPAR_SHAPE_CIRCLE && kind <= SPAR_SHAPE_BOX, SPAR_ERR_ARGUMENT,
                  "%s: shape %d is not known; see SPAR_SHAPE_*", call, kind);
    SPARI_REQUIRE(NULL, n == shapes[kind].count, SPAR_ERR_ARGUMENT, "%s: %lld dimensions for %s; give %s", call,
                  (long long)n, shapes[kind].name, shapes[kind].dimensions);
    SPARI_REQUIRE(NULL, x, SPAR_ERR_ARGUMENT, "%s: dimension is NULL", call);
    for (int64_t i = 0; i < n; i++) {
        SPARI_REQUIRE(NULL, isfinite(x[i]) && x[i] > 0, SPAR_ERR_ARGUMENT,
                      "%s: dimension %lld of %s is %g; give %s, all positive", call, (long long)i, shapes[kind].name,
                      x[i], shapes[kind].dimensions);
    }
    SPARI_REQUIRE(NULL, kind != SPAR_SHAPE_TUBE || x[1] < 0.5 * x[0], SPAR_ERR_ARGUMENT,
                  "%s: the wall of the tube is %g and its diameter %g; the wall must be below half of it", call, x[1],
                  x[0]);
    SPARI_REQUIRE(NULL, kind != SPAR_SHAPE_BOX || (x[2] <= x[0] / 5 && x[3] <= x[1] / 5), SPAR_ERR_ARGUMENT,
                  "%s: a wall of the box is thicker than a fifth of the side across it (%g of %g, %g of %g); give the "
                  "properties yourself",
                  call, x[2], x[0], x[3], x[1]);
    return SPAR_OK;
}

static void fill(const geometry *s, double young, double poisson, double density, double p[SPAR_SECTION_COUNT]) {
    double shear = young / (2 * (1 + poisson));
    memset(p, 0, SPAR_SECTION_COUNT * sizeof *p);
    p[SPAR_SECTION_EA] = young * s->area;
    p[SPAR_SECTION_GA_Y] = shear * s->k_y * s->area;
    p[SPAR_SECTION_GA_Z] = shear * s->k_z * s->area;
    p[SPAR_SECTION_GJ] = shear * s->j;
    p[SPAR_SECTION_EI_Y] = young * s->i_y;
    p[SPAR_SECTION_EI_Z] = young * s->i_z;
    p[SPAR_SECTION_MASS] = density * s->area;
    p[SPAR_SECTION_INERTIA_Y] = density * s->i_y;
    p[SPAR_SECTION_INERTIA_Z] = density * s->i_z;
}

int spar_section_from_shape(int shape, int64_t n, const double *dimension, double young, double poisson, double density,
                            int64_t capacity, double *property) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(check_shape(__func__, shape, n, dimension));
    SPARI_REQUIRE(NULL, isfinite(young) && young > 0, SPAR_ERR_ARGUMENT,
                  "%s: Young's modulus is %g; it must be positive", __func__, young);
    SPARI_REQUIRE(NULL, poisson > -1 && poisson <= 0.5, SPAR_ERR_ARGUMENT,
                  "%s: Poisson's ratio is %g; it must be above -1 and at most 0.5", __func__, poisson);
    SPARI_REQUIRE(NULL, isfinite(density) && density >= 0, SPAR_ERR_ARGUMENT,
                  "%s: the density is %g; it must not be negative", __func__, density);
    SPARI_TRY(spari_need_capacity(NULL, __func__, capacity));
    SPARI_REQUIRE(NULL, property, SPAR_ERR_ARGUMENT, "%s: property is NULL", __func__);
    geometry g = {0};
    double p[SPAR_SECTION_COUNT];
    const double *x = dimension;
    switch (shape) {
    case SPAR_SHAPE_CIRCLE:
    case SPAR_SHAPE_TUBE:
        circle(x[0], shape == SPAR_SHAPE_TUBE ? x[1] : 0.5 * x[0], poisson, &g);
        break;
    case SPAR_SHAPE_RECTANGLE:
        rectangle(x[0], x[1], poisson, &g);
        break;
    default:
        box(x[0], x[1], x[2], x[3], &g);
    }
    fill(&g, young, poisson, density, p);
    for (int i = 0; i < SPAR_SECTION_COUNT; i++) {
        SPARI_REQUIRE(NULL, isfinite(p[i]) && (i > SPAR_SECTION_EI_Z || p[i] > 0), SPAR_ERR_NUMERIC,
                      "%s: the stiffness or mass is too small or too large for a number; use SI units", __func__);
    }
    spari_fill(capacity, property, SPAR_SECTION_COUNT, p);
    return SPAR_OK;
}
