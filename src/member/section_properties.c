/* Sections from engineering numbers and back (spar_structure.h). With the strain at the reference line e = (stretch,
   shears, twist, curvatures), the stretch at the tension centre is e0 + z_t e4 - y_t e5, the shears at the shear centre
   are e1 - z_s e3 and e2 + y_s e3. Called d = T e, the stiffness is T^T D T, and D has blocks of stretch, shear, twist
   and bending alone unless the section couples them. The compliance is T^-1 D^-1 T^-T. */
#include "../algebra/dense.h"
#include "../base/environment.h"
#include "../base/status.h"
#include "beam.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { STRETCH, SHEAR_Y, SHEAR_Z, TWIST, BEND_Y, BEND_Z };

static const char *const NAMES[SPAR_SECTION_COUNT] = {
    "EA",        "GA_Y",    "GA_Z",    "GJ",   "EI_Y",   "EI_Z",   "ANGLE",     "SHEAR_ANGLE", "TENSION_Y",
    "TENSION_Z", "SHEAR_Y", "SHEAR_Z", "MASS", "MASS_Y", "MASS_Z", "INERTIA_Y", "INERTIA_Z",   "INERTIA_ANGLE"};

static const double QUARTER_TURN = 1.57079632679489661923;

/* out = T^T M T; out may be M */
static void congruence(const double T[36], const double M[36], double out[36]) {
    double half[36], full[36];
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            half[6 * i + j] = 0;
            for (int k = 0; k < 6; k++) {
                half[6 * i + j] += M[6 * i + k] * T[6 * k + j];
            }
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            full[6 * i + j] = 0;
            for (int k = 0; k < 6; k++) {
                full[6 * i + j] += T[6 * k + i] * half[6 * k + j];
            }
        }
    }
    memcpy(out, full, sizeof full);
}

/* d = T e */
static void centres(double y_t, double z_t, double y_s, double z_s, double T[36]) {
    memset(T, 0, 36 * sizeof *T);
    for (int i = 0; i < 6; i++) {
        T[7 * i] = 1;
    }
    T[6 * STRETCH + BEND_Y] = z_t;
    T[6 * STRETCH + BEND_Z] = -y_t;
    T[6 * SHEAR_Y + TWIST] = -z_s;
    T[6 * SHEAR_Z + TWIST] = y_s;
}

/* Components of shears and curvatures from those in axes rotated by these angles */
static void rotation(double shear_angle, double bend_angle, double R[36]) {
    const double angle[6] = {0, shear_angle, shear_angle, 0, bend_angle, bend_angle};
    memset(R, 0, 36 * sizeof *R);
    for (int i = 0; i < 6; i++) {
        R[7 * i] = cos(angle[i]);
    }
    for (int i = SHEAR_Y; i <= BEND_Y; i += BEND_Y - SHEAR_Y) {
        R[6 * (i + 1) + i] = sin(angle[i]);
        R[6 * i + i + 1] = -sin(angle[i]);
    }
}

/* The 2x2 tensor with the values along axes rotated by `angle`, as the block of M at row and column `at` */
static void put_block(double *M, int at, double first, double second, double angle) {
    double c = cos(angle), s = sin(angle);
    M[7 * at] = c * c * first + s * s * second;
    M[7 * (at + 1)] = s * s * first + c * c * second;
    M[6 * at + at + 1] = M[6 * (at + 1) + at] = c * s * (first - second);
}

/* ---- build ---- */

