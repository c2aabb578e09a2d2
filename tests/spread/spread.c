/* Serial tests on several ranks (spread.h). The environment says how.
   SPREAD_DEAL: even; empty, the last rank has no nodes; last, it has them all; each, one to a rank and the rest to the
   last; shuffled. SPREAD_BITS, 1: sums are reproducible. SPREAD_WRITE: a file for what came out, as the test asked for
   it, motion, loads and reactions of members, and what fluids gave for their nodes. SPREAD_AGAINST: such a file,
   written on one process, to compare with: bit by bit where sums are reproducible, else within SPREAD_WITHIN, or the
   tolerance that the test's coupling is iterated to in each step since the last session was made, which is what adds
   up, of the largest number of its kind so far in the test, or of 1. SPREAD_RTOL: couplings are iterated to this at
   least. A test that fails on a rank ends all. */
#define SPREAD_ITSELF
#include "spread.h"

#include <limits.h>
#include <math.h>
#include <mpi.h>
#include <spar/spar_mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is about one process alone. */
static const struct {
    const char *test, *why;
    int plain_sums; /* with these alone */
} skipped[] = {
    {"flexibility", "looks into the solver, which is on one rank", 0},
    {"test_parallelogram", "hears the log of the rank that solves", 0},
    {"map_hangs_together", "the basis is of this rank's nodes", 0},
    {"poses_and_matrices", "so are matrices", 0},
    {"bodies_carry_their_nodes", "so is the audit", 0},
    {"loads_of_fluids_add", "so is the audit", 0},
    {"loads_are_conserved", "so is the audit", 0},
    {"test_capacities", "so is the audit", 0},
    {"life_of_weights", "so are the weights that a fluid gives", 0},
    {"trials_keep_weights", "so are the weights that a fluid gives", 0},
    {"fades_smoothly", "so are the distances by which motion fades", 0},
    {"fades_from_the_line", "so are the distances by which motion fades", 0},
    {"fade_moves_as_its_rate", "so are the distances by which motion fades", 0},
    {"bent_cantilever_keeps_its_mesh", "so are the distances by which motion fades", 0},
    {"far_nodes_do_not_rotate", "so are the distances by which motion fades", 0},
    {"single_precision_at_the_edge", "messages name this rank's nodes", 0},
    {"far_nodes_are_flagged_or_refused", "messages name this rank's nodes", 0},
    {"bad_calls_are_refused", "messages name this rank's nodes", 0},
    {"bad_weights_are_refused", "messages name this rank's nodes", 0},
    {"bad_sections_are_refused", "messages name this rank's nodes", 0},
    {"test_advice", "applies advice, which goes by costs, and these are of the ranks: other nodes", 0},
    {"test_advice_of_fidelity", "so does this: other modes", 0},
    {"test_apply_in_a_run", "so does this: other steps", 0},
    {"test_advice_is_kept", "so does this", 0},
    {"test_advice_stays_stable", "so does this", 0},
    {"trials", "so does this: other steps", 1},
    {"control_points_of_their_own", "so are the sections of the blade element fluid", 0},
    {"explicit_beam", "its run without a guess diverges, and rounding with it", 1},
    {"explicit_after", "its run without added mass diverges, and rounding with it", 1},
    {"test_pressure", "its slab twists out of its plane, and rounding grows with it", 1},
};

/* What numbers are, and up to six arrays of a call that pulls. */
enum { PLACES, RATES, ACCELERATIONS, LOADS, REACTION, TRIALS, PULLED, KINDS = PULLED + 6 };

static const char *const kind_name[PULLED] = {"places", "velocities", "accelerations", "loads", "reactions", "trials"};

enum { EVEN, EMPTY, LAST, EACH, SHUFFLED, DEALS };
static const char *const deal_name[DEALS] = {"even", "empty", "last", "each", "shuffled"};

static int rank, size = 1, deal, bits;
static int iterating; /* in a call that calls the fluid: what it pulls and asks for then is not yet what comes out */
static int advising;  /* which trials are run goes by costs, and these are of the ranks */

/* ---- who has which nodes ---- */

typedef struct kept {
    const spar_fluid *fluid;
    int64_t n[2];
    int serial; /* fluids of one node: not all on one rank */
} kept;

static kept *all_kept;
static int kept_count;

