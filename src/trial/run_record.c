/* Results of a trial run: see run_record.h. */
#include "run_record.h"

#include "../base/session.h"
#include "../comm/enter.h"
#include "../math/basis.h"
#include "../math/resample.h"
#include "../math/rotation.h"
#include "../member/beam.h"
#include "../member/joint.h"
#include "../member/structure.h"
#include "../solve/reaction.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Positions along a beam; a member of one node has its position and three lever arms. RECENT: points of a cubic. */
enum { STATIONS = 8, ARMS = 4, PLACES = 9, RECENT = 4 };
/* A motion with fewer periods in a run counts as incomplete. */
enum { LEAST_PERIODS = 4 };
static const double pi = 3.14159265358979323846;
/* Growth of errors: largest power of time; ratio of two thirds below which it may be chance; margin of what is
   extrapolated. And the change of a motion that counts as steady. */
static const double most_power = 2, by_chance = 1.2, doubt = 1.25, settled = 0.1;

/* ---- a sample ---- */

/* Members with prescribed motion have no error. */
static int stations_of(const spar_member *m) {
    return m->kind == SPARI_POINT ? 0 : m->nodes == 1 ? ARMS : STATIONS;
}

/* Element of a position on a beam, and its coordinate there, -1 .. 1. */
static int place_of_station(const spar_member *m, int k, double *xi) {
    double eta = (k + 1.0) / STATIONS * m->mesh.elements;
    int e = (int)ceil(eta) - 1;
    *xi = 2 * (eta - e) - 1;
    return e;
}

/* Basis functions at the positions of all beams, constant through a run. */
static void find_bases(const spar_session *s, double *basis) {
    for (const spar_member *m = s->members; m; m = m->next) {
        for (int k = 0; k < stations_of(m); k++, basis += SPARI_MAX_NODES) {
            double xi = 0;
            (void)place_of_station(m, k, &xi);
            if (m->nodes > 1) {
                spari_resample_basis(m->mesh.per_element, xi, basis);
            }
        }
    }
}

/* Reference position of a point of a beam, and its displacement. */
static void beam_station(const spar_member *m, int k, const double *phi, double X[3], double u[3]) {
    double xi;
    int e = place_of_station(m, k, &xi);
    for (int c = 0; c < 3; c++) {
        X[c] = u[c] = 0;
        for (int l = 0; l < m->mesh.per_element; l++) {
            int64_t i = (int64_t)e * m->mesh.per_element + l;
            X[c] += phi[l] * m->xr[3 * i + c];
            u[c] += phi[l] * m->after.q[7 * i + c];
        }
    }
}

/* End of a lever arm; k = 0: the node itself. */
static void body_station(const spar_member *m, int k, double X[3], double u[3]) {
    double arm[3] = {0, 0, 0}, turned[3];
    if (k > 0) {
        arm[k - 1] = spari_member_length(m);
    }
    spari_rotate(m->after.q + 3, arm, turned);
    for (int c = 0; c < 3; c++) {
        X[c] = m->xr[c] + arm[c];
        u[c] = m->after.q[c] + turned[c] - arm[c];
    }
}

/* The part of the displacement u at X beyond the rigid motion of the root. */
static void beyond_root(const spar_member *m, const double X[3], const double u[3], double out[3]) {
    double arm[3] = {X[0] - m->xr[0], X[1] - m->xr[1], X[2] - m->xr[2]}, turned[3];
    spari_rotate(m->after.q + 3, arm, turned);
    for (int c = 0; c < 3; c++) {
        out[c] = u[c] - m->after.q[c] - (turned[c] - arm[c]);
    }
}

static void look_at_motion(const spar_session *s, const spari_record *r, double *motion, double *beyond) {
    const double *start = r->start, *basis = r->basis;
    int64_t at = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        int constrained = m->kind == SPARI_BEAM && spari_member_root_is_prescribed(m);
        for (int k = 0; k < stations_of(m); k++, at += 3, basis += SPARI_MAX_NODES) {
            double X[3], *u = motion + at;
            if (m->nodes == 1) {
                body_station(m, k, X, u);
            } else {
                beam_station(m, k, basis, X, u);
            }
            if (constrained) {
                beyond_root(m, X, u, beyond + at);
            }
            for (int c = 0; c < 3 && !constrained; c++) {
                beyond[at + c] = u[c] - start[at + c];
            }
        }
    }
}