static int check_property(const char *call, int64_t n, const double *property, int stiffness, int mass) {
    SPARI_REQUIRE(NULL, n >= 1 && n <= SPAR_SECTION_COUNT, SPAR_ERR_ARGUMENT,
                  "%s: %lld properties; give 1 to %d, by SPAR_SECTION_*", call, (long long)n, SPAR_SECTION_COUNT);
    SPARI_REQUIRE(NULL, property, SPAR_ERR_ARGUMENT, "%s: property is NULL", call);
    for (int64_t i = 0; i < SPAR_SECTION_COUNT; i++) {
        double x = i < n ? property[i] : 0;
        SPARI_REQUIRE(NULL, isfinite(x), SPAR_ERR_ARGUMENT, "%s: SPAR_SECTION_%s is not a finite number", call,
                      NAMES[i]);
        SPARI_REQUIRE(NULL, !stiffness || i > SPAR_SECTION_EI_Z || x > 0, SPAR_ERR_ARGUMENT,
                      "%s: SPAR_SECTION_%s is %g; it must be positive%s", call, NAMES[i], x,
                      i == SPAR_SECTION_GA_Y || i == SPAR_SECTION_GA_Z ? " (if it is not known: about EA/3)" : "");
        SPARI_REQUIRE(NULL, !mass || i != SPAR_SECTION_MASS || x > 0, SPAR_ERR_ARGUMENT,
                      "%s: SPAR_SECTION_MASS is %g; it must be positive, or give NULL for mass", call, x);
        SPARI_REQUIRE(NULL, !mass || (i != SPAR_SECTION_INERTIA_Y && i != SPAR_SECTION_INERTIA_Z) || x >= 0,
                      SPAR_ERR_ARGUMENT, "%s: SPAR_SECTION_%s is %g; it must not be negative", call, NAMES[i], x);
    }
    return SPAR_OK;
}

static void build_stiffness(const double *p, double K[36]) {
    double T[36];
    memset(K, 0, 36 * sizeof *K);
    K[7 * STRETCH] = p[SPAR_SECTION_EA];
    K[7 * TWIST] = p[SPAR_SECTION_GJ];
    put_block(K, SHEAR_Y, p[SPAR_SECTION_GA_Y], p[SPAR_SECTION_GA_Z],
              p[SPAR_SECTION_ANGLE] + p[SPAR_SECTION_SHEAR_ANGLE]);
    put_block(K, BEND_Y, p[SPAR_SECTION_EI_Y], p[SPAR_SECTION_EI_Z], p[SPAR_SECTION_ANGLE]);
    centres(p[SPAR_SECTION_TENSION_Y], p[SPAR_SECTION_TENSION_Z], p[SPAR_SECTION_SHEAR_Y], p[SPAR_SECTION_SHEAR_Z], T);
    congruence(T, K, K);
}

/* The velocity of the mass centre takes the strain's place: stretch and shears both refer to it. */
static void build_mass(const double *p, double M[36]) {
    double T[36];
    memset(M, 0, 36 * sizeof *M);
    M[0] = M[7] = M[14] = p[SPAR_SECTION_MASS];
    M[7 * TWIST] = p[SPAR_SECTION_INERTIA_Y] + p[SPAR_SECTION_INERTIA_Z];
    put_block(M, BEND_Y, p[SPAR_SECTION_INERTIA_Y], p[SPAR_SECTION_INERTIA_Z],
              p[SPAR_SECTION_ANGLE] + p[SPAR_SECTION_INERTIA_ANGLE]);
    centres(p[SPAR_SECTION_MASS_Y], p[SPAR_SECTION_MASS_Z], p[SPAR_SECTION_MASS_Y], p[SPAR_SECTION_MASS_Z], T);
    congruence(T, M, M);
}

int spar_section_build(int64_t n, const double *property, double *stiffness, double *mass) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(check_property(__func__, n, property, stiffness != NULL, mass != NULL));
    double p[SPAR_SECTION_COUNT] = {0}, K[36] = {0}, M[36] = {0}, m, c[3], J[6];
    memcpy(p, property, (size_t)n * sizeof *p);
    if (stiffness) {
        build_stiffness(p, K);
        SPARI_REQUIRE(NULL, spari_first_nonfinite(K, 36) < 0 && !spari_stiffness_fault(K), SPAR_ERR_NUMERIC,
                      "%s: the stiffness is lost in rounding; tension and shear centre must not be so far from the "
                      "line, and stiffnesses not so large",
                      __func__);
    }
    if (mass) {
        build_mass(p, M);
        SPARI_REQUIRE(NULL, spari_first_nonfinite(M, 36) < 0 && !spari_mass_split(M, &m, c, J), SPAR_ERR_NUMERIC,
                      "%s: the inertia is lost in rounding; the mass centre must not be so far from the line",
                      __func__);
    }
    spari_give(stiffness, K, 36);
    spari_give(mass, M, 36);
    return SPAR_OK;
}

