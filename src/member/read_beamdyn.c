/* Reads blades from BeamDyn's input: the primary file (key points, twist, name of the blade file) and the blade file
   (stations, 6x6 matrices, damping). Formats: OpenFAST documentation, BeamDyn user's guide, sections 4.1 and 4.2.
   BeamDyn's frame has z along the blade, spar's x: (x, y, z) = (z, x, y) of BeamDyn, a cyclic permutation, so no
     sign changes. Its matrices are ordered (shear x, shear y, axial, bending x, bending y, torsion). Its twist is
     about -z (the sign of wind-turbine blades), spar's is right-handed about the tangent. The key points of a member
     are connected by cubic splines over z, natural at their ends. */
#include "../base/environment.h"
#include "../base/reader.h"
#include "../math/spline.h"
#include "beam.h"
#include "check_arguments.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Of the first and last station, which files print with about 6 digits. */
#define END_SLACK 1e-5

/* File contents, in BeamDyn's order and units. */
typedef struct blade {
    int members, points, stations, damped, ratios;
    int *count;        /* [members] key points of each */
    double *key;       /* [points][4] x, y, z, twist in degrees */
    double *eta;       /* [stations] */
    double *stiffness; /* [stations][36] */
    double *mass;
    int *line; /* [stations] */
    double mu[6];
    const char *primary; /* path of the primary file */
    char *file;          /* name of the blade file in it */
} blade;

/* ---- the files ---- */

static int read_primary(spari_reader *r, blade *b) {
    int total = 1;
    SPARI_TRY(spari_read_key(r, "member_total"));
    SPARI_TRY(spari_read_whole(r, "member_total", 1, 0, &b->members));
    SPARI_TRY(spari_read_key(r, "kp_total"));
    SPARI_TRY(spari_read_whole(r, "kp_total", 2, 0, &b->points));
    b->count = spari_zalloc(b->members, sizeof *b->count);
    b->key = spari_zalloc(4 * (int64_t)b->points, sizeof *b->key);
    if (!b->count || !b->key) {
        return spari_read_no_memory(r);
    }
    for (int i = 0; i < b->members; i++) {
        SPARI_TRY(spari_read_line(r, "the number of key points of a member"));
        SPARI_TRY(spari_read_whole(r, "the number of key points of a member", 2, 1, &b->count[i]));
        total += b->count[i] - 1;
    }
    if (total != b->points) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO,
                               "the members have %d key points, shared ends counted once, but kp_total is %d", total,
                               b->points);
    }
    SPARI_TRY(spari_read_line(r, "the header of the key points"));
    SPARI_TRY(spari_read_line(r, "the units of the key points"));
    for (int i = 0; i < b->points; i++) {
        SPARI_TRY(spari_read_line(r, "a key point"));
        SPARI_TRY(spari_read_numbers(r, "kp_xr, kp_yr, kp_zr, initial_twist", 4, b->key + 4 * (int64_t)i));
        const double *now = b->key + 4 * (int64_t)i;
        if (i > 0 && !(now[2] > now[-2])) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "kp_zr is %g and is not above the previous one (%g)", now[2],
                                   now[-2]);
        }
    }
    SPARI_TRY(spari_read_last(r, "kp_total", b->points, 4));
    SPARI_TRY(spari_read_key(r, "BldFile"));
    const char *at = r->line;
    spari_read_word(&at, r->word);
    b->file = spari_read_beside(r, r->word);
    return b->file ? SPAR_OK : spari_read_no_memory(r);
}

/* Ratios of modes need the modes of the committed beam: they are checked, and told. */
static int read_ratios(spari_reader *r, blade *b) {
    SPARI_TRY(spari_read_key(r, "n_modes"));
    SPARI_TRY(spari_read_whole(r, "n_modes", 1, 0, &b->ratios));
    double *ratio = spari_zalloc(b->ratios, sizeof *ratio);
    if (!ratio) {
        return spari_read_no_memory(r);
    }
    int status = spari_read_line(r, "zeta");
    status = status == SPAR_OK ? spari_read_numbers(r, "zeta", b->ratios, ratio) : status;
    for (int i = 0; i < b->ratios && status == SPAR_OK; i++) {
        if (!(ratio[i] >= 0 && ratio[i] < 1)) {
            status = SPARI_READ_FAIL(r, SPAR_ERR_IO, "zeta of mode %d is %g; give a ratio of critical, 0 to 1", i + 1,
                                     ratio[i]);
        }
    }
    free(ratio);
    return status;
}

