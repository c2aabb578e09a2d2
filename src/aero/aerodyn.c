/* Blades from AeroDyn's files: positions of the aerodynamic centres, and chord, twist and polar of each section.
   AeroDyn's blade axes are x downwind, y towards the trailing edge, z along the blade. In spar's order, z x y, a
     centre is at (span, curve, sweep). The chord of a section, from leading to trailing edge, is the third axis,
     rotated by the twist from the third towards the second: the leading edge moves upwind. */
#include "aerodyn.h"
#include "../base/environment.h"
#include "../math/rotation.h"
#include "aero.h"
#include "message.h"

#include <stdlib.h>
#include <string.h>

/* Tolerances: span at the ends of the blade, relative to its length; unit length; twist differences between blades,
   rad. */
#define SPARI_SPAN_SLACK 1e-6
#define SPARI_UNIT_SLACK 1e-6
#define SPARI_TWIST_SLACK 1e-6

/* ---- interpolation along the blade ---- */

static double station(const spari_blade *blade, int i, int column) {
    return blade->row[(int64_t)i * SPARI_BLADE_COLUMNS + column];
}

/* Stations i and i + 1 around a span, and the fraction between them. */
static int find_stations(const spari_blade *blade, double span, int *i, double *t) {
    double first = station(blade, 0, SPARI_BLADE_SPAN), last = station(blade, blade->stations - 1, SPARI_BLADE_SPAN);
    double slack = SPARI_SPAN_SLACK * (last - first);
    if (!(span >= first - slack && span <= last + slack)) {
        return 1;
    }
    *i = 0;
    while (*i + 2 < blade->stations && span >= station(blade, *i + 1, SPARI_BLADE_SPAN)) {
        ++*i;
    }
    double from = station(blade, *i, SPARI_BLADE_SPAN), to = station(blade, *i + 1, SPARI_BLADE_SPAN);
    *t = fmin(fmax((span - from) / (to - from), 0.0), 1.0);
    return 0;
}

static double mean_at(const spari_blade *blade, int i, double t, int column) {
    double a = station(blade, i, column), b = station(blade, i + 1, column);
    return t < 1 ? a + t * (b - a) : b;
}

static int check_spans(const spar_session *session, const char *call, const char *name, const spari_blade *blade,
                       int64_t n, const double *span) {
    for (int64_t k = 0; k < n; k++) {
        int i;
        double t;
        SPARI_AERO_REQUIRE(session, find_stations(blade, span[k], &i, &t) == 0, SPAR_ERR_ARGUMENT,
                           "%s: '%s': section %lld is at span %g; the blade file covers %g to %g", call, name,
                           (long long)k, span[k], station(blade, 0, SPARI_BLADE_SPAN),
                           station(blade, blade->stations - 1, SPARI_BLADE_SPAN));
    }
    return SPAR_OK;
}

/* Orientation of AeroDyn's axes on the member's reference: its placement times q, if given. */
static int find_axes(const spar_session *session, const char *call, const spar_member *member, const double *q,
                     double x[3], double axes[4]) {
    SPARI_TRY(spar_member_get_placement(member, x, axes));
    if (q) {
        double size = sqrt(spari_quat_dot(q, q));
        SPARI_AERO_REQUIRE(session, fabs(size - 1.0) <= SPARI_UNIT_SLACK, SPAR_ERR_ARGUMENT,
                           "%s: '%s': q has length %g; give a unit quaternion, scalar first", call,
                           spar_member_get_name(member), size);
        spari_quat_mul(axes, q, axes);
        spari_quat_normalise(axes);
    }
    return SPAR_OK;
}

/* ---- aerodynamic centres ---- */

/* Their reference positions; span NULL: at the stations. */
static void place_centres(const spari_blade *blade, int64_t n, const double *span, const double root[3],
                          const double axes[4], double *x) {
    for (int64_t k = 0; k < n; k++) {
        int i = 0;
        double t = 0;
        (void)find_stations(blade, span ? span[k] : station(blade, (int)k, SPARI_BLADE_SPAN), &i, &t);
        for (int c = 0; c < 3; c++) {
            x[3 * k + c] = mean_at(blade, i, t, SPARI_BLADE_SPAN + c);
        }
        spari_rotate(axes, x + 3 * k, x + 3 * k);
        for (int c = 0; c < 3; c++) {
            x[3 * k + c] += root[c];
        }
    }
}