/* ---- describe ---- */

/* A section by its parts. */
typedef struct described {
    double p[SPAR_SECTION_COUNT];
    int findings;
    double coupling[4];     /* of SPAR_FINDING_BEND_TWIST and the next three */
    const char *mass_fault; /* why the mass is not a section's */
    double polar, sum;      /* inertia about x, and of y and z */
} described;

/* Principal values of a symmetric 2x2 tensor, and the angle to the first axis from the axis at `base`, in (-pi/4,
   pi/4]. A tensor without principal axes has those at `base`. */
static void principal(double yy, double yz, double zz, double base, double *first, double *second, double *angle) {
    int isotropic = fabs(yy - zz) + fabs(yz) <= 1e-12 * (fabs(yy) + fabs(zz));
    double a = isotropic ? 0 : remainder(0.5 * atan2(2 * yz, yy - zz) - base, QUARTER_TURN);
    double c = cos(base + a), s = sin(base + a);
    *first = c * c * yy + 2 * c * s * yz + s * s * zz;
    *second = s * s * yy - 2 * c * s * yz + c * c * zz;
    *angle = a;
}

/* Inverse of a symmetric positive definite matrix; 0, or 1: it is not definite */
static int invert_section(const double K[36], double S[36]) {
    double L[36], d[6];
    for (int i = 0; i < 6; i++) {
        d[i] = sqrt(K[7 * i]);
    }
    for (int i = 0; i < 36; i++) {
        L[i] = K[i] / d[i / 6] / d[i % 6];
    }
    if (spari_cholesky(6, L)) {
        return 1;
    }
    for (int i = 0; i < 6; i++) { /* columns, as rows */
        memset(S + 6 * i, 0, 6 * sizeof *S);
        S[7 * i] = 1;
        spari_cholesky_solve(6, L, S + 6 * i);
    }
    for (int i = 0; i < 36; i++) {
        S[i] /= d[i / 6] * d[i % 6];
    }
    return 0;
}

/* Inverse of the 2x2 block of the compliance */
static void stiffness_of_block(const double *S, int at, double *yy, double *yz, double *zz) {
    double a = S[7 * at], b = 0.5 * (S[6 * at + at + 1] + S[6 * (at + 1) + at]), c = S[7 * (at + 1)];
    double det = a * c - b * b;
    *yy = c / det, *yz = -b / det, *zz = a / det;
}

static double coupling(const double *D, int i, int j) {
    return fabs(D[6 * i + j]) / sqrt(D[7 * i] * D[7 * j]);
}

/* The largest couplings of D in principal axes */
static void find_couplings(const double *D, described *d) {
    const double *p = d->p;
    double R[36], P[36];
    rotation(p[SPAR_SECTION_ANGLE] + p[SPAR_SECTION_SHEAR_ANGLE], p[SPAR_SECTION_ANGLE], R);
    congruence(R, D, P);
    for (int k = 0; k < 2; k++) {
        d->coupling[0] = fmax(d->coupling[0], coupling(P, TWIST, BEND_Y + k));
        d->coupling[2] = fmax(d->coupling[2], coupling(P, STRETCH, SHEAR_Y + k));
        for (int l = 0; l < 2; l++) {
            d->coupling[3] = fmax(d->coupling[3], coupling(P, SHEAR_Y + k, BEND_Y + l));
        }
    }
    d->coupling[1] = coupling(P, STRETCH, TWIST);
    for (int k = 0; k < 4; k++) {
        d->findings |= d->coupling[k] >= 1e-3 ? SPAR_FINDING_BEND_TWIST << k : 0;
    }
}

