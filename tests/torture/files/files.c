/* Files: saved sessions cut off at every byte, with every bit turned, with a right checksum over absurd contents, of
   another session, without room at every size, killed while they are written, written by two at a time; pictures and
   their index likewise. What is refused says why and leaves the session as it was, to the bit; what is loaded harms
   nothing, and the good file still brings back the good run.

       files [seconds] [seed]

   The short form shares the seconds out; without them every part does all it has (and 100000 absurd files). */
#include "scene.h"

#include <errno.h>
#include <signal.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { LIMIT = 20, MEMBERS = 8, MOST_NODES = 6, STATE = MEMBERS * MOST_NODES * 25 + 2, FAILURES = 10, HEAD = 24 };

static const double dt = 0.02;
static char home[64], name[256];
static int failures;
static long cases;
static uint64_t dice = 1;

/* ---- scenes ---- */

typedef struct scene {
    spar_session *session;
    spar_member *member[MEMBERS];
    int members;
    spar_member *asked; /* whose effects are set; all others have the default, and node forces */
    spar_fluid *fluid[2];
    int fluids;
} scene;

static void must(int status, const char *what, const spar_session *s) {
    if (status != SPAR_OK) {
        fprintf(stderr, "files: %s: %s: %d: %s\n", name, what, status, spar_session_message(s));
        exit(2);
    }
}
#define MUST(s, call) must(call, #call, s)

static spar_member *add(scene *c, spar_member *m) {
    return c->member[c->members++] = m;
}

static void body(scene *c, double weight) {
    static const double q[4] = {1, 0, 0, 0}, x[3] = {0, 5, 0}, centre[3] = {0.1, 0, 0}, J[3] = {1, 2, 3};
    double mass[36];
    spar_member *m = NULL;
    scene_mass(mass, weight, centre, J);
    MUST(c->session, spar_rigid_create(c->session, "body", x, q, mass, &m));
    (void)add(c, m);
}

static spar_member *beam(scene *c, const char *title, int elements, int nodes) {
    double K[36], M[36];
    scene_box(K, M);
    return add(c, scene_beam(c->session, title, elements, nodes, 10, K, M));
}

static void add_fluid(scene *c, spar_member *m, const double *x) {
    spar_fluid *f = NULL;
    MUST(c->session, spar_fluid_create(m, "fluid", &f));
    MUST(c->session, spar_fluid_set_motion_nodes(f, 1, x));
    MUST(c->session, spar_fluid_set_force_nodes(f, 1, x));
    MUST(c->session, spar_fluid_map(f));
    c->fluid[c->fluids++] = f;
}

static void commit(scene *c) {
    for (int k = 0; k < c->members; k++) {
        if (c->asked != c->member[k]) {
            MUST(c->session, spar_member_set_effects(c->member[k], SPAR_EFFECT_FLUID_HISTORY, 0));
        }
        MUST(c->session, spar_member_commit(c->member[k]));
    }
}

/* One body. variant: 0; else another session's, of another mass, number of members or fluids. */
static void create_small(scene *c, int variant) {
    static const double x[3] = {0, 5, 0};
    *c = (scene){.session = scene_session()};
    body(c, variant == 1 ? 4 : 3);
    if (variant == 2) {
        (void)beam(c, "more", 1, 2);
    }
    commit(c);
    if (variant != 3) {
        add_fluid(c, c->member[0], x);
    }
}