static int read_damping(spari_reader *r, blade *b) {
    int type = 0;
    SPARI_TRY(spari_read_key(r, "damp_type"));
    SPARI_TRY(spari_read_whole(r, "damp_type", 0, 0, &type));
    if (type > 2) {
        return SPARI_READ_FAIL(
            r, SPAR_ERR_UNSUPPORTED,
            "damp_type is %d; 0 (none), 1 (stiffness-proportional) and 2 (ratios of modes) are known", type);
    }
    b->damped = type == 1;
    if (type == 2) {
        return read_ratios(r, b);
    }
    for (;;) {
        SPARI_TRY(spari_read_line(r, "mu1"));
        const char *at = r->line;
        if (spari_read_word(&at, r->word) && strcasecmp(r->word, "mu1") == 0) {
            break;
        }
    }
    SPARI_TRY(spari_read_line(r, "the units of mu1 to mu6"));
    SPARI_TRY(spari_read_line(r, "mu1 to mu6"));
    SPARI_TRY(spari_read_numbers(r, "mu1 to mu6", 6, b->mu));
    for (int i = 0; i < 6; i++) {
        if (b->mu[i] < 0) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "mu%d is negative", i + 1);
        }
    }
    return SPAR_OK;
}

static int read_matrix(spari_reader *r, const char *what, double *M) {
    for (int i = 0; i < 6; i++) {
        SPARI_TRY(i == 0 ? spari_read_filled(r, what) : spari_read_line(r, what));
        SPARI_TRY(spari_read_numbers(r, what, 6, M + 6 * i));
    }
    return SPAR_OK;
}

static int read_matrices_of(spari_reader *r, blade *b, int64_t i) {
    const double *at = b->eta + i;
    SPARI_TRY(spari_read_filled(r, "the position of a station"));
    SPARI_TRY(spari_read_numbers(r, "the position of a station", 1, b->eta + i));
    b->line[i] = r->number;
    if ((i == 0 && fabs(*at) > END_SLACK) || (i > 0 && !(*at > at[-1])) ||
        (i == b->stations - 1 && fabs(*at - 1) > END_SLACK)) {
        return SPARI_READ_FAIL(
            r, SPAR_ERR_IO, "station %lld of %d is at %g; the first must be at 0, the last at 1, and all must increase",
            (long long)i + 1, b->stations, *at);
    }
    SPARI_TRY(read_matrix(r, "stiffness matrix", b->stiffness + 36 * i));
    return read_matrix(r, "mass matrix", b->mass + 36 * i);
}

static int read_blade(spari_reader *r, blade *b) {
    SPARI_TRY(spari_read_key(r, "station_total"));
    SPARI_TRY(spari_read_whole(r, "station_total", 2, 0, &b->stations));
    SPARI_TRY(read_damping(r, b));
    do {
        SPARI_TRY(spari_read_line(r, "the heading 'distributed properties'"));
        for (char *c = r->line; *c; c++) {
            *c = (char)toupper((unsigned char)*c);
        }
    } while (!strstr(r->line, "DISTRIBUTED PROPERTIES"));
    int64_t n = b->stations;
    b->eta = spari_zalloc(n, sizeof *b->eta);
    b->stiffness = spari_zalloc(36 * n, sizeof *b->stiffness);
    b->mass = spari_zalloc(36 * n, sizeof *b->mass);
    b->line = spari_zalloc(n, sizeof *b->line);
    if (!b->eta || !b->stiffness || !b->mass || !b->line) {
        return spari_read_no_memory(r);
    }
    for (int64_t i = 0; i < n; i++) {
        SPARI_TRY(read_matrices_of(r, b, i));
    }
    return spari_read_last(r, "station_total", b->stations, 1);
}

/* ---- conversion to spar's frame ---- */

/* spar's [i] = BeamDyn's [from[i]] */
static const int FROM[6] = {2, 0, 1, 5, 3, 4};