static void describe_stiffness(const double K[36], described *d) {
    double *p = d->p, sym[36], S[36], T[36], D[36], yy, yz, zz;
    for (int i = 0; i < 36; i++) {
        sym[i] = 0.5 * (K[i] + K[6 * (i % 6) + i / 6]);
    }
    if (spari_stiffness_fault(sym) || invert_section(sym, S)) {
        d->findings |= SPAR_FINDING_INDEFINITE;
        return;
    }
    const char *fault = spari_stiffness_fault(K);
    d->findings |= fault ? SPAR_FINDING_ASYMMETRIC : 0;
    /* the centres: an axial force at (y, z) has the moments (z, -y), a force across there the torque y F_z - z F_y */
    stiffness_of_block(S, BEND_Y, &yy, &yz, &zz);
    p[SPAR_SECTION_TENSION_Z] = -(yy * S[6 * BEND_Y] + yz * S[6 * BEND_Z]);
    p[SPAR_SECTION_TENSION_Y] = yz * S[6 * BEND_Y] + zz * S[6 * BEND_Z];
    p[SPAR_SECTION_SHEAR_Z] = S[6 * TWIST + SHEAR_Y] / S[7 * TWIST];
    p[SPAR_SECTION_SHEAR_Y] = -S[6 * TWIST + SHEAR_Z] / S[7 * TWIST];
    p[SPAR_SECTION_GJ] = 1 / S[7 * TWIST];
    principal(yy, yz, zz, 0, p + SPAR_SECTION_EI_Y, p + SPAR_SECTION_EI_Z, p + SPAR_SECTION_ANGLE);
    centres(-p[SPAR_SECTION_TENSION_Y], -p[SPAR_SECTION_TENSION_Z], -p[SPAR_SECTION_SHEAR_Y], -p[SPAR_SECTION_SHEAR_Z],
            T); /* T^-1 */
    congruence(T, sym, D);
    if (spari_stiffness_fault(D) || invert_section(D, S)) {
        d->findings |= SPAR_FINDING_INDEFINITE;
        memset(p, 0, sizeof d->p);
        return;
    }
    p[SPAR_SECTION_EA] = 1 / S[7 * STRETCH];
    stiffness_of_block(S, SHEAR_Y, &yy, &yz, &zz);
    principal(yy, yz, zz, p[SPAR_SECTION_ANGLE], p + SPAR_SECTION_GA_Y, p + SPAR_SECTION_GA_Z,
              p + SPAR_SECTION_SHEAR_ANGLE);
    find_couplings(D, d);
}

static void describe_mass(const double M[36], described *d) {
    double *p = d->p, m, c[3], J[6];
    const char *fault = spari_mass_split(M, &m, c, J);
    double small = 1e-6 * (fabs(J[0]) + fabs(J[3]) + fabs(J[5]));
    fault = fault                                           ? fault
            : m <= 0                                        ? "its mass is 0"
            : fabs(m * c[0]) > sqrt(m) * sqrt(small) * 1e-3 ? "its mass centre is not in the section"
            : fabs(J[1] + m * c[0] * c[1]) > small || fabs(J[2] + m * c[0] * c[2]) > small
                ? "the axis x is not a principal axis of its inertia"
                : NULL;
    if (fault) {
        d->findings |= SPAR_FINDING_MASS;
        d->mass_fault = fault;
        return;
    }
    p[SPAR_SECTION_MASS] = m;
    p[SPAR_SECTION_MASS_Y] = c[1];
    p[SPAR_SECTION_MASS_Z] = c[2];
    principal(J[3] - m * c[2] * c[2], J[4] + m * c[1] * c[2], J[5] - m * c[1] * c[1], p[SPAR_SECTION_ANGLE],
              p + SPAR_SECTION_INERTIA_Y, p + SPAR_SECTION_INERTIA_Z, p + SPAR_SECTION_INERTIA_ANGLE);
    d->polar = J[0] - m * (c[1] * c[1] + c[2] * c[2]);
    d->sum = p[SPAR_SECTION_INERTIA_Y] + p[SPAR_SECTION_INERTIA_Z];
    d->findings |= fabs(d->polar - d->sum) > 1e-3 * fmax(J[0], J[3] + J[5]) ? SPAR_FINDING_POLAR : 0;
}

/* Whether the stiffness is in the order shear, shear, axial, bending, bending, torsion: the third is the largest of its
   three, and the last is less than the two before. The mass does not matter: it may be in spar's order. */