/* Joints of each kind: a hinge on a spring, an actuator at rest, a rope, a spring between what moves as it is told. */
static void tie(scene *c) {
    static const double tip[3] = {10, 0, 0}, x[3] = {0, 5, 0}, up[3] = {0, 0, 5}, load[6] = {0, 0, 0, 0, 0.1, 0};
    double soft[36] = {0};
    spar_session *s = c->session;
    spar_joint *hinge, *actuator, *rope, *tether;
    for (int i = 0; i < 36; i += 7) {
        soft[i] = 3;
    }
    MUST(s, spar_joint_create(s, "tether", c->member[7], 0, NULL, 0, 63, &tether));
    MUST(s, spar_joint_set_spring(tether, soft, NULL, NULL));
    for (int i = 0; i < 36; i++) {
        soft[i] = i == 28 ? 3 : 0;
    }
    MUST(s, spar_joint_create(s, "hinge", c->member[6], 0, c->member[1], 5, SPAR_FREE_RY, &hinge));
    MUST(s, spar_joint_set_frame(hinge, tip, NULL));
    MUST(s, spar_joint_set_spring(hinge, soft, NULL, NULL));
    MUST(s, spar_joint_set_load(hinge, load));
    MUST(s, spar_link_create(s, "rope", c->member[6], 0, x, NULL, 0, up, &rope));
    MUST(s, spar_link_set_spring(rope, 5, 0.1, 7, 1));
    MUST(s, spar_link_create(s, "actuator", c->member[4], 0, tip, NULL, 0, up, &actuator));
    MUST(s, spar_joint_set_driven(actuator, SPAR_FREE_X));
}

/* One of each kind, with all that a member can have in a file. */
static void create_large(scene *c) {
    static const double x[3] = {0, 5, 0}, tip[3] = {10, 0, 0}, mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3},
                        load[6] = {0, 0.1, 0, 0, 0, 0.01}, eta[2] = {0.2, 0.9}, g[3] = {0, 0, -2},
                        lines[12] = {0, 0.1, 0, 0, 0, 0, 0, 0.2, 0, 0, 0, 0};
    *c = (scene){.session = scene_session()};
    spar_session *s = c->session;
    spar_member *m = NULL;
    MUST(s, spar_session_set_gravity(s, g));
    MUST(s, spar_session_set_predictor(s, 2));
    MUST(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-8, 60));
    MUST(s, spar_session_set_option(s, "coupling.columns", "4"));
    MUST(s, spar_session_set_option(s, "coupling.motion_rtol", "1e-3"));
    (void)beam(c, "dense", 1, 3);
    MUST(s, spar_beam_set_damping(beam(c, "banded", 2, 3), mu));
    m = beam(c, "linear", 1, 3);
    MUST(s, spar_member_set_fidelity(m, SPAR_FIDELITY_LINEAR, 0));
    MUST(s, spar_member_set_root(m, SPAR_ROOT_DRIVEN));
    MUST(s, spar_member_set_fidelity(beam(c, "modal", 1, 3), SPAR_FIDELITY_MODAL, 4));
    m = beam(c, "rigid", 1, 3);
    MUST(s, spar_member_set_fidelity(m, SPAR_FIDELITY_RIGID, 0));
    MUST(s, spar_member_set_root(m, SPAR_ROOT_FREE));
    c->asked = beam(c, "small", 1, 3);
    MUST(s, spar_member_set_fidelity(c->asked, SPAR_FIDELITY_LINEAR, 0));
    MUST(s, spar_member_set_effects(c->asked, SPAR_EFFECT_FLUID_HISTORY, SPAR_EFFECT_GYROSCOPIC));
    body(c, 3);
    MUST(s, spar_point_create(s, "point", x, NULL, &m));
    (void)add(c, m);
    commit(c);
    tie(c);
    MUST(s, spar_beam_set_line_load(c->member[0], SPAR_LOAD_FOLLOWER, 2, eta, lines));
    MUST(s, spar_beam_set_line_load(c->member[1], SPAR_LOAD_DEAD, 2, eta, lines));
    MUST(s, spar_member_set_load(c->member[1], 4, SPAR_LOAD_FOLLOWER, load));
    MUST(s, spar_member_set_load(c->member[3], 2, SPAR_LOAD_DEAD, load));
    add_fluid(c, c->member[1], tip);
    add_fluid(c, c->member[6], x);
}

static int solve(spar_session *s, double t, double step, int iteration, void *context) {
    scene *c = context;
    (void)iteration;
    for (int k = 0; k < c->fluids; k++) {
        double v[3] = {0}, force[3], old[3] = {0};
        int status = spar_fluid_pull_motion(c->fluid[k], 1, NULL, v);
        status = status ? status : spar_fluid_pull_forces(c->fluid[k], 0, old);
        for (int i = 0; i < 3; i++) {
            force[i] = 0.1 * old[i] - 0.5 * v[i] + (i == 1 ? sin(3 * (t + step)) : 0);
        }
        status = status ? status : spar_fluid_push_forces(c->fluid[k], force, NULL);
        if (status != SPAR_OK) {
            return status;
        }
    }
    (void)s;
    return 0;
}