void spari_record_loads(const spar_session *s, double *load) {
    for (const spar_member *m = s->members; m; m = m->next, load += 6) {
        memset(load, 0, 6 * sizeof *load);
        for (int64_t i = 0; i < m->nodes; i++) {
            const double *f = m->load.pushed + 6 * i, *x = m->xr + 3 * i;
            double arm[3] = {x[0] - m->xr[0], x[1] - m->xr[1], x[2] - m->xr[2]}, t[3];
            spari_cross(arm, f, t);
            for (int c = 0; c < 3; c++) {
                load[c] += f[c];
                load[3 + c] += (t[c] + f[3 + c]) / spari_member_length(m);
            }
        }
    }
}

static void look_at_joints(const spar_session *s, double *load) {
    for (const spar_joint *j = s->joints; j; j = j->next, load += 6) {
        double length = spari_member_length(j->member[0]);
        memcpy(load, j->after.load, 6 * sizeof *load);
        for (int c = 3; c < 6; c++) {
            load[c] /= length;
        }
    }
}

static int has_sections(const spar_member *m) {
    return m->kind == SPARI_BEAM && m->beam->stiffness && !m->external;
}

static int look_at_sections(const spar_session *s, double *force) {
    double eta[PLACES];
    for (int i = 0; i < PLACES; i++) {
        eta[i] = i / (PLACES - 1.0);
    }
    for (const spar_member *m = s->members; m; m = m->next) {
        if (has_sections(m)) {
            SPARI_TRY(spar_beam_evaluate(m, PLACES, eta, NULL, force, NULL, NULL));
            for (int i = 0; i < 6 * PLACES; i++) {
                force[i] /= i % 6 < 3 ? 1 : spari_member_length(m);
            }
            force += 6 * PLACES;
        }
    }
    return SPAR_OK;
}

/* ---- memory ---- */

static int64_t width(const spari_record *r) {
    return r->first[SPARI_BLOCKS];
}

static void lay_sample_out(const spar_session *s, int goals, spari_record *r) {
    int64_t size[SPARI_BLOCKS] = {0};
    for (const spar_member *m = s->members; m; m = m->next) {
        r->stations += stations_of(m);
        r->members++;
    }
    size[SPARI_OF_MOTION] = size[SPARI_OF_BEYOND] = 3 * r->stations;
    size[SPARI_OF_REACTION] = goals & SPARI_GOAL(SPARI_OF_REACTION) ? 6 * (int64_t)r->members : 0;
    size[SPARI_OF_JOINT] = goals & SPARI_GOAL(SPARI_OF_REACTION) ? 6 * (int64_t)s->joint_count : 0;
    size[SPARI_OF_LOAD] = goals & SPARI_GOAL(SPARI_OF_LOAD) ? 6 * (int64_t)r->members : 0;
    size[SPARI_OF_NUMBERS] = goals & SPARI_GOAL(SPARI_OF_NUMBERS) ? SPARI_MOST_NUMBERS : 0;
    for (const spar_member *m = s->members; m && goals & SPARI_GOAL(SPARI_OF_SECTION); m = m->next) {
        size[SPARI_OF_SECTION] += has_sections(m) ? 6 * PLACES : 0;
    }
    for (int b = 0; b < SPARI_BLOCKS; b++) {
        r->first[b + 1] = r->first[b] + size[b];
    }
}

int spari_record_create(spar_session *s, int64_t steps, int goals, spari_record *r) {
    int64_t workspace = 0;
    *r = (spari_record){.steps = steps, .goals = goals};
    lay_sample_out(s, goals, r);
    for (const spar_member *m = s->members; m && r->goals & SPARI_GOAL(SPARI_OF_REACTION); m = m->next) {
        int64_t own = spari_member_reaction_size(m);
        workspace = workspace > own ? workspace : own;
    }
    r->value = spari_zalloc(SPARI_SAMPLES * width(r), sizeof *r->value);
    r->recent = spari_zalloc(RECENT * width(r), sizeof *r->recent);
    r->load = spari_zalloc(SPARI_LOADS * 6 * (int64_t)r->members, sizeof *r->load);
    r->trail = spari_zalloc(4 * 6 * (int64_t)r->members, sizeof *r->trail);
    r->start = spari_zalloc(3 * r->stations, sizeof *r->start);
    r->workspace = spari_zalloc(workspace, sizeof *r->workspace);
    r->basis = spari_zalloc(SPARI_MAX_NODES * r->stations, sizeof *r->basis);
    SPARI_REQUIRE(s, r->value && r->recent && r->load && r->trail && r->start && r->workspace && r->basis,
                  SPAR_ERR_MEMORY, "no memory for the record of a trial run");
    find_bases(s, r->basis);
    return SPAR_OK;
}