static void *room(int64_t n, size_t width) {
    void *x = calloc(n > 0 ? (size_t)n : 1, width);
    if (!x) {
        MPI_Abort(MPI_COMM_WORLD, 2);
    }
    return x;
}

static kept *find(const spar_fluid *fluid) {
    int k = 0;
    while (k < kept_count && all_kept[k].fluid != fluid) {
        k++;
    }
    if (k == kept_count) {
        kept *more = realloc(all_kept, (size_t)(kept_count + 1) * sizeof *more);
        if (!more) {
            MPI_Abort(MPI_COMM_WORLD, 2);
            abort();
        }
        all_kept = more;
        all_kept[kept_count++] = (kept){.fluid = fluid};
    }
    return all_kept + k;
}

static int owner_of(const kept *f, int64_t n, int64_t i) {
    int64_t at = n == 1 ? f->serial : i;
    switch (deal) {
    case EVEN:
        return (int)(at % size);
    case EMPTY:
        return size > 1 ? (int)(at % (size - 1)) : 0;
    case LAST:
        return size - 1;
    case EACH:
        return i < size ? (int)i : size - 1;
    default:
        return (int)(((unsigned)at * 2654435761u >> 8) % (unsigned)size);
    }
}

/* This rank's nodes of a set, by their numbers, in the order in which it gives them. Returns how many; to free. */
static int64_t own_nodes(const kept *f, int which, int64_t **number) {
    int64_t n = f->n[which], step = deal == SHUFFLED ? 7919 : 1, count = 0;
    *number = room(n, sizeof **number);
    for (int64_t k = 0; k < n; k++) {
        int64_t i = n % step == 0 && step > 1 ? n - 1 - k : k * step % n;
        if (owner_of(f, n, i) == rank) {
            (*number)[count++] = i;
        }
    }
    return count;
}