/* Nearest points of the positions on the member's line, by a temporary fluid: eta, and lever arms in the section
   frames, which replace x. work [7 n] */
static int find_feet(spar_member *member, const char *name, int64_t n, double *x, double *eta, double *work) {
    spar_fluid *fluid = NULL;
    double *q = work, *arm = work + 4 * n;
    SPARI_TRY(spar_fluid_create(member, name, &fluid));
    int status = spar_fluid_set_motion_nodes(fluid, n, x);
    status = status == SPAR_OK ? spar_fluid_map(fluid) : status;
    status = status == SPAR_OK ? spar_fluid_get_map(fluid, SPAR_NODES_MOTION, eta, NULL, NULL) : status;
    status = status == SPAR_OK ? spar_fluid_get_nearest(fluid, SPAR_NODES_MOTION, NULL, q, arm) : status;
    spar_fluid_destroy(&fluid);
    for (int64_t k = 0; k < n && status == SPAR_OK; k++) {
        double back[4];
        spari_quat_conj(q + 4 * k, back);
        spari_rotate(back, arm + 3 * k, x + 3 * k);
    }
    return status;
}

static int set_centres(spar_fluid *fluid, const spar_session *session, const char *call, const spari_blade *blade,
                       const double *q, int64_t n, const double *span) {
    const char *name = spar_fluid_get_name(fluid);
    double root[3], axes[4];
    spar_member *member;
    SPARI_TRY(spar_fluid_get_member(fluid, &member));
    SPARI_TRY(find_axes(session, call, member, q, root, axes));
    SPARI_TRY(span ? check_spans(session, call, name, blade, n, span) : SPAR_OK);
    n = span ? n : blade->stations;
    double *x = spari_zalloc(11 * n, sizeof *x);
    SPARI_AERO_REQUIRE(session, x, SPAR_ERR_MEMORY, "%s: '%s': no memory for %lld sections", call, name, (long long)n);
    place_centres(blade, n, span, root, axes, x);
    int status = find_feet(member, name, n, x, x + 3 * n, x + 4 * n);
    status = status == SPAR_OK ? spar_fluid_set_stations(fluid, n, x + 3 * n, x) : status;
    free(x);
    return status;
}

int spar_fluid_read_aerodyn(spar_fluid *fluid, const char *primary_path, const char *blade_path, const double q[4],
                            int64_t n, const double *span) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_AERO_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "%s: the fluid is NULL; create it with spar_fluid_create",
                       __func__);
    spar_member *member;
    spar_session *session;
    SPARI_TRY(spar_fluid_get_member(fluid, &member));
    SPARI_TRY(spar_member_get_session(member, &session));
    const char *name = spar_fluid_get_name(fluid);
    SPARI_AERO_REQUIRE(session, primary_path, SPAR_ERR_ARGUMENT, "%s: '%s': primary_path is NULL", __func__, name);
    SPARI_AERO_REQUIRE(session, n >= 0 && n <= SPARI_MOST, SPAR_ERR_ARGUMENT, "%s: '%s': %lld sections", __func__, name,
                       (long long)n);
    SPARI_AERO_REQUIRE(
        session, span || n == 0, SPAR_ERR_ARGUMENT,
        "%s: '%s': span is NULL for %lld sections; give their spans, or NULL and n = 0 for the stations of the file",
        __func__, name, (long long)n);
    spari_blade blade = {0};
    int status = spari_blade_read(&blade, session, __func__, name, primary_path, blade_path, 0);
    status = status == SPAR_OK ? set_centres(fluid, session, __func__, &blade, q, n, span) : status;
    spari_blade_free(&blade);
    return spari_aero_named(session, __func__, status);
}

/* ---- polars ---- */