static int step(scene *c) {
    if (c->members > 2) {
        double t = 0, q[7] = {0, 0, 0, 1, 0, 0, 0}, v[6] = {0};
        (void)spar_session_get_time(c->session, &t, NULL, NULL);
        q[3] = cos(0.05 * (t + dt)), q[6] = sin(0.05 * (t + dt));
        v[5] = 0.1;
        (void)spar_member_drive(c->member[2], q, v, NULL);
    }
    return spar_step(c->session, dt, solve, c, NULL);
}

/* Into a step, as far as a solution and the loads that follow it. */
static void half_a_step(scene *c) {
    int done = 0;
    MUST(c->session, spar_step_begin(c->session, dt));
    for (int k = 0; k < 2 && !done; k++) {
        MUST(c->session, spar_step_solve(c->session));
        MUST(c->session, solve(c->session, 0, dt, k, c));
        MUST(c->session, spar_step_check(c->session, &done));
    }
    MUST(c->session, spar_step_solve(c->session));
}

static void look(const scene *c, double *out) {
    int64_t n = 0, steps = 0;
    memset(out, 0, STATE * sizeof *out);
    MUST(c->session, spar_session_get_time(c->session, out, &steps, NULL));
    out[1] = (double)steps;
    double *at = out + 2;
    for (int k = 0; k < c->members; k++, at += 25 * MOST_NODES) {
        MUST(c->session, spar_member_get_count(c->member[k], &n));
        MUST(c->session, spar_member_get_motion(c->member[k], at, at + 7 * n, at + 13 * n));
        MUST(c->session, spar_member_get_loads(c->member[k], at + 19 * n));
    }
}

static void end(scene *c) {
    spar_session_destroy(&c->session);
}

/* ---- cases ---- */

static time_t began; /* the case; seconds of processor time */
static int rounds;

static time_t processor_time(void) {
    struct timespec t = {0};
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec;
}

/* A case that got less than LIMIT seconds of processor time may still end: another LIMIT, at most five. */
static void too_long(int signal_number) {
    static const char text[] = "\nfiles: waits: ";
    (void)signal_number;
    if (processor_time() - began < LIMIT && ++rounds < 5) {
        (void)alarm(LIMIT);
        return;
    }
    (void)!write(2, text, sizeof text - 1);
    (void)!write(2, name, strlen(name));
    (void)!write(2, "\n", 1);
    _exit(3);
}

static void start(const char *what, long a, long b) {
    (void)snprintf(name, sizeof name, "%s %ld %ld", what, a, b);
    cases++;
    began = processor_time();
    rounds = 0;
    (void)alarm(LIMIT);
}

static void fail_case(const char *what, int status, const char *message) {
    fprintf(stderr, "files: %s: %s (status %d: %s)\n", name, what, status, message);
    if (++failures > FAILURES) {
        exit(1);
    }
}

static int64_t roll(int64_t n) {
    dice ^= dice << 13, dice ^= dice >> 7, dice ^= dice << 17;
    return (int64_t)(dice % (uint64_t)n);
}

static double now(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double deadline; /* of a part; 0: none */

static int in_time(void) {
    return deadline == 0 || now() < deadline;
}

static unsigned char *bytes; /* of the file under test */
static size_t length;

static void put(const char *path, const void *data, size_t n) {
    (void)remove(path); /* file systems that flush what is written over make it slow */
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, n, f) != n || fclose(f) != 0) {
        must(SPAR_ERR_IO, path, NULL);
    }
}

static size_t get(const char *path, unsigned char **data) {
    FILE *f = fopen(path, "rb");
    struct stat s;
    if (!f || fstat(fileno(f), &s) != 0) {
        must(SPAR_ERR_IO, path, NULL);
        return 0;
    }
    free(*data);
    *data = malloc((size_t)s.st_size + 1);
    size_t n = fread(*data, 1, (size_t)s.st_size, f);
    (*data)[n] = 0;
    (void)fclose(f);
    return n;
}