/* The worst of all ranks. */
static int agree(int status) {
    MPI_Allreduce(MPI_IN_PLACE, &status, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    return status;
}

static void note(int kind, const double *x, int64_t n);

/* ---- arrays: of all nodes, as the test has them, and of this rank's ---- */

typedef struct cut {
    int64_t n, *number;
    int64_t whole;
} cut;

static cut cut_of(const spar_fluid *fluid, int which) {
    const kept *f = find(fluid);
    cut c = {.whole = f->n[which]};
    c.n = own_nodes(f, which, &c.number);
    return c;
}

/* NULL stays NULL where there are nodes. */
static double *part_of(const cut *c, int width, const double *x) {
    double *part = x ? room(c->n * width, sizeof *part) : NULL;
    for (int64_t i = 0; i < c->n && x; i++) {
        memcpy(part + width * i, x + width * c->number[i], (size_t)width * sizeof *x);
    }
    return part;
}

static double *place_for(const cut *c, int width, const double *x) {
    return x ? room(c->n * width, sizeof(double)) : NULL;
}

/* What each rank has got, to the test; the parts are freed. */
static int put_together(cut *c, int status, int count, double *const *part, const int *width, double *const *x) {
    status = agree(status);
    for (int k = 0; k < count; k++) {
        if (x[k] && status == SPAR_OK) {
            int64_t n = c->whole * width[k];
            uint64_t *word = room(n, sizeof *word);
            for (int64_t i = 0; i < c->n; i++) {
                memcpy(word + width[k] * c->number[i], part[k] + width[k] * i, (size_t)width[k] * sizeof *word);
            }
            MPI_Allreduce(MPI_IN_PLACE, word, (int)n, MPI_UINT64_T, MPI_BOR, MPI_COMM_WORLD);
            memcpy(x[k], word, (size_t)n * sizeof *word);
            free(word);
            note(PULLED + k, x[k], n);
        }
        free(part[k]);
    }
    free(c->number);
    return status;
}

/* ---- what came out ---- */

static FILE *written, *against;
static const char *current = "";
static uint64_t digest = 14695981039346656037u;
static int64_t numbers, others;
static double farthest, within, most_of[KINDS];
static double iterated_to; /* the loosest tolerance of the test's couplings */
static int64_t accepted;   /* steps since the last session was made */
static const char *farthest_in = "";
static int farthest_kind;

static void differ(const char *why) {
    fprintf(stderr, "rank %d of %d, %s: %s: %s\n", rank, size, deal_name[deal], current, why);
    MPI_Abort(MPI_COMM_WORLD, 1);
}

static void compare(int kind, const double *x, int64_t n) {
    int64_t had = 0;
    double *y = room(n, sizeof *y), apart = 0;
    if (fread(&had, sizeof had, 1, against) != 1 || had != n || fread(y, sizeof *y, (size_t)n, against) != (size_t)n) {
        differ("not the numbers that one process asks for");
    }
    for (int64_t i = 0; i < n; i++) {
        most_of[kind] = fmax(most_of[kind], fabs(y[i]));
        apart = fmax(apart, fabs(x[i] - y[i]));
        others += memcmp(x + i, y + i, sizeof *x) != 0;
    }
    double size_of = fmax(1, most_of[kind]); /* what is nothing but rounding is not compared with itself */
    if (apart / size_of > farthest) {
        farthest = apart / size_of;
        farthest_in = current;
        farthest_kind = kind;
    }
    if (bits ? others > 0 : !(apart <= fmax(within, iterated_to * (double)(accepted > 1 ? accepted : 1)) * size_of)) {
        char text[160];
        snprintf(text, sizeof text, "%.3g of %.3g apart, on one process; %s, after %lld numbers", apart, size_of,
                 kind < PULLED ? kind_name[kind] : "what is pulled", (long long)numbers);
        differ(text);
    }
    free(y);
}

static void note(int kind, const double *x, int64_t n) {
    if (!x || advising || (iterating && !bits)) {
        return;
    }
    for (int64_t i = 0; i < n; i++) {
        uint64_t word;
        memcpy(&word, x + i, sizeof word);
        digest = (digest ^ word) * 1099511628211u;
        digest ^= digest >> 29;
    }
    numbers += n;
    if (written && (fwrite(&n, sizeof n, 1, written) != 1 || fwrite(x, sizeof *x, (size_t)n, written) != (size_t)n)) {
        differ("cannot write");
    }
    if (against) {
        compare(kind, x, n);
    }
}

/* ---- the run ---- */

static void begin(void) {
    const char *text = getenv("SPREAD_DEAL"), *path;
    MPI_Init(NULL, NULL);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    while (text && deal < DEALS - 1 && strcmp(text, deal_name[deal]) != 0) {
        deal++;
    }
    text = getenv("SPREAD_BITS");
    bits = text && text[0] == '1';
    text = getenv("SPREAD_WITHIN");
    within = text ? strtod(text, NULL) : 0;
    path = getenv("SPREAD_WRITE");
    written = path && rank == 0 ? fopen(path, "wb") : NULL;
    path = getenv("SPREAD_AGAINST");
    against = path && rank == 0 ? fopen(path, "rb") : NULL;
    if (path && rank == 0 && !against) {
        differ("no file to compare with");
    }
}

static void end(void) {
    uint64_t first = digest;
    MPI_Bcast(&first, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    if (first != digest) {
        differ("another result than on rank 0");
    }
    if (against && fgetc(against) != EOF) {
        differ("one process asks for more numbers");
    }
    if (written && fclose(written) != 0) {
        differ("cannot write");
    }
    if (rank == 0) {
        printf("%d ranks, %s%s: %lld numbers, digest %016llx", size, deal_name[deal], bits ? ", reproducible" : "",
               (long long)numbers, (unsigned long long)digest);
        if (against) {
            printf(", %lld other than on one process, at most by %.2g of the largest", (long long)others, farthest);
        }
        printf(farthest > 0 ? " (%s, %s)\n" : "\n", farthest_in,
               farthest_kind < PULLED ? kind_name[farthest_kind] : "what is pulled");
    }
    if (against) {
        fclose(against);
    }
    free(all_kept);
    MPI_Finalize();
}

int spread_run(const struct CMUnitTest *tests, size_t count, CMFixtureFunction setup, CMFixtureFunction teardown) {
    begin();
    for (size_t k = 0; k < count; k++) {
        int skip = 0;
        for (size_t j = 0; j < sizeof skipped / sizeof *skipped; j++) {
            skip |= strcmp(skipped[j].test, tests[k].name) == 0 && (!skipped[j].plain_sums || !bits);
        }
        current = tests[k].name;
        memset(most_of, 0, sizeof most_of);
        iterated_to = 0;
        if (!skip && _cmocka_run_group_tests(current, tests + k, 1, setup, teardown) != 0) {
            differ("failed");
        }
    }
    end();
    return 0;
}

/* ---- in the place of spar's ---- */

int spread_session_create(spar_session **session) {
    accepted = 0;
    int status = size > 1 ? spar_session_create_mpi(MPI_COMM_WORLD, session) : spar_session_create(session);
    return status == SPAR_OK && bits ? spar_session_set_reproducible(*session, 1) : status;
}

int spread_create(spar_member *member, const char *name, spar_fluid **fluid) {
    static int serial;
    int status = spar_fluid_create(member, name, fluid);
    if (status == SPAR_OK) {
        kept *f = find(*fluid);
        f->n[0] = f->n[1] = 0;
        f->serial = serial++;
    }
    return status;
}

/* which: SPAR_NODES_*, or both (2). Refused, it has the nodes that it had. */
static int set_nodes(spar_fluid *fluid, int which, int64_t n, const double *x, int width, const double *more,
                     int (*set)(spar_fluid *, int64_t, const double *, const double *)) {
    if (!fluid || n < 0 || (n > 0 && !x)) {
        return set(fluid, n, x, more);
    }
    kept *f = find(fluid), was = *f;
    for (int k = 0; k < 2; k++) {
        f->n[k] = which == k || which == 2 ? n : f->n[k];
    }
    cut c = cut_of(fluid, which == 2 ? SPAR_NODES_MOTION : which);
    double *part[2] = {part_of(&c, width, x), part_of(&c, 3, more)};
    int status = agree(set(fluid, c.n, part[0], part[1]));
    if (status != SPAR_OK) {
        *find(fluid) = was;
    }
    free(part[0]);
    free(part[1]);
    free(c.number);
    return status;
}

static int set_motion(spar_fluid *fluid, int64_t n, const double *x, const double *none) {
    (void)none;
    return spar_fluid_set_motion_nodes(fluid, n, x);
}

static int set_force(spar_fluid *fluid, int64_t n, const double *x, const double *none) {
    (void)none;
    return spar_fluid_set_force_nodes(fluid, n, x);
}

int spread_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    return set_nodes(fluid, SPAR_NODES_MOTION, n, x, 3, NULL, set_motion);
}

int spread_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    return set_nodes(fluid, SPAR_NODES_FORCE, n, x, 3, NULL, set_force);
}