/* Polar between two airfoils: weighted mean of their coefficients at every angle of either. */
static int blend_polars(const spari_airfoil *a, const spari_airfoil *b, double t, spar_polar **polar) {
    spari_airfoil both;
    if (spari_airfoil_blend(a, b, t, &both)) {
        return SPAR_ERR_MEMORY;
    }
    int status = spari_airfoil_polar(&both, polar);
    free(both.alpha);
    return status;
}

/* Polar at a span: that of a station, or between two. */
static int polar_at(const spari_blade *blade, int i, double t, spar_polar **polar) {
    const spari_airfoil *a = blade->airfoil + (int)station(blade, i, SPARI_BLADE_AIRFOIL) - 1,
                        *b = blade->airfoil + (int)station(blade, i + 1, SPARI_BLADE_AIRFOIL) - 1;
    if (a == b || t == 0) {
        return spari_airfoil_polar(a, polar);
    }
    return t == 1 ? spari_airfoil_polar(b, polar) : blend_polars(a, b, t, polar);
}

/* ---- sections ---- */

/* Rotation from the section frames to the chord direction: the twist of spar_aero_set_section. work [4 n] */
static int find_twists(const spar_aero *aero, const char *call, int b, const spari_blade *blade, const double *span,
                       const double *q, double *twist, double *work) {
    double root[3], axes[4];
    spar_member *member;
    SPARI_TRY(spar_fluid_get_member(aero->fluid[b], &member));
    SPARI_TRY(find_axes(aero->session, call, member, q, root, axes));
    SPARI_TRY(spar_fluid_get_nearest(aero->fluid[b], SPAR_NODES_MOTION, NULL, work, NULL));
    for (int64_t k = 0; k < aero->n; k++) {
        int i = 0;
        double t = 0, back[4];
        (void)find_stations(blade, span ? span[k] : station(blade, (int)k, SPARI_BLADE_SPAN), &i, &t);
        double angle = mean_at(blade, i, t, SPARI_BLADE_TWIST), chord[3] = {0, sin(angle), cos(angle)};
        spari_rotate(axes, chord, chord);
        spari_quat_conj(work + 4 * k, back);
        spari_rotate(back, chord, chord);
        twist[k] = atan2(-chord[2], chord[1]);
    }
    return SPAR_OK;
}

/* All blades share one set of sections, so the twist must be the same on all. twist [n]; work [5 n] */
static int find_common_twists(const spar_aero *aero, const char *call, const spari_blade *blade, const double *span,
                              const double *q, double *twist, double *work) {
    SPARI_TRY(find_twists(aero, call, 0, blade, span, q, twist, work));
    for (int b = 1; b < aero->blades; b++) {
        double *other = work + 4 * aero->n;
        SPARI_TRY(find_twists(aero, call, b, blade, span, q, other, work));
        for (int64_t k = 0; k < aero->n; k++) {
            SPARI_AERO_REQUIRE(
                aero->session, fabs(sin(0.5 * (other[k] - twist[k]))) <= SPARI_TWIST_SLACK, SPAR_ERR_ARGUMENT,
                "%s: section %lld of blade %d ('%s') has a remaining twist of %g rad, blade 0 has %g; make "
                "the blades identical, or create an aero object for each",
                call, (long long)k, b, spar_fluid_get_name(aero->fluid[b]), other[k], twist[k]);
        }
    }
    return SPAR_OK;
}

/* Moments first: only the first of them may need memory, so the change is all or nothing. */
static int set_all(spar_aero *aero, const spari_blade *blade, const double *span, const double *twist,
                   spar_polar *const *polar) {
    for (int moments = 1; moments >= 0; moments--) {
        for (int64_t k = 0; k < aero->n; k++) {
            int i = 0;
            double t = 0;
            (void)find_stations(blade, span ? span[k] : station(blade, (int)k, SPARI_BLADE_SPAN), &i, &t);
            spari_table *table = spari_polar_share(polar[k]);
            int has = spari_table_has_moment(table);
            spari_table_release(table);
            if (has == moments) {
                SPARI_TRY(spar_aero_set_section(aero, k, mean_at(blade, i, t, SPARI_BLADE_CHORD), twist[k], polar[k]));
            }
        }
    }
    return SPAR_OK;
}