static void same(const scene *a, const double *before, const char *what) {
    double after[STATE];
    look(a, after);
    if (memcmp(before, after, sizeof after) != 0) {
        fail_case(what, 0, "");
    }
}

/* Refuses it with the status, says why, and is as it was. */
static void refuses(const scene *c, const char *path, int expected, const double *before) {
    int status = spar_session_load(c->session, path);
    const char *message = spar_session_message(c->session);
    if (status != expected) {
        fail_case("answers otherwise", status, message);
    } else if (strncmp(message, "spar_session_load: ", 19) != 0) {
        fail_case("does not name the call", status, message);
    }
    same(c, before, "is not as it was");
}

/* ---- cut off, bits turned, another session's ---- */

static void run(scene *c, int n) {
    for (int i = 0; i < n; i++) {
        MUST(c->session, step(c));
    }
}

static void damaged(void) {
    scene c, other;
    double before[STATE];
    create_small(&c, 0);
    run(&c, 3);
    MUST(c.session, spar_session_save(c.session, "good"));
    length = get("good", &bytes);
    run(&c, 2);
    look(&c, before);
    for (size_t n = 0; n < length; n++) {
        start("cut off after", (long)n, 0);
        put("bad", bytes, n);
        refuses(&c, "bad", SPAR_ERR_IO, before);
    }
    for (size_t bit = 0; bit < 8 * length; bit++) {
        if (deadline > 0 && bit > 512 && roll(4) != 0) { /* the short form: all of the heading, some of the rest */
            continue;
        }
        start("with a turned bit", (long)bit, 0);
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        put("bad", bytes, length);
        refuses(&c, "bad", SPAR_ERR_IO, before);
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    for (int variant = 1; variant <= 3; variant++) {
        start("of another session", variant, 0);
        create_small(&other, variant);
        look(&other, before);
        refuses(&other, "good", SPAR_ERR_ARGUMENT, before);
        end(&other);
    }
    start("good again", 0, 0);
    create_small(&other, 0);
    run(&other, 3);
    MUST(c.session, spar_session_load(c.session, "good"));
    run(&c, 3);
    run(&other, 3);
    look(&other, before);
    same(&c, before, "does not go on with the same bits");
    end(&c);
    end(&other);
}

/* ---- absurd contents under a right checksum ---- */

static uint64_t get_word(const unsigned char *from) {
    uint64_t word = 0;
    for (int i = 0; i < 8; i++) {
        word |= (uint64_t)from[i] << (8 * i);
    }
    return word;
}

static void put_word(unsigned char *to, uint64_t word) {
    for (int i = 0; i < 8; i++) {
        to[i] = (unsigned char)(word >> (8 * i));
    }
}

/* CRC-64 of ECMA-182, reflected */
static uint64_t crc64(const unsigned char *data, size_t n) {
    static uint64_t table[256];
    uint64_t crc = ~UINT64_C(0);
    for (uint64_t i = 0; i < 256 && !table[255]; i++) {
        uint64_t c = i;
        for (int k = 0; k < 8; k++) {
            c = (c >> 1) ^ (c & 1 ? UINT64_C(0xC96C5795D7870F42) : 0);
        }
        table[i] = c;
    }
    for (size_t i = 0; i < n; i++) {
        crc = (crc >> 8) ^ table[(crc ^ data[i]) & 0xff];
    }
    return ~crc;
}

static uint64_t as_word(double x) {
    uint64_t word;
    memcpy(&word, &x, sizeof word);
    return word;
}

/* Where harm is done: counts, flags and places, as whole numbers or as doubles; but zeros are mostly loads. */
static int is_structure(uint64_t word, int as_real) {
    double x;
    memcpy(&x, &word, sizeof x);
    return as_real ? x > 0 && x < 100000 && x == floor(x) : word > 0 && word < 100000;
}

static int64_t pick(const unsigned char *all, int64_t words) {
    int64_t at = roll(words), kind = roll(8);
    for (int tries = 0; tries < 3000 && kind < 6; tries++) {
        if (is_structure(get_word(all + HEAD + 8 * at), kind < 2)) {
            break;
        }
        at = roll(words);
    }
    return at;
}

static uint64_t absurd(uint64_t word, int64_t words) {
    static const double reals[] = {NAN, INFINITY, -INFINITY, 0, -1, 1e300, 1e15, -1e15, 0.5, 1e-320, 2, 3, 4, 1e9};
    static const uint64_t wholes[] = {0,
                                      1,
                                      2,
                                      3,
                                      4,
                                      5,
                                      100,
                                      UINT64_MAX,
                                      (uint64_t)INT64_MAX,
                                      (uint64_t)1 << 63,
                                      (uint64_t)INT32_MAX,
                                      (uint64_t)INT32_MAX + 1,
                                      UINT32_MAX,
                                      (uint64_t)1 << 40};
    double x;
    memcpy(&x, &word, sizeof x);
    switch (roll(7)) {
    case 0:
        return as_word(reals[roll(sizeof reals / sizeof *reals)]);
    case 1:
        return wholes[roll(sizeof wholes / sizeof *wholes)];
    case 2:
        return word + (uint64_t)roll(5) - 2;
    case 3:
        return as_word(x + (double)roll(5) - 2);
    case 4:
        return (uint64_t)roll(words);
    case 5:
        return word ^ (uint64_t)1 << roll(64);
    default:
        return get_word(bytes + HEAD + 8 * roll(words));
    }
}

/* The good file with one to three words made absurd, taken out or put in. */
static void write_absurd(const char *path) {
    int64_t words = (int64_t)((length - HEAD - 8) / 8);
    unsigned char *all = malloc(length + 8 * 16);
    memcpy(all, bytes, length);
    for (int64_t k = 1 + roll(3); k > 0; k--) {
        int64_t at = pick(all, words);
        unsigned char *word = all + HEAD + 8 * at;
        int64_t kind = roll(12);
        if (kind == 0 && words > 10) {
            memmove(word, word + 8, (size_t)(8 * (words - at - 1)));
            words--;
        } else if (kind == 1) {
            memmove(word + 8, word, (size_t)(8 * (words - at)));
            words++;
        } else {
            put_word(word, absurd(get_word(word), (int64_t)((length - HEAD - 8) / 8)));
        }
    }
    put_word(all + 16, (uint64_t)words);
    size_t n = HEAD + 8 * (size_t)words;
    put_word(all + n, crc64(all, n));
    put(path, all, n + 8);
    free(all);
}

/* All a host might do with what was loaded. */
static void use(scene *c) {
    double energy[4], reaction[6], report[SPAR_REPORT_COUNT], audit[8], residual[2][64];
    int done = 0;
    for (int k = 0; k < c->members; k++) {
        (void)spar_member_get_energy(c->member[k], 4, energy);
        (void)spar_member_get_reaction(c->member[k], reaction);
    }
    (void)spar_session_get_iterations(c->session, NULL, 64, residual[0], residual[1]);
    (void)spar_session_get_report(c->session, SPAR_REPORT_COUNT, report);
    (void)spar_fluid_get_audit(c->fluid[0], 8, audit);
    (void)spar_step_solve(c->session);
    (void)solve(c->session, 0, dt, 0, c);
    (void)spar_step_check(c->session, &done);
    (void)spar_step_accept(c->session);
    (void)spar_step_reject(c->session);
    for (int i = 0; i < 2; i++) {
        (void)step(c);
    }
    if (roll(32) == 0) { /* flushing takes its time */
        (void)spar_session_save(c->session, "after");
    }
}

/* hit: a session between steps. good: the file it came from; then: its state, and that two steps later. */
static int load_absurd(scene *hit, const double *state) {
    int otherwise = roll(8) == 0; /* the coupling in the file is passed over then */
    MUST(hit->session, otherwise ? spar_session_set_relaxation(hit->session, 0.9) : SPAR_OK);
    int status = spar_session_load(hit->session, "bad");
    const char *message = spar_session_message(hit->session);
    if (status == SPAR_OK) {
        use(hit);
        MUST(hit->session, otherwise ? spar_session_set_relaxation(hit->session, 1) : SPAR_OK);
        return 1;
    }
    if (status != SPAR_ERR_IO && status != SPAR_ERR_ARGUMENT && status != SPAR_ERR_STATE) {
        fail_case("answers otherwise", status, message);
    } else if (strncmp(message, "spar_session_load: ", 19) != 0) {
        fail_case("does not name the call", status, message);
    }
    same(hit, state, "is not as it was");
    MUST(hit->session, otherwise ? spar_session_set_relaxation(hit->session, 1) : SPAR_OK);
    return 0;
}

static void absurd_files(int within) {
    scene hit, calm;
    double state[STATE], later[STATE];
    long loaded = 0, begun = cases;
    create_large(&hit);
    create_large(&calm);
    run(&hit, 4);
    run(&calm, 4);
    MUST(hit.session, spar_session_save(hit.session, "good"));
    look(&hit, state);
    run(&calm, 2);
    look(&calm, later);
    if (within) {
        half_a_step(&hit);
    }
    MUST(hit.session, spar_session_save(hit.session, "mine"));
    length = get("mine", &bytes);
    if (within) {
        MUST(hit.session, spar_step_reject(hit.session));
        MUST(hit.session, spar_session_load(hit.session, "good"));
    }
    for (long k = 0; deadline == 0 ? k < 100000 : in_time(); k++) {
        uint64_t seed = dice;
        start(within ? "absurd, within a step" : "absurd", k, 0);
        (void)snprintf(name + strlen(name), sizeof name - strlen(name), ", dice %llu", (unsigned long long)seed);
        write_absurd("bad");
        if (load_absurd(&hit, state)) {
            loaded++;
            MUST(hit.session, spar_session_load(hit.session, "good"));
            same(&hit, state, "the good file does not bring back the good state");
            if (loaded % 16 == 0) {
                run(&hit, 2);
                same(&hit, later, "the good file does not bring back the good run");
                MUST(hit.session, spar_session_load(hit.session, "good"));
            }
        }
    }
    printf("files: %ld absurd files%s, %ld of them loaded\n", cases - begun, within ? " from within a step" : "",
           loaded);
    end(&hit);
    end(&calm);
}

static void absurd_between(void) {
    absurd_files(0);
}

static void absurd_within(void) {
    absurd_files(1);
}

/* ---- no room ---- */

static scene *writer; /* who writes */

static int save(const char *path) {
    return spar_session_save(writer->session, path);
}

static int picture(const char *path) {
    return spar_member_write_vtk(writer->member[0], path);
}

static int fluid_picture(const char *path) {
    return spar_fluid_write_vtk(writer->fluid[0], path);
}

static int series(const char *path) {
    return spar_vtk_series_add(path, 0.25, 0, "a_picture.vtp");
}

static void no_room(void) {
    static int (*const write_file[])(const char *) = {save, picture, fluid_picture, series};
    scene c, calm;
    double state[STATE];
    struct rlimit old, little;
    create_small(&c, 0);
    create_small(&calm, 0);
    run(&c, 2);
    run(&calm, 2);
    writer = &c;
    (void)signal(SIGXFSZ, SIG_IGN);
    (void)getrlimit(RLIMIT_FSIZE, &old);
    for (int k = 0; k < 4; k++) {
        unsigned char *after = NULL;
        MUST(c.session, write_file[k]("full"));
        length = get("full", &bytes);
        for (size_t room = 0; room<length; room += deadline> 0 ? 1 + (size_t)roll(40) : 1) {
            start("no room for more than", (long)room, k);
            little = (struct rlimit){room, old.rlim_max};
            (void)setrlimit(RLIMIT_FSIZE, &little);
            int status = write_file[k]("full");
            (void)setrlimit(RLIMIT_FSIZE, &old);
            const char *message = spar_session_message(k == 3 ? NULL : c.session);
            if (status != SPAR_ERR_IO || !strstr(message, "File too large")) {
                fail_case("answers otherwise", status, message);
            }
            size_t n = get("full", &after);
            if (n != length || memcmp(bytes, after, n) != 0) {
                fail_case("what stood there has changed", status, message);
            }
            if (access("full.new", F_OK) == 0 || access("full.part", F_OK) == 0) {
                fail_case("something is left", status, message);
            }
        }
        free(after);
        (void)remove("full");
    }
    run(&c, 2);
    run(&calm, 2);
    look(&calm, state);
    same(&c, state, "the run is another one now");
    end(&c);
    end(&calm);
}

/* ---- killed ---- */

/* Runs, saves after every step and within every other one, until it is killed. Never returns. */
static void run_for_ever(void) {
    scene c;
    create_small(&c, 0);
    MUST(c.session, spar_session_set_coupling(c.session, SPAR_COUPLING_IQN_ILS, 0, 1e-8, 60));
    if (access("run", F_OK) == 0) {
        MUST(c.session, spar_session_load(c.session, "run"));
        (void)spar_step_reject(c.session); /* where it was saved within a step */
    }
    for (long k = 0;; k++) {
        MUST(c.session, step(&c));
        MUST(c.session, spar_session_save(c.session, "run"));
        if (k % 2 == 0) {
            MUST(c.session, spar_step_begin(c.session, dt));
            MUST(c.session, spar_step_solve(c.session));
            MUST(c.session, spar_session_save(c.session, "run"));
            MUST(c.session, spar_step_reject(c.session));
        }
    }
}

static pid_t spawn(void (*work)(void)) {
    (void)fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        (void)alarm(2 * LIMIT);
        work();
        _exit(4);
    }
    return child;
}