static void permute_axes(double *M) {
    double old[36];
    memcpy(old, M, sizeof old);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            M[6 * i + j] = old[6 * FROM[i] + FROM[j]];
        }
    }
}

static int check_sections(const spari_reader *r, const blade *b) {
    for (int64_t i = 0; i < b->stations; i++) {
        double m, c[3], J[6];
        const char *wrong = spari_stiffness_fault(b->stiffness + 36 * i);
        SPARI_REQUIRE(r->session, !wrong, SPAR_ERR_ARGUMENT,
                      "%s: '%s': %s, line %d: the stiffness matrix of station %lld is %s", r->call, r->subject, r->path,
                      b->line[i], (long long)i + 1, wrong);
        wrong = spari_mass_split(b->mass + 36 * i, &m, c, J);
        SPARI_REQUIRE(r->session, !wrong, SPAR_ERR_ARGUMENT,
                      "%s: '%s': %s, line %d: the mass matrix of station %lld is not that of a rigid section: "
                      "%s",
                      r->call, r->subject, r->path, b->line[i], (long long)i + 1, wrong);
    }
    return SPAR_OK;
}

/* Points on the splines of all members, enough in each key-point interval for a fit to follow the splines: position
   (spar's axes), twist in radians, eta by arc length. */
typedef struct axis {
    int64_t n;
    double *eta, *xyz, *twist, length;
} axis;

enum { AXIS_POINTS = 400, FINE = 16 };

/* work [5][count] */
static int member_axis(const blade *b, int first, int count, int each, spari_spline s[4], double *work, axis *a) {
    double *z = work;
    int64_t near = 0;
    spari_spline_kind kind = count > 3 ? SPARI_SPLINE_CUBIC : count == 3 ? SPARI_SPLINE_PARABOLA : SPARI_SPLINE_LINEAR;
    for (int k = 0; k < 4; k++) { /* spline of each column over z */
        double *y = work + count * (k + 1);
        for (int i = 0; i < count; i++) {
            z[i] = b->key[4 * (int64_t)(first + i) + 2];
            y[i] = b->key[4 * (int64_t)(first + i) + k];
        }
        if (spari_spline_create(s + k, kind, count, z, y)) {
            return 1;
        }
    }
    for (int i = 0; i < count - 1; i++) {
        for (int j = 0; j < each; j++) {
            int64_t at = ++a->n;
            double from = z[i] + (z[i + 1] - z[i]) * j / each, to = z[i] + (z[i + 1] - z[i]) * (j + 1) / each, arc = 0;
            to = j + 1 == each ? z[i + 1] : to;
            for (int g = 0; g < FINE; g++) { /* 2-point Gauss in each part: arc length to 1e-12 */
                for (int side = -1; side <= 1; side += 2) {
                    double h = (to - from) / FINE, t = from + h * (g + 0.5 + 0.5 * side / sqrt(3.0)), slope[2];
                    (void)spari_spline_at(s, t, &near, slope);
                    (void)spari_spline_at(s + 1, t, &near, slope + 1);
                    arc += 0.5 * h * sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
                }
            }
            a->eta[at] = a->eta[at - 1] + arc;
            a->xyz[3 * at] = to;
            a->xyz[3 * at + 1] = spari_spline_at(s, to, &near, NULL);
            a->xyz[3 * at + 2] = spari_spline_at(s + 1, to, &near, NULL);
            a->twist[at] = -spari_spline_at(s + 3, to, &near, NULL) * (3.14159265358979323846 / 180);
        }
    }
    return 0;
}