void spari_record_free(spari_record *r) {
    SPARI_FREE(r->value, r->recent, r->load, r->trail, r->start, r->workspace, r->basis);
    *r = (spari_record){0};
}

/* ---- sampling ---- */

static double *recent(const spari_record *r, int64_t i) {
    return r->recent + i % RECENT * width(r);
}

void spari_record_begin(spari_record *r, const spar_session *s) {
    double *now = recent(r, 0);
    look_at_motion(s, r, now + r->first[SPARI_OF_MOTION], now + r->first[SPARI_OF_BEYOND]);
    memcpy(r->start, now + r->first[SPARI_OF_MOTION], (size_t)(3 * r->stations) * sizeof *now);
    look_at_motion(s, r, now + r->first[SPARI_OF_MOTION], now + r->first[SPARI_OF_BEYOND]);
}

/* Time of sample k, in steps from the beginning. */
static double position_of(const spari_record *r, int k) {
    return (k + 1.0) * (double)r->steps / SPARI_SAMPLES;
}

/* Samples after `from` up to `to`, by the cubic through the steps i - 3 .. i. */
static void interpolate(spari_record *r, int64_t i, double from, double to) {
    int64_t n = width(r);
    for (int k = (int)floor(from / (double)r->steps * SPARI_SAMPLES); k < SPARI_SAMPLES && position_of(r, k) <= to;
         k++) {
        double x = position_of(r, k) - (double)(i - 3), *out = r->value + k * n; /* points at 0, 1, 2, 3 */
        const double phi[RECENT] = {-(x - 1) * (x - 2) * (x - 3) / 6, x * (x - 2) * (x - 3) / 2,
                                    -x * (x - 1) * (x - 3) / 2, x * (x - 1) * (x - 2) / 6};
        if (position_of(r, k) <= from) {
            continue;
        }
        memset(out, 0, (size_t)n * sizeof *out);
        for (int l = 0; l < RECENT; l++) {
            const double *point = recent(r, i - 3 + l);
            for (int64_t c = 0; c < n; c++) {
                out[c] += phi[l] * point[c];
            }
        }
    }
}

/* Goals beside the motion; numbers are summed over the ranks. */
static int look_at_goals(const spari_record *r, spar_session *s, double *now) {
    int status = SPAR_OK;
    if (r->goals & SPARI_GOAL(SPARI_OF_REACTION)) {
        double *reaction = now + r->first[SPARI_OF_REACTION];
        for (const spar_member *m = s->members; m; m = m->next, reaction += 6) {
            spari_member_reaction_in(m, r->workspace, reaction);
            for (int c = 3; c < 6; c++) {
                reaction[c] /= spari_member_length(m);
            }
        }
        look_at_joints(s, now + r->first[SPARI_OF_JOINT]);
    }
    if (r->goals & SPARI_GOAL(SPARI_OF_LOAD)) {
        spari_record_loads(s, now + r->first[SPARI_OF_LOAD]);
    }
    if (r->goals & SPARI_GOAL(SPARI_OF_SECTION)) {
        status = look_at_sections(s, now + r->first[SPARI_OF_SECTION]);
        status = spari_agree(s, status);
    }
    if (r->goals & SPARI_GOAL(SPARI_OF_NUMBERS) && status == SPAR_OK) {
        double sum[SPARI_MOST_NUMBERS + 1];
        memcpy(sum, r->numbers, SPARI_MOST_NUMBERS * sizeof *sum);
        status = spari_sum(s, sum, SPARI_MOST_NUMBERS);
        memcpy(now + r->first[SPARI_OF_NUMBERS], sum, SPARI_MOST_NUMBERS * sizeof *sum);
    }
    return status;
}