/* Ends by the kill and by nothing else. */
static void kill_after(pid_t child, int64_t microseconds) {
    struct timespec wait = {.tv_sec = 0, .tv_nsec = 1000 * microseconds};
    int status = 0;
    (void)nanosleep(&wait, NULL);
    (void)kill(child, SIGKILL);
    (void)waitpid(child, &status, 0);
    if (!WIFSIGNALED(status) || WTERMSIG(status) != SIGKILL) {
        fail_case("the run has ended by itself", status, "");
    }
}

static void killed(void) {
    scene calm, resumed;
    double state[STATE];
    int64_t at = 0, there = 0;
    long kills = 0;
    create_small(&calm, 0);
    create_small(&resumed, 0);
    MUST(calm.session, spar_session_set_coupling(calm.session, SPAR_COUPLING_IQN_ILS, 0, 1e-8, 60));
    MUST(resumed.session, spar_session_set_coupling(resumed.session, SPAR_COUPLING_IQN_ILS, 0, 1e-8, 60));
    (void)remove("run");
    for (; kills < 100 || (deadline == 0 && kills < 3000); kills++) {
        start("killed", kills, 0);
        kill_after(spawn(run_for_ever), 1 + roll(20000));
        if (access("run", F_OK) != 0) { /* it had not come to its first save */
            continue;
        }
        MUST(resumed.session, spar_session_load(resumed.session, "run"));
        (void)spar_step_reject(resumed.session); /* where it was saved within a step */
        MUST(resumed.session, spar_session_get_time(resumed.session, NULL, &there, NULL));
        for (; at < there; at++) {
            MUST(calm.session, step(&calm));
        }
        look(&calm, state);
        same(&resumed, state, "does not go on with the same bits");
    }
    printf("files: %ld kills over %lld steps\n", kills, (long long)at);
    end(&calm);
    end(&resumed);
}