int spari_section_is_other_order(const double K[36]) {
    return K[14] > 1.5 * fmax(K[0], K[7]) && K[35] < K[21] + K[28];
}

/* Ratios that structures of known materials keep, in SI units */
enum { SOUND, BEND_RADIUS_Y, BEND_RADIUS_Z, TORSION, SHEARS, RATIOS };
static const struct {
    double least, most;
    const char *text;
} ratios[RATIOS] = {{100, 3e4, "the speed of sound sqrt(EA/mass) is %.3g m/s; materials have 300 to 20000"},
                    {0.05, 20, "the radius sqrt(EI_Y/EA) is %.3g times sqrt(INERTIA_Y/MASS); they should be similar"},
                    {0.05, 20, "the radius sqrt(EI_Z/EA) is %.3g times sqrt(INERTIA_Z/MASS); they should be similar"},
                    {0, 5, "GJ is %.3g times EI_Y + EI_Z; solid sections have about 0.4, others less"},
                    {0, 3, "GA is %.3g times EA; isotropic sections have about 0.3"}};

static void find_ratios(const double *p, double ratio[RATIOS]) {
    double m = p[SPAR_SECTION_MASS], r = p[SPAR_SECTION_EA] / m;
    for (int i = 0; i < RATIOS; i++) {
        ratio[i] = 1;
    }
    ratio[SOUND] = m > 0 ? sqrt(r) : 1000;
    for (int i = 0; i < 2; i++) {
        double inertia = p[SPAR_SECTION_INERTIA_Y + i];
        ratio[BEND_RADIUS_Y + i] = inertia > 0 ? sqrt(p[SPAR_SECTION_EI_Y + i] / (r * inertia)) : 1;
    }
    ratio[TORSION] = p[SPAR_SECTION_GJ] / (p[SPAR_SECTION_EI_Y] + p[SPAR_SECTION_EI_Z]);
    ratio[SHEARS] = fmax(p[SPAR_SECTION_GA_Y], p[SPAR_SECTION_GA_Z]) / p[SPAR_SECTION_EA];
}

static int is_odd(const double ratio[RATIOS], int i) {
    return ratio[i] < ratios[i].least || ratio[i] > ratios[i].most;
}

static int describe(const char *call, const double *stiffness, const double *mass, described *d) {
    SPARI_REQUIRE(NULL, stiffness, SPAR_ERR_ARGUMENT, "%s: stiffness is NULL", call);
    for (int k = 0; k < (mass ? 2 : 1); k++) {
        int64_t at = spari_first_nonfinite(k ? mass : stiffness, 36);
        SPARI_REQUIRE(NULL, at < 0, SPAR_ERR_ARGUMENT, "%s: entry %lld of %s is not a finite number", call,
                      (long long)at, k ? "mass" : "stiffness");
    }
    describe_stiffness(stiffness, d);
    if (mass) {
        describe_mass(mass, d);
    }
    d->findings |= spari_section_is_other_order(stiffness) ? SPAR_FINDING_ORDER : 0;
    if (!(d->findings & SPAR_FINDING_INDEFINITE)) {
        double ratio[RATIOS];
        find_ratios(d->p, ratio);
        for (int i = 0; i < RATIOS; i++) {
            d->findings |= is_odd(ratio, i) ? SPAR_FINDING_UNITS : 0;
        }
    }
    return SPAR_OK;
}

int spar_section_describe(const double stiffness[36], const double mass[36], int64_t capacity, double *property,
                          int *findings) {
    SPARI_GUARD_ENVIRONMENT;
    described d = {0};
    SPARI_TRY(describe(__func__, stiffness, mass, &d));
    SPARI_TRY(spari_need_capacity(NULL, __func__, capacity));
    spari_fill(capacity, property, SPAR_SECTION_COUNT, d.p);
    SPARI_GIVE(findings, d.findings);
    return SPAR_OK;
}

/* ---- report ---- */

typedef struct report {
    char text[1000];
    size_t length;
} report;