int spread_set_sections(spar_fluid *fluid, int64_t n, const double *eta, const double *offset) {
    return set_nodes(fluid, 2, n, eta, 1, offset, spar_fluid_set_stations);
}

int spread_set_motion_sections(spar_fluid *fluid, int64_t n, const double *eta, const double *offset) {
    return set_nodes(fluid, SPAR_NODES_MOTION, n, eta, 1, offset, spar_fluid_set_motion_stations);
}

int spread_set_motion_weights(spar_fluid *fluid, int64_t n, const double *w) {
    const kept *f = find(fluid);
    if (n != f->n[SPAR_NODES_MOTION] || !w) {
        return spar_fluid_set_motion_weights(fluid, n, w);
    }
    cut c = cut_of(fluid, SPAR_NODES_MOTION);
    double *part = part_of(&c, 1, w);
    int status = agree(spar_fluid_set_motion_weights(fluid, c.n, part));
    free(part);
    free(c.number);
    return status;
}

int spread_get_count(const spar_fluid *fluid, int which, int64_t *n) {
    int status = agree(spar_fluid_get_count(fluid, which, n));
    if (status == SPAR_OK) {
        MPI_Allreduce(MPI_IN_PLACE, n, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    }
    return status;
}

int spread_get_flag_count(const spar_fluid *fluid, int which, int flag, int64_t *n) {
    int status = agree(spar_fluid_get_flag_count(fluid, which, flag, n));
    if (status == SPAR_OK) {
        MPI_Allreduce(MPI_IN_PLACE, n, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    }
    return status;
}

int spread_get_map(const spar_fluid *fluid, int which, double *eta, double *distance, int *flags) {
    cut c = cut_of(fluid, which);
    int *own = room(c.n, sizeof *own);
    double *as = room(c.n, sizeof *as), *seen = flags ? room(c.whole, sizeof *seen) : NULL;
    double *part[3] = {place_for(&c, 1, eta), place_for(&c, 1, distance), as};
    int64_t whole = c.whole;
    int status = spar_fluid_get_map(fluid, which, part[0], part[1], own);
    for (int64_t i = 0; i < c.n; i++) {
        as[i] = own[i];
    }
    status = put_together(&c, status, 3, part, (int[]){1, 1, 1}, (double *[]){eta, distance, seen});
    for (int64_t i = 0; i < whole && flags && status == SPAR_OK; i++) {
        flags[i] = (int)seen[i];
    }
    free(own);
    free(seen);
    return status;
}

int spread_get_nearest(const spar_fluid *fluid, int which, double *x_map, double *q_map, double *con) {
    cut c = cut_of(fluid, which);
    double *part[3] = {place_for(&c, 3, x_map), place_for(&c, 4, q_map), place_for(&c, 3, con)};
    int status = spar_fluid_get_nearest(fluid, which, part[0], part[1], part[2]);
    return put_together(&c, status, 3, part, (int[]){3, 4, 3}, (double *[]){x_map, q_map, con});
}

int spread_get_positions(const spar_fluid *fluid, int which, double *x, double *q, double *v, double *nearest) {
    cut c = cut_of(fluid, which);
    double *part[4] = {place_for(&c, 3, x), place_for(&c, 4, q), place_for(&c, 3, v), place_for(&c, 3, nearest)};
    int status = spar_fluid_get_positions(fluid, which, part[0], part[1], part[2], part[3]);
    return put_together(&c, status, 4, part, (int[]){3, 4, 3, 3}, (double *[]){x, q, v, nearest});
}

int spread_pull_motion(spar_fluid *fluid, double theta, double *x, double *v) {
    cut c = cut_of(fluid, SPAR_NODES_MOTION);
    double *part[2] = {place_for(&c, 3, x), place_for(&c, 3, v)};
    int status = spar_fluid_pull_motion(fluid, theta, part[0], part[1]);
    return put_together(&c, status, 2, part, (int[]){3, 3}, (double *[]){x, v});
}

static const int pose_width[6] = {3, 4, 3, 3, 3, 3};

int spread_pull_poses(spar_fluid *fluid, int which, double theta, double *x, double *q, double *v, double *omega,
                      double *accel, double *alpha) {
    cut c = cut_of(fluid, which);
    double *to[6] = {x, q, v, omega, accel, alpha}, *part[6];
    for (int k = 0; k < 6; k++) {
        part[k] = place_for(&c, pose_width[k], to[k]);
    }
    int status = spar_fluid_pull_poses(fluid, which, theta, part[0], part[1], part[2], part[3], part[4], part[5]);
    return put_together(&c, status, 6, part, pose_width, to);
}

int spread_pull_forces(spar_fluid *fluid, double theta, double *force) {
    cut c = cut_of(fluid, SPAR_NODES_FORCE);
    double *part[1] = {place_for(&c, 3, force)};
    int status = spar_fluid_pull_forces(fluid, theta, part[0]);
    return put_together(&c, status, 1, part, (int[]){3}, &force);
}

int spread_get_forces(const spar_fluid *fluid, double *force) {
    cut c = cut_of(fluid, SPAR_NODES_FORCE);
    double *part[1] = {place_for(&c, 3, force)};
    int status = spar_fluid_get_forces(fluid, part[0]);
    return put_together(&c, status, 1, part, (int[]){3}, &force);
}

/* Single precision goes through double, which has all of its numbers. */
static double *wide_of(const float *x, int64_t n) {
    double *wide = x ? room(n, sizeof *wide) : NULL;
    for (int64_t i = 0; i < n && x; i++) {
        wide[i] = (double)x[i];
    }
    return wide;
}

static void narrow_to(float *x, const double *wide, int64_t n) {
    for (int64_t i = 0; i < n && x; i++) {
        x[i] = (float)wide[i];
    }
}

/* Up to six arrays of single precision that `pull` fills for this rank's nodes of a set. */
static int pull_single(spar_fluid *fluid, int which, double theta, int count, const int *width, float *const *x,
                       int (*pull)(spar_fluid *, int, double, float *const *)) {
    cut c = cut_of(fluid, which);
    float *own[6] = {NULL};
    double *part[6] = {NULL}, *whole[6] = {NULL};
    int64_t n = c.n, all = c.whole;
    for (int k = 0; k < count; k++) {
        own[k] = x[k] ? room(n * width[k], sizeof *own[k]) : NULL;
        whole[k] = x[k] ? room(all * width[k], sizeof *whole[k]) : NULL;
    }
    int status = pull(fluid, which, theta, own);
    for (int k = 0; k < count; k++) {
        part[k] = wide_of(own[k], n * width[k]);
    }
    status = put_together(&c, status, count, part, width, whole);
    for (int k = 0; k < count; k++) {
        narrow_to(status == SPAR_OK ? x[k] : NULL, whole[k], all * width[k]);
        free(own[k]);
        free(whole[k]);
    }
    return status;
}

static int pull_own_motion(spar_fluid *fluid, int which, double theta, float *const *x) {
    (void)which;
    return spar_fluid_pull_motion_f32(fluid, theta, x[0], x[1]);
}

static int pull_own_poses(spar_fluid *fluid, int which, double theta, float *const *x) {
    return spar_fluid_pull_poses_f32(fluid, which, theta, x[0], x[1], x[2], x[3], x[4], x[5]);
}

static int pull_own_forces(spar_fluid *fluid, int which, double theta, float *const *x) {
    (void)which;
    return spar_fluid_pull_forces_f32(fluid, theta, x[0]);
}

int spread_pull_motion_f32(spar_fluid *fluid, double theta, float *x, float *v) {
    return pull_single(fluid, SPAR_NODES_MOTION, theta, 2, (int[]){3, 3}, (float *[]){x, v}, pull_own_motion);
}

int spread_pull_poses_f32(spar_fluid *fluid, int which, double theta, float *x, float *q, float *v, float *omega,
                          float *accel, float *alpha) {
    return pull_single(fluid, which, theta, 6, pose_width, (float *[]){x, q, v, omega, accel, alpha}, pull_own_poses);
}

int spread_pull_forces_f32(spar_fluid *fluid, double theta, float *force) {
    return pull_single(fluid, SPAR_NODES_FORCE, theta, 1, (int[]){3}, &force, pull_own_forces);
}

int spread_push_forces_f32(spar_fluid *fluid, const float *force, const float *moment) {
    cut c = cut_of(fluid, SPAR_NODES_FORCE);
    const float *from[2] = {force, moment};
    float *own[2] = {NULL};
    for (int k = 0; k < 2; k++) {
        double *wide = wide_of(from[k], 3 * c.whole), *part = part_of(&c, 3, wide);
        own[k] = part ? room(3 * c.n, sizeof *own[k]) : NULL;
        narrow_to(own[k], part, 3 * c.n);
        free(wide);
        free(part);
    }
    int status = agree(spar_fluid_push_forces_f32(fluid, own[0], own[1]));
    free(own[0]);
    free(own[1]);
    free(c.number);
    return status;
}

/* The farthest of all ranks, the first of equals. */
int spread_get_travel(spar_fluid *fluid, double *largest, int64_t *node) {
    cut c = cut_of(fluid, SPAR_NODES_MOTION);
    double way = 0, most;
    int64_t at = -1, first;
    int status = agree(spar_fluid_get_travel(fluid, &way, &at));
    MPI_Allreduce(&way, &most, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    first = at >= 0 && at < c.n && way == most ? c.number[at] : INT64_MAX;
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT64_T, MPI_MIN, MPI_COMM_WORLD);
    if (status == SPAR_OK && largest) {
        *largest = most;
    }
    if (status == SPAR_OK && node) {
        *node = first == INT64_MAX ? -1 : first;
    }
    free(c.number);
    return status;
}

int spread_push_forces(spar_fluid *fluid, const double *force, const double *moment) {
    cut c = cut_of(fluid, SPAR_NODES_FORCE);
    double *part[2] = {part_of(&c, 3, force), part_of(&c, 3, moment)};
    int status = spar_fluid_push_forces(fluid, part[0], part[1]);
    return put_together(&c, status, 2, part, (int[]){3, 3}, (double *[]){NULL, NULL});
}

int spread_push_forces_at(spar_fluid *fluid, double theta, const double *force, const double *moment) {
    cut c = cut_of(fluid, SPAR_NODES_FORCE);
    double *part[2] = {part_of(&c, 3, force), part_of(&c, 3, moment)};
    int status = spar_fluid_push_forces_at(fluid, theta, part[0], part[1]);
    return put_together(&c, status, 2, part, (int[]){3, 3}, (double *[]){NULL, NULL});
}

/* A failure on one rank is SPAR_ERR_PEER on the others: the test is told what it was. */
static int verdict(int status) {
    int least = status == SPAR_OK || status == SPAR_ERR_PEER ? INT_MAX : status;
    MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if ((status == SPAR_OK) != (agree(status) == SPAR_OK)) {
        differ("failed on some ranks only");
    }
    return status == SPAR_OK || least == INT_MAX ? status : least;
}

int spread_commit(spar_member *member) {
    return verdict(spar_member_commit(member));
}

int spread_member_solve_static(spar_member *member, int load_steps) {
    return verdict(spar_member_solve_static(member, load_steps));
}

int spread_solve_static(spar_session *session, int load_steps, spar_fluid_solver solve, void *context,
                        int *iterations) {
    iterating++;
    int status = verdict(spar_session_solve_static(session, load_steps, solve, context, iterations));
    iterating--;
    return status;
}

int spread_start(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations) {
    iterating++;
    int status = verdict(spar_session_solve_initial(session, dt, solve, context, iterations));
    iterating--;
    return status;
}

int spread_step(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations) {
    iterating++;
    int status = verdict(spar_step(session, dt, solve, context, iterations));
    iterating--;
    accepted += status == SPAR_OK;
    return status;
}

int spread_step_begin(spar_session *session, double dt) {
    return verdict(spar_step_begin(session, dt));
}

int spread_step_solve(spar_session *session) {
    return verdict(spar_step_solve(session));
}

int spread_step_check(spar_session *session, int *done) {
    return verdict(spar_step_check(session, done));
}

int spread_step_accept(spar_session *session) {
    accepted++;
    return verdict(spar_step_accept(session));
}

int spread_get_motion(const spar_member *member, double *q, double *v, double *a) {
    int64_t n = 0;
    int status = spar_member_get_motion(member, q, v, a);
    if (status == SPAR_OK && spar_member_get_count(member, &n) == SPAR_OK) {
        note(PLACES, q, 7 * n);
        note(RATES, v, 6 * n);
        note(ACCELERATIONS, a, 6 * n);
    }
    return status;
}

int spread_get_loads(const spar_member *member, double *load) {
    int64_t n = 0;
    int status = spar_member_get_loads(member, load);
    if (status == SPAR_OK && spar_member_get_count(member, &n) == SPAR_OK) {
        note(LOADS, load, 6 * n);
    }
    return status;
}

int spread_get_reaction(const spar_member *member, double *load) {
    int status = spar_member_get_reaction(member, load);
    note(REACTION, status == SPAR_OK ? load : NULL, 6);
    return status;
}

/* Errors of trials, but not times; only where they are reproducible: small differences of runs that go apart. */
int spread_trial_run(spar_trial *trial, int compare) {
    double error[3];
    iterating++;
    int status = verdict(spar_trial_run(trial, compare));
    iterating--;
    if (status == SPAR_OK && bits) {
        (void)spar_trial_get_errors(trial, error, error + 1, error + 2);
        note(TRIALS, error, 3);
    }
    return status;
}

int spread_trial_report_effects(spar_trial *trial) {
    iterating++;
    int status = verdict(spar_trial_report_effects(trial));
    iterating--;
    for (int r = 0; r < SPAR_ROW_COUNT && status == SPAR_OK && bits; r++) {
        int in_force, fails;
        double x[5];
        (void)spar_trial_get_effect(trial, r, &in_force, &fails, x + 2, x + 3, x + 4, NULL);
        x[0] = in_force, x[1] = fails;
        note(TRIALS, x, 5);
    }
    return status;
}

int spread_trial_advise(spar_trial *trial, double tolerance, double length) {
    advising++;
    int status = verdict(spar_trial_advise(trial, tolerance, length));
    advising--;
    return status;
}

int spread_trial_apply(spar_trial *trial, double *dt) {
    return verdict(spar_trial_apply(trial, dt));
}

/* What is iterated to a tolerance is known to that tolerance; with a tighter one it comes closer. */
int spread_set_coupling(spar_session *session, int scheme, double atol, double rtol, int max_iterations) {
    const char *text = getenv("SPREAD_RTOL");
    rtol = text ? fmin(rtol, strtod(text, NULL)) : rtol;
    iterated_to = scheme == SPAR_COUPLING_EXPLICIT ? iterated_to : fmax(iterated_to, rtol);
    return spar_session_set_coupling(session, scheme, atol, rtol, max_iterations);
}

/* All ranks have read it; one removes it. */
int spread_remove(const char *path) {
    int failed = 0;
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        failed = remove(path);
    }
    MPI_Bcast(&failed, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return failed;
}