static void draw_for_ever(void) {
    scene c;
    create_small(&c, 0);
    writer = &c;
    for (;;) {
        MUST(c.session, picture("drawn.vtp"));
        MUST(NULL, series("drawn.pvd"));
    }
}

static void is_whole(const char *path) {
    unsigned char *all = NULL;
    static const char foot[] = "</VTKFile>\n";
    if (access(path, F_OK) == 0) {
        size_t n = get(path, &all);
        if (n < sizeof foot || memcmp(all + n - (sizeof foot - 1), foot, sizeof foot - 1) != 0) {
            fail_case("half a picture", 0, path);
        }
        free(all);
    }
}

static void killed_pictures(void) {
    for (long k = 0; k < 30 || (deadline == 0 && k < 1000); k++) {
        start("killed drawing", k, 0);
        kill_after(spawn(draw_for_ever), 1 + roll(8000));
        is_whole("drawn.vtp");
        is_whole("drawn.pvd");
    }
}

/* ---- an index cut off ---- */

static void cut_series(void) {
    unsigned char *after = NULL;
    for (int i = 0; i < 3; i++) {
        MUST(NULL, series("whole.pvd"));
    }
    length = get("whole.pvd", &bytes);
    for (size_t n = 1; n < length; n++) {
        start("index cut off after", (long)n, 0);
        put("cut.pvd", bytes, n);
        int status = series("cut.pvd");
        if (status != SPAR_ERR_IO || !strstr(spar_session_message(NULL), "not an index")) {
            fail_case("answers otherwise", status, spar_session_message(NULL));
        }
        if (get("cut.pvd", &after) != n || memcmp(bytes, after, n) != 0) {
            fail_case("what stood there has changed", status, "");
        }
    }
    free(after);
}