static int make_axis(const blade *b, axis *a) {
    int each = 1 + AXIS_POINTS / b->points;
    int64_t n = 1 + (int64_t)each * (b->points - 1);
    double *work = spari_zalloc(5 * (int64_t)b->points, sizeof *work);
    a->eta = spari_zalloc(n, sizeof *a->eta);
    a->xyz = spari_zalloc(3 * n, sizeof *a->xyz);
    a->twist = spari_zalloc(n, sizeof *a->twist);
    int bad = !work || !a->eta || !a->xyz || !a->twist;
    if (!bad) {
        a->xyz[0] = b->key[2], a->xyz[1] = b->key[0], a->xyz[2] = b->key[1];
        a->twist[0] = -b->key[3] * (3.14159265358979323846 / 180);
    }
    a->n = 0;
    for (int m = 0, first = 0; m < b->members && !bad; first += b->count[m] - 1, m++) {
        spari_spline s[4] = {{0}};
        bad = member_axis(b, first, b->count[m], each, s, work, a);
        for (int k = 0; k < 4; k++) {
            spari_spline_free(s + k);
        }
    }
    free(work);
    a->length = bad ? 0 : a->eta[n - 1];
    if (bad) {
        return 1;
    }
    for (int64_t i = 1; i < n; i++) {
        a->eta[i] /= a->eta[n - 1] > 0 && i < n - 1 ? a->eta[n - 1] : 1;
    }
    a->eta[n - 1] = 1;
    a->n = n;
    return 0;
}

/* Describes the beam with the data read; after a refusal the beam keeps its earlier description. */
static int describe_blade(spar_member *m, const spari_reader *r, blade *b) {
    double mu[6];
    axis a = {0};
    for (int64_t i = 0; i < b->stations; i++) {
        permute_axes(b->stiffness + 36 * i);
        permute_axes(b->mass + 36 * i);
    }
    for (int i = 0; i < 6; i++) {
        mu[i] = b->damped ? b->mu[FROM[i]] : 0;
    }
    SPARI_TRY(check_sections(r, b));
    spari_beam *fresh = spari_zalloc(1, sizeof *fresh), *old = m->beam;
    int status = fresh && make_axis(b, &a) == 0 ? SPAR_OK : spari_read_no_memory(r);
    if (status == SPAR_OK && !isfinite(a.length)) {
        status = spari_fail(r->session, SPAR_ERR_ARGUMENT,
                            "%s: '%s': %s: the line through the key points has no finite length; give positions in m",
                            r->call, r->subject, b->primary);
    }
    if (status == SPAR_OK) {
        fresh->rule = old->rule, fresh->points = old->points;
        m->beam = fresh;
        status = spar_beam_set_axis(m, a.n, a.eta, a.xyz, a.twist);
        status = status == SPAR_OK ? spar_beam_set_sections(m, b->stations, b->eta, b->stiffness, b->mass) : status;
        status = status == SPAR_OK ? spar_beam_set_damping(m, mu) : status;
        m->beam = status == SPAR_OK ? fresh : old;
    }
    spari_beam_free(status == SPAR_OK ? old : fresh);
    SPARI_FREE(a.eta, a.xyz, a.twist);
    return status;
}

int spar_beam_read_beamdyn(spar_member *beam, const char *primary_path, const char *blade_path) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_REQUIRE(beam->session, primary_path, SPAR_ERR_ARGUMENT, "%s: '%s': primary_path is NULL", __func__,
                  beam->name);
    blade b = {.primary = primary_path};
    spari_reader *r = spari_zalloc(1, sizeof *r);
    SPARI_REQUIRE(beam->session, r, SPAR_ERR_MEMORY, "%s: no memory for '%s'", __func__, beam->name);
    r->fail = spari_fail;
    r->session = beam->session;
    r->subject = beam->name;
    r->call = __func__;
    int status = spari_read_open(r, primary_path);
    if (status == SPAR_OK) {
        status = read_primary(r, &b);
        fclose(r->file);
    }
    status = status == SPAR_OK ? spari_read_open(r, blade_path ? blade_path : b.file) : status;
    if (status == SPAR_OK) {
        status = read_blade(r, &b);
        fclose(r->file);
    }
    status = status == SPAR_OK ? describe_blade(beam, r, &b) : status;
    if (status == SPAR_OK && b.ratios > 0) {
        spari_warn(
            beam->session,
            "'%s': the damping ratios of %d modes in %s (zeta) are not in force; give them to spar_beam_fit_damping "
            "after the commit",
            beam->name, b.ratios, blade_path ? blade_path : b.file);
    }
    SPARI_FREE(b.count, b.key, b.eta, b.stiffness, b.mass, b.line, b.file, r);
    return spari_named(beam->session, __func__, status);
}