static void SPARI_PRINTF(2, 3) say(report *r, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int more = vsnprintf(r->text + r->length, sizeof r->text - r->length, format, arguments);
    va_end(arguments);
    size_t room = sizeof r->text - r->length - 1;
    r->length += more < 0 ? 0 : (size_t)more < room ? (size_t)more : room;
}

static void say_couplings(const described *d, report *r) {
    static const char *const names[] = {"bending and torsion", "stretch and torsion", "stretch and shear",
                                        "bending and shear"};
    for (int k = 0; k < 4; k++) {
        if (d->findings & SPAR_FINDING_BEND_TWIST << k) {
            say(r, "%s are coupled, coefficient %.3f\n", names[k], d->coupling[k]);
        }
    }
}

static void say_findings(const described *d, report *r) {
    static const struct {
        int finding;
        const char *text;
    } plain[] = {{SPAR_FINDING_ASYMMETRIC, "the stiffness is not symmetric\n"},
                 {SPAR_FINDING_INDEFINITE, "the stiffness is not positive definite\n"},
                 {SPAR_FINDING_ORDER, "the order looks like BeamDyn's; spar's is axial, shears, torsion, bendings\n"}};
    for (size_t k = 0; k < sizeof plain / sizeof *plain; k++) {
        if (d->findings & plain[k].finding) {
            say(r, "%s", plain[k].text);
        }
    }
    if (d->mass_fault) {
        say(r, "the mass is not that of a plane section: %s\n", d->mass_fault);
    }
    say_couplings(d, r);
    if (d->findings & SPAR_FINDING_POLAR) {
        say(r, "the inertia about x, %.4g, is not the sum of those about y and z, %.4g\n", d->polar, d->sum);
    }
    if (d->findings & SPAR_FINDING_UNITS) {
        double ratio[RATIOS];
        find_ratios(d->p, ratio);
        for (int i = 0; i < RATIOS; i++) {
            if (is_odd(ratio, i)) {
                say(r, ratios[i].text, ratio[i]);
                say(r, "\n");
            }
        }
    }
}

int spar_section_report(const double stiffness[36], const double mass[36], int64_t capacity, char *text) {
    SPARI_GUARD_ENVIRONMENT;
    described d = {0};
    report r = {{0}, 0};
    SPARI_TRY(describe(__func__, stiffness, mass, &d));
    SPARI_TRY(spari_need_capacity(NULL, __func__, capacity));
    SPARI_REQUIRE(NULL, text, SPAR_ERR_ARGUMENT, "%s: text is NULL", __func__);
    say_findings(&d, &r);
    SPARI_REQUIRE(NULL, (size_t)capacity > r.length, SPAR_ERR_ARGUMENT,
                  "%s: the text needs %lld characters; the buffer has %lld", __func__, (long long)r.length + 1,
                  (long long)capacity);
    memcpy(text, r.text, r.length + 1);
    return SPAR_OK;
}

/* ---- transform ---- */

int spar_section_transform(const double matrix[36], double y, double z, double angle, double out[36]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, matrix && out, SPAR_ERR_ARGUMENT, "%s: matrix or out is NULL", __func__);
    int64_t at = spari_first_nonfinite(matrix, 36);
    SPARI_REQUIRE(NULL, at < 0, SPAR_ERR_ARGUMENT,
                  "%s: entry %lld of the matrix is not a finite number; give finite numbers", __func__, (long long)at);
    SPARI_REQUIRE(NULL, isfinite(y) && isfinite(z) && isfinite(angle), SPAR_ERR_ARGUMENT,
                  "%s: y, z or angle is not a finite number; give finite numbers", __func__);
    double T[36], made[36];
    centres(-y, -z, -y, -z, T); /* old strains from those at the new line */
    congruence(T, matrix, made);
    rotation(angle, angle, T);
    congruence(T, made, made);
    SPARI_REQUIRE(NULL, spari_first_nonfinite(made, 36) < 0, SPAR_ERR_NUMERIC,
                  "%s: the result is too large for a number; the line is too far", __func__);
    memcpy(out, made, sizeof made);
    return SPAR_OK;
}