/* ---- two at a time ---- */

static void save_for_ever(void) {
    scene c;
    create_small(&c, 0);
    run(&c, 2);
    for (;;) {
        int status = spar_session_save(c.session, "both");
        const char *message = spar_session_message(c.session);
        if (status != SPAR_OK && !strstr(message, "another process") && !strstr(message, strerror(EBUSY))) {
            must(status, "save", c.session);
        }
    }
}

static void two_at_a_time(void) {
    scene calm, reader;
    double state[STATE], until = now() + (deadline > 0 ? 0.7 : 20);
    create_small(&calm, 0);
    create_small(&reader, 0);
    run(&calm, 2);
    look(&calm, state);
    MUST(calm.session, spar_session_save(calm.session, "both"));
    pid_t child[2] = {spawn(save_for_ever), spawn(save_for_ever)};
    for (long k = 0; now() < until; k++) {
        start("two at a time", k, 0);
        if (k % 50 == 0) { /* and one of them is killed now and then */
            kill_after(child[k / 50 % 2], 1 + roll(3000));
            child[k / 50 % 2] = spawn(save_for_ever);
        }
        MUST(reader.session, spar_session_load(reader.session, "both"));
        same(&reader, state, "is not what either of them has written");
    }
    kill_after(child[0], 1);
    kill_after(child[1], 1);
    end(&calm);
    end(&reader);
}