int spari_record_look(spari_record *r, spar_session *s, int64_t i) {
    double *now = recent(r, i);
    look_at_motion(s, r, now + r->first[SPARI_OF_MOTION], now + r->first[SPARI_OF_BEYOND]);
    SPARI_TRY(look_at_goals(r, s, now));
    r->steps_done = i;
    int64_t bad = spari_first_nonfinite(now, width(r));
    SPARI_REQUIRE(s, bad < 0, SPAR_ERR_NUMERIC,
                  "the trial run has diverged; start with a smaller dt, or iterate the coupling");
    if (i >= 3) {
        double to = i == r->steps ? (double)i : (double)(i - 1);
        interpolate(r, i, i == 3 ? 0 : (double)(i - 2), to);
    }
    return SPAR_OK;
}

/* ---- comparison ---- */

/* Entries of a block that are compared together. */
typedef struct part_of {
    int block;
    int64_t from, to;
} part_of;

static part_of whole_of(const spari_record *r, int block) {
    return (part_of){block, 0, r->first[block + 1] - r->first[block]};
}

/* Squares of a sample's difference in a part of a block, and of its scale. */
static void add_squares(const spari_record *a, const spari_record *b, part_of of_which, int k, double *difference,
                        double *scale) {
    int block = of_which.block;
    int of = block == SPARI_OF_MOTION ? SPARI_OF_BEYOND : block;
    const double *x = a->value + k * width(a) + a->first[block], *y = b->value + k * width(b) + b->first[block],
                 *z = b->value + k * width(b) + b->first[of];
    for (int64_t i = of_which.from; i < of_which.to; i++) {
        *difference += (x[i] - y[i]) * (x[i] - y[i]);
        *scale += z[i] * z[i];
    }
}

/* First sample after the first step of both: before, only the motion exists. */
static int first_sample(const spari_record *a, const spari_record *b, int block) {
    int64_t few = a->steps < b->steps ? a->steps : b->steps;
    return block == SPARI_OF_MOTION || few >= SPARI_SAMPLES ? 0 : (int)((SPARI_SAMPLES + few - 1) / few) - 1;
}

/* |a - b| / |scale|; with zero scale any difference counts as 1. */
static double relative(double difference, double scale) {
    return difference == 0 ? 0 : scale > 0 ? sqrt(difference / scale) : 1;
}

static double distance_of(const spari_record *a, const spari_record *b, part_of which) {
    double difference = 0, scale = 0;
    for (int k = first_sample(a, b, which.block); k < SPARI_SAMPLES; k++) {
        add_squares(a, b, which, k, &difference, &scale);
    }
    return relative(difference, scale);
}

double spari_record_distance(const spari_record *a, const spari_record *b, int block) {
    return distance_of(a, b, whole_of(b, block));
}

double spari_record_load(const spari_record *a, const spari_record *b) {
    double difference = 0, scale = 0;
    for (int i = 0; i < SPARI_LOADS * 6 * b->members; i++) {
        difference += (a->load[i] - b->load[i]) * (a->load[i] - b->load[i]);
        scale += b->load[i] * b->load[i];
    }
    return relative(difference, scale);
}

/* Root mean square of a + b t over 0 .. h. */
static double line_mean(double a, double b, double h) {
    return sqrt(a * a + a * b * h + b * b * h * h / 3);
}

enum { PARTS = 3 }; /* thirds of a run */

/* Growth of e, the root mean squares in the thirds of a run, over `longer` times the run, if it continues with its
   last power of time; relative to that of the motion, w, if the motion stays as at the end. */
static double bent_growth(const double e[PARTS + 1], const double w[PARTS + 1], double longer) {
    const double middle = (PARTS - 0.5) / PARTS, last = fmax(w[PARTS - 1], w[PARTS]);
    double power = fmin(log(e[2] / fmax(e[1], DBL_MIN)) / log(middle / 0.5), most_power),
           error = pow(longer, power) * e[2] / pow(middle, power) / sqrt(2 * power + 1),
           motion = sqrt((w[PARTS] * w[PARTS] + (longer - 1) * last * last) / longer);
    return motion > 0 ? error / e[PARTS] * w[PARTS] / motion : error / e[PARTS];
}