static int make_polars(const spar_aero *aero, const char *call, const spari_blade *blade, const double *span,
                       spar_polar **polar) {
    for (int64_t k = 0; k < aero->n; k++) {
        int i = 0;
        double t = 0;
        (void)find_stations(blade, span ? span[k] : station(blade, (int)k, SPARI_BLADE_SPAN), &i, &t);
        int status = polar_at(blade, i, t, &polar[k]);
        SPARI_AERO_REQUIRE(aero->session, status == SPAR_OK, status, "%s: the polar of section %lld: %s", call,
                           (long long)k, status == SPAR_ERR_MEMORY ? "no memory" : spar_session_message(NULL));
    }
    return SPAR_OK;
}

/* Checks that the fluids have the number of sections of the object. */
static int check_counts(const spar_aero *aero, const char *call) {
    for (int b = 0; b < aero->blades; b++) {
        int64_t n;
        SPARI_TRY(spar_fluid_get_count(aero->fluid[b], SPAR_NODES_MOTION, &n));
        SPARI_AERO_REQUIRE(
            aero->session, n == aero->n, SPAR_ERR_STATE,
            "%s: fluid '%s' had %lld sections when the aero object was created and has %lld now; make a new one", call,
            spar_fluid_get_name(aero->fluid[b]), (long long)aero->n, (long long)n);
    }
    return SPAR_OK;
}

static int fill_sections(spar_aero *aero, const char *call, const spari_blade *blade, const double *q,
                         const double *span) {
    int64_t n = aero->n;
    SPARI_AERO_REQUIRE(
        aero->session, span || n == blade->stations, SPAR_ERR_ARGUMENT,
        "%s: the blade file has %d stations and the blades %lld sections; give the spans of the sections", call,
        blade->stations, (long long)n);
    SPARI_TRY(span ? check_spans(aero->session, call, spar_fluid_get_name(aero->fluid[0]), blade, n, span) : SPAR_OK);
    double *twist = spari_zalloc(6 * n, sizeof *twist);
    spar_polar **polar = spari_zalloc(n, sizeof(spar_polar *));
    int status = twist && polar ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status != SPAR_OK) {
        spari_aero_fail(aero->session, status, "%s: no memory for %lld sections", call, (long long)n);
    }
    status = status == SPAR_OK ? find_common_twists(aero, call, blade, span, q, twist, twist + n) : status;
    status = status == SPAR_OK ? make_polars(aero, call, blade, span, polar) : status;
    status = status == SPAR_OK ? set_all(aero, blade, span, twist, polar) : status;
    for (int64_t k = 0; polar && k < n; k++) {
        spar_polar_destroy(&polar[k]);
    }
    free(polar);
    free(twist);
    return status;
}

int spar_aero_read_aerodyn(spar_aero *aero, const char *primary_path, const char *blade_path, const double q[4],
                           const double *span) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_AERO_REQUIRE(NULL, aero, SPAR_ERR_ARGUMENT, "%s: the aero object is NULL; create it with spar_aero_create",
                       __func__);
    SPARI_AERO_REQUIRE(aero->session, primary_path, SPAR_ERR_ARGUMENT, "%s: primary_path is NULL", __func__);
    SPARI_AERO_REQUIRE(aero->session, aero->rotor.turn == 1, SPAR_ERR_UNSUPPORTED,
                       "%s: these files describe blades that rotate right-handed about the downwind axis, but "
                       "spar_aero_set_turn has mirrored the sections",
                       __func__);
    SPARI_TRY(spari_aero_named(aero->session, __func__, check_counts(aero, __func__)));
    spari_blade blade = {0};
    const char *name = aero->blades > 0 ? spar_fluid_get_name(aero->fluid[0]) : "no blade";
    int status = spari_blade_read(&blade, aero->session, __func__, name, primary_path, blade_path, 1);
    if (status == SPAR_OK && aero->blades > 0) {
        status = fill_sections(aero, __func__, &blade, q, span);
    }
    spari_blade_free(&blade);
    return spari_aero_named(aero->session, __func__, status);
}