/* ---- all of it ---- */

int main(int argc, char **argv) {
    static const struct part {
        void (*work)(void);
        double share; /* of the seconds; 0: takes what it takes */
    } parts[] = {{damaged, 0}, {cut_series, 0},      {no_room, 0},          {two_at_a_time, 0},
                 {killed, 0},  {killed_pictures, 0}, {absurd_between, 0.5}, {absurd_within, 0.5}};
    const char *base = getenv("TMPDIR");
    char command[96];
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 0;
    dice = argc > 2 ? strtoull(argv[2], NULL, 0) : (uint64_t)time(NULL);
    printf("files: seed %llu\n", (unsigned long long)dice);
    dice = dice * UINT64_C(0x9E3779B97F4A7C15) | 1;
    (void)signal(SIGALRM, too_long);
    (void)snprintf(home, sizeof home, "%.40s/spar-files-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(home) || chdir(home) != 0) {
        fprintf(stderr, "files: no folder %s\n", home);
        return 2;
    }
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        double since = now();
        long before = cases;
        deadline = seconds > 0 ? now() + parts[k].share * seconds : 0;
        parts[k].work();
        printf("files: part %zu: %ld cases in %.1f s\n", k, cases - before, now() - since);
    }
    (void)alarm(0);
    printf("files: %ld cases, %d failures\n", cases, failures);
    free(bytes);
    (void)snprintf(command, sizeof command, "rm -rf '%s'", home);
    return chdir("/") != 0 || system(command) != 0 || failures > 0;
}