/* Root mean squares of the difference and of its scale, in each third and in total. */
static void sizes_of_parts(const spari_record *a, const spari_record *b, part_of which, double *e, double *w) {
    memset(e, 0, (PARTS + 1) * sizeof *e);
    memset(w, 0, (PARTS + 1) * sizeof *w);
    for (int k = first_sample(a, b, which.block); k < SPARI_SAMPLES; k++) {
        add_squares(a, b, which, k, &e[PARTS * k / SPARI_SAMPLES], &w[PARTS * k / SPARI_SAMPLES]);
    }
    for (int i = 0; i < PARTS; i++) {
        e[PARTS] += e[i], w[PARTS] += w[i];
        e[i] = sqrt(PARTS * e[i] / SPARI_SAMPLES), w[i] = sqrt(PARTS * w[i] / SPARI_SAMPLES);
    }
    e[PARTS] = sqrt(e[PARTS] / SPARI_SAMPLES), w[PARTS] = sqrt(w[PARTS] / SPARI_SAMPLES);
}

/* Growth of the root mean square of the difference over `longer` times the run, extrapolated from the second third
   to the last. (In the first it begins from zero.) For a motion with full periods the error is one of phase and
   grows linearly. For an incomplete one, b shows only a beginning, and the difference continues with its power of
   time. */
static double error_growth(const spari_record *a, const spari_record *b, part_of which, double longer) {
    double e[PARTS + 1], w[PARTS + 1];
    sizes_of_parts(a, b, which, e, w);
    const double middle = (PARTS - 0.5) / PARTS, slope = PARTS * (e[2] - e[1]), level = e[2] - slope * middle,
                 seen = e[PARTS];
    double grown;
    if (seen <= 0) {
        return 1;
    }
    if (e[2] <= by_chance * e[1]) { /* what stays may hide what grows: squares of independent errors add */
        double growing = fmax(e[2] * e[2] - e[1] * e[1], 0) / (middle * middle - 0.25);
        return fmax(sqrt(e[1] * e[1] + growing * (longer * longer / 3 - 0.25)), seen) / seen;
    }
    if (level >= 0) {
        grown = line_mean(level, slope, longer) / seen;
    } else { /* it was zero at all times before */
        grown = spari_record_vouches(b) ? line_mean(0, e[2] / middle, longer) / seen : bent_growth(e, w, longer);
    }
    return fmax(grown, 1);
}

static double error_of_part(const spari_record *a, const spari_record *b, part_of which, double longer) {
    double e = distance_of(a, b, which);
    return longer > 1 ? e * (1 + doubt * (error_growth(a, b, which, longer) - 1)) : e;
}

/* Reactions are of roots and of joints; numbers count individually. */
double spari_record_error(const spari_record *a, const spari_record *b, int goals, double longer) {
    double most = 0;
    for (int block = 0; block <= SPARI_OF_LOAD; block++) {
        if (goals & SPARI_GOAL(block)) {
            most = fmax(most, error_of_part(a, b, whole_of(b, block), longer));
        }
    }
    if (goals & SPARI_GOAL(SPARI_OF_REACTION)) {
        most = fmax(most, error_of_part(a, b, whole_of(b, SPARI_OF_JOINT), longer));
    }
    for (int64_t i = 0; i < SPARI_MOST_NUMBERS && goals & SPARI_GOAL(SPARI_OF_NUMBERS); i++) {
        most = fmax(most, error_of_part(a, b, (part_of){SPARI_OF_NUMBERS, i, i + 1}, longer));
    }
    return most;
}

/* ---- properties of a run ---- */

/* Straight line fitted to x[SPARI_SAMPLES], `stride` apart: its middle and slope. */
static void fit_line(const double *x, int64_t stride, double *middle, double *slope) {
    double sum = 0, moment = 0, squares = 0;
    for (int j = 0; j < SPARI_SAMPLES; j++) {
        double t = j - 0.5 * (SPARI_SAMPLES - 1);
        sum += x[j * stride], moment += t * x[j * stride], squares += t * t;
    }
    *middle = sum / SPARI_SAMPLES;
    *slope = moment / squares;
}

/* Power of the motion relative to the root, minus its fitted line, at the k-th frequency, 2 pi k over the run's
   time, with a Hann window. */
static double power_at(const spari_record *r, int k) {
    double sum = 0, wave[SPARI_SAMPLES];
    int64_t n = r->first[SPARI_OF_BEYOND + 1] - r->first[SPARI_OF_BEYOND];
    for (int j = 0; j < SPARI_SAMPLES; j++) {
        wave[j] = cos(2 * pi * j / SPARI_SAMPLES);
    }
    for (int64_t i = 0; i < n; i++) {
        double c = 0, s = 0, middle, slope;
        const double *x = r->value + r->first[SPARI_OF_BEYOND] + i;
        fit_line(x, width(r), &middle, &slope);
        for (int j = 0; j < SPARI_SAMPLES; j++) {
            double line = middle + slope * (j - 0.5 * (SPARI_SAMPLES - 1)),
                   y = (x[j * width(r)] - line) * (1 - wave[j]);
            c += y * wave[k * j % SPARI_SAMPLES], s += y * wave[(k * j + SPARI_SAMPLES / 4) % SPARI_SAMPLES];
        }
        sum += c * c + s * s;
    }
    return sum;
}

double spari_record_reach(const spari_record *r) {
    double most = 0;
    int64_t n = 3 * r->stations;
    for (int k = 0; k < SPARI_SAMPLES; k++) {
        double sum = 0;
        const double *x = r->value + k * width(r) + r->first[SPARI_OF_BEYOND];
        for (int64_t i = 0; i < n; i++) {
            sum += x[i] * x[i];
        }
        most = fmax(most, sum);
    }
    return n > 0 ? sqrt(most / (double)n) : 0;
}

double spari_record_shortest(const spari_record *r, double part) {
    double total = 0, above = 0;
    for (int64_t i = 0; i < SPARI_SAMPLES; i++) {
        const double *x = r->value + i * width(r) + r->first[SPARI_OF_BEYOND];
        for (int64_t c = 0; c < 3 * r->stations; c++) {
            total += x[c] * x[c];
        }
    }
    /* a sine with sum of squares S/2 gives S/2 in c or s (mean of the window 1): power S^2/4 in its line, 3/8 S^2 in
       total */
    total *= 0.75 * SPARI_SAMPLES;
    for (int k = SPARI_SAMPLES / 2; k >= LEAST_PERIODS; k--) {
        above += power_at(r, k);
        if (above > part * part * total && total > 0) {
            return 1.0 / k;
        }
    }
    return 0;
}

/* For the samples from..to: their mean, the size of the deviation, and the sample that deviates most. */
static double scatter_of(const spari_record *r, int from, double *mean, int *most) {
    int64_t n = 3 * r->stations, at = r->first[SPARI_OF_BEYOND];
    double sum = 0, largest = -1;
    memset(mean, 0, (size_t)n * sizeof *mean);
    for (int k = from; k < SPARI_SAMPLES; k++) {
        for (int64_t i = 0; i < n; i++) {
            mean[i] += r->value[k * width(r) + at + i] / (SPARI_SAMPLES - from);
        }
    }
    for (int k = from; k < SPARI_SAMPLES; k++) {
        double d = 0;
        for (int64_t i = 0; i < n; i++) {
            double x = r->value[k * width(r) + at + i] - mean[i];
            d += x * x;
        }
        sum += d;
        *most = d > largest ? k : *most;
        largest = fmax(largest, d);
    }
    return sqrt(sum / (SPARI_SAMPLES - from));
}

int spari_record_vouches(const spari_record *r) {
    int64_t n = 3 * r->stations, at = r->first[SPARI_OF_BEYOND];
    double *mean = r->recent, size = 0, before = 0; /* the steps are over, so the memory is free */
    int most = 0, crossings = 0;
    for (int k = SPARI_SAMPLES / 2; k < SPARI_SAMPLES; k++) {
        for (int64_t i = 0; i < n; i++) {
            size += pow(r->value[k * width(r) + at + i], 2) / (0.5 * SPARI_SAMPLES);
        }
    }
    if (scatter_of(r, SPARI_SAMPLES / 2, mean, &most) <= settled * sqrt(size)) {
        return 1;
    }
    (void)scatter_of(r, 0, mean, &most);
    for (int k = 0; k < SPARI_SAMPLES; k++) { /* in the direction of the largest excursion */
        double along = 0;
        for (int64_t i = 0; i < n; i++) {
            along += (r->value[k * width(r) + at + i] - mean[i]) * (r->value[most * width(r) + at + i] - mean[i]);
        }
        crossings += along * before < 0;
        before = along != 0 ? along : before;
    }
    return crossings >= 2;
}

double spari_record_swells(const spari_record *r) {
    double e[PARTS + 1], w[PARTS + 1];
    sizes_of_parts(r, r, whole_of(r, SPARI_OF_MOTION), e, w);
    return w[1] > 0 ? w[2] / w[1] : 1;
}
