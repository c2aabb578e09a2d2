/* What is read can be written back: each setting that has a getter is read and written back as it is, before the first
   step and between two steps. Set-up: a beam with all that a beam can have, a beam with nothing but axis and sections,
   a rigid body, a beam that the host moves; two fluids with added mass; IQN-ILS, whose memory from step to step a
   setter must not clear. Expected: all getters give what they gave, and eight steps have the same bits as in a run
   without writing back. */
#include "scene.h"
#include "trials.h"

#include "base/session.h"

#include <dirent.h>
#include <stdio.h>

enum { BLADE, BARE, BODY, HELD, MEMBERS, FLUIDS = 3, NUMBERS = 4000, TABLE = 16, STEPS = 8 };

typedef struct scene {
    spar_session *s;
    spar_member *m[MEMBERS];
    spar_fluid *f[FLUIDS];
    double *x; /* [NUMBERS] what has been read */
    int n;
    int writes; /* what is read is written back */
} scene;

static void keep(scene *w, int64_t n, const double *x) {
    for (int64_t i = 0; i < n; i++) {
        assert_true(w->n < NUMBERS);
        w->x[w->n++] = x[i];
    }
}

static void keep_one(scene *w, double x) {
    keep(w, 1, &x);
}

/* Writes back where that is asked for. */
#define WRITE(w, call)                                                                                                 \
    do {                                                                                                               \
        if ((w)->writes) {                                                                                             \
            OK((w)->s, call);                                                                                          \
        }                                                                                                              \
    } while (0)

/* ---- settings of the session ---- */

static void options(scene *w) {
    for (int i = 0; i < w->s->setting_count; i++) {
        const spari_setting *of = w->s->settings + i;
        char text[32];
        if (strncmp(of->name, "option ", 7) != 0) {
            continue;
        }
        OK(w->s, spar_session_get_option(w->s, of->key, sizeof text, text));
        WRITE(w, spar_session_set_option(w->s, of->key, text));
        for (const char *c = text; *c; c++) {
            keep_one(w, *c);
        }
    }
}

static void session_settings(scene *w) {
    spar_session *s = w->s;
    double g[3], a, b;
    int i, k;
    OK(s, spar_session_get_gravity(s, g));
    WRITE(w, spar_session_set_gravity(s, g));
    keep(w, 3, g);
    OK(s, spar_session_get_integrator(s, &a, &i));
    WRITE(w, spar_session_set_integrator(s, a, i));
    keep_one(w, a), keep_one(w, i);
    OK(s, spar_session_get_newton(s, &a, &b, &i));
    WRITE(w, spar_session_set_newton(s, a, b, i));
    keep_one(w, a), keep_one(w, b), keep_one(w, i);
    OK(s, spar_session_get_predictor(s, &i));
    WRITE(w, spar_session_set_predictor(s, i));
    keep_one(w, i);
    OK(s, spar_session_get_coupling(s, &i, &a, &b, &k));
    WRITE(w, spar_session_set_coupling(s, i, a, b, k));
    keep_one(w, i), keep_one(w, a), keep_one(w, b), keep_one(w, k);
    OK(s, spar_session_get_relaxation(s, &a));
    WRITE(w, spar_session_set_relaxation(s, a));
    keep_one(w, a);
    OK(s, spar_session_get_reproducible(s, &i));
    WRITE(w, spar_session_set_reproducible(s, i));
    keep_one(w, i);
    OK(s, spar_session_get_threads(s, &i));
    WRITE(w, spar_session_set_threads(s, i));
    keep_one(w, i);
    OK(s, spar_session_get_tolerance(s, &a, &b));
    WRITE(w, spar_session_set_tolerance(s, a, b));
    keep_one(w, a), keep_one(w, b);
    options(w);
}

/* ---- settings of a trial ---- */

static void trial_settings(scene *w) {
    static const char *const option[] = {"dt", "nodes", "coupling", "limit"};
    spar_trial *t = trial_of(w->s);
    double a;
    int64_t n, k;
    int i;
    OK(w->s, spar_trial_get_steps(t, &a, &n));
    WRITE(w, spar_trial_set_steps(t, a, n));
    keep_one(w, a), keep_one(w, (double)n);
    OK(w->s, spar_trial_get_goals(t, &i));
    WRITE(w, spar_trial_set_goals(t, i));
    keep_one(w, i);
    OK(w->s, spar_trial_get_motion(t, &n, &a, &k));
    WRITE(w, spar_trial_set_motion(t, n, a, k));
    keep_one(w, (double)n), keep_one(w, a), keep_one(w, (double)k);
    for (size_t o = 0; o < sizeof option / sizeof *option; o++) {
        char text[32];
        OK(w->s, spar_trial_get_option(t, option[o], sizeof text, text));
        WRITE(w, spar_trial_set_option(t, option[o], text));
        for (const char *c = text; *c; c++) {
            keep_one(w, *c);
        }
    }
}

/* ---- settings of members, before their commit ---- */

/* A table of stations: its getter and its setter, width numbers each. */
#define STATIONS(w, member, width, get, set)                                                                           \
    do {                                                                                                               \
        int64_t n_;                                                                                                    \
        double eta_[TABLE], value_[TABLE * (width)];                                                                   \
        OK((w)->s, get(member, &n_, TABLE, eta_, value_));                                                             \
        WRITE(w, set(member, n_, eta_, value_));                                                                       \
        keep_one(w, (double)n_), keep(w, n_, eta_), keep(w, n_ *(width), value_);                                      \
    } while (0)

static void beam_settings(scene *w, spar_member *b) {
    double mu[6], alpha, eta[TABLE], x[3 * TABLE], twist[TABLE], K[36 * TABLE], M[36 * TABLE];
    int rule, points, kind;
    int64_t modes, n;
    OK(w->s, spar_beam_get_axis(b, &n, TABLE, eta, x, twist));
    assert_true(n >= 2 && n <= TABLE);
    WRITE(w, spar_beam_set_axis(b, n, eta, x, twist));
    keep(w, n, eta), keep(w, 3 * n, x), keep(w, n, twist);
    OK(w->s, spar_beam_get_sections(b, &n, TABLE, eta, K, M));
    assert_true(n >= 1 && n <= TABLE);
    WRITE(w, spar_beam_set_sections(b, n, eta, K, M));
    keep(w, n, eta), keep(w, 36 * n, K), keep(w, 36 * n, M);
    STATIONS(w, b, 36, spar_beam_get_masses, spar_beam_set_masses);
    STATIONS(w, b, 3, spar_beam_get_foundation, spar_beam_set_foundation);
    STATIONS(w, b, 6, spar_beam_get_pretension, spar_beam_set_pretension);
    OK(w->s, spar_beam_get_quadrature(b, &rule, &points));
    WRITE(w, spar_beam_set_quadrature(b, rule, points));
    keep_one(w, rule), keep_one(w, points);
    OK(w->s, spar_beam_get_damping(b, mu));
    WRITE(w, spar_beam_set_damping(b, mu));
    keep(w, 6, mu);
    OK(w->s, spar_beam_get_mass_damping(b, &alpha));
    WRITE(w, spar_beam_set_mass_damping(b, alpha));
    keep_one(w, alpha);
    OK(w->s, spar_beam_get_plane(b, mu));
    WRITE(w, spar_beam_set_plane(b, mu));
    keep(w, 3, mu);
    OK(w->s, spar_member_get_fidelity(b, &kind, &modes));
    WRITE(w, spar_member_set_fidelity(b, kind, modes));
    keep_one(w, kind), keep_one(w, (double)modes);
}

static void member_settings(scene *w, spar_member *m) {
    double x[3], q[4];
    int i;
    OK(w->s, spar_member_get_placement(m, x, q));
    WRITE(w, spar_member_set_placement(m, x, q));
    keep(w, 3, x), keep(w, 4, q);
    OK(w->s, spar_member_get_root(m, &i));
    WRITE(w, spar_member_set_root(m, i));
    keep_one(w, i);
    OK(w->s, spar_member_get_external(m, &i));
    WRITE(w, spar_member_set_external(m, i));
    keep_one(w, i);
    STATIONS(w, m, 36, spar_member_get_added_mass, spar_member_set_added_mass);
    OK(w->s, spar_member_get_added_mass_response(m, &i));
    WRITE(w, spar_member_set_added_mass_response(m, i));
    keep_one(w, i);
    OK(w->s, spar_member_get_owner(m, &i));
    WRITE(w, spar_member_set_owner(m, i));
    keep_one(w, i);
}

/* ---- settings of fluids ---- */

/* before_map: those of the nodes, which hold positions to the bit only if they are given before the map */
static void fluid_settings(scene *w, spar_fluid *f, int before_map) {
    double far, weight[TABLE];
    int64_t a, b, n;
    int i;
    OK(w->s, spar_fluid_get_projection(f, &i, &far));
    WRITE(w, spar_fluid_set_projection(f, i, far));
    keep_one(w, i), keep_one(w, far);
    OK(w->s, spar_fluid_get_interpolation(f, &i));
    WRITE(w, spar_fluid_set_interpolation(f, i));
    keep_one(w, i);
    for (int k = 0; k < 4; k++) {
        static const char *const key[4] = {"theta", "far", "audit", "velocity"};
        char text[32];
        OK(w->s, spar_fluid_get_option(f, key[k], sizeof text, text));
        WRITE(w, spar_fluid_set_option(f, key[k], text));
        for (const char *c = text; *c; c++) {
            keep_one(w, *c);
        }
    }
    for (int which = SPAR_NODES_MOTION; which <= SPAR_NODES_FORCE; which++) {
        OK(w->s, spar_fluid_get_layout(f, which, &a, &b));
        WRITE(w, spar_fluid_set_layout(f, which, a, b));
        keep_one(w, (double)a), keep_one(w, (double)b);
    }
    OK(w->s, spar_fluid_get_states(f, &n, NULL));
    WRITE(w, spar_fluid_set_states(f, n));
    keep_one(w, (double)n);
    if (before_map) {
        OK(w->s, spar_fluid_get_count(f, SPAR_NODES_MOTION, &n));
        assert_true(n > 0 && n <= TABLE);
        OK(w->s, spar_fluid_get_motion_weights(f, weight));
        WRITE(w, spar_fluid_set_motion_weights(f, n, weight));
        keep(w, n, weight);
    }
}

/* ---- the scene ---- */

/* The settings of the session are others than the defaults. */
static void change_session(spar_session *s) {
    static const char *const option[][2] = {
        {"coupling.unconverged", "accept"}, {"coupling.unstable", "accept"},
        {"coupling.patience", "7"},         {"coupling.filter", "0.00012345678901234"},
        {"coupling.columns", "20"},         {"coupling.reuse", "4"},
        {"coupling.motion_rtol", "1e-9"}};
    OK(s, spar_session_set_gravity(s, (const double[]){0.1, 0.2, -9.81}));
    OK(s, spar_session_set_integrator(s, 0.8, 2));
    OK(s, spar_session_set_newton(s, 1e-14, 1e-11, 40));
    OK(s, spar_session_set_predictor(s, 2));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-10, 1e-8, 60));
    OK(s, spar_session_set_relaxation(s, 0.9));
    OK(s, spar_session_set_reproducible(s, 1));
    OK(s, spar_session_set_threads(s, 2));
    OK(s, spar_session_set_tolerance(s, 1e3, 0.5));
    OK(s, spar_trial_set_steps(trial_of(s), 0.01, 24));
    OK(s, spar_trial_set_motion(trial_of(s), 3, 1e-3, 7));
    OK(s, spar_trial_set_goals(trial_of(s), SPAR_GOAL_MOTION | SPAR_GOAL_LOAD));
    OK(s, spar_trial_set_option(trial_of(s), "nodes", "keep"));
    OK(s, spar_trial_set_option(trial_of(s), "limit", "12"));
    for (size_t i = 0; i < sizeof option / sizeof *option; i++) {
        OK(s, spar_session_set_option(s, option[i][0], option[i][1]));
    }
}

static spar_member *beam(scene *w, const char *name, int stations) {
    const double eta[3] = {0, 0.4, 1}, xyz[9] = {0, 0, 0, 4, 0, 0, 10, 0, 0};
    double K[3 * 36], M[3 * 36];
    spar_member *b = NULL;
    for (int i = 0; i < 3; i++) {
        scene_box(K + 36 * i, M + 36 * i);
        for (int k = 0; k < 36; k++) {
            K[36 * i + k] *= 1 - 0.2 * i;
        }
    }
    OK(w->s, spar_beam_create(w->s, name, 2, 5, &b));
    OK(w->s, spar_beam_set_axis(b, 3, eta, xyz, NULL));
    OK(w->s, spar_beam_set_sections(b, stations, eta, K, M));
    return b;
}

/* All that a beam can have. */
static void furnish(scene *w, spar_member *b) {
    const double eta[2] = {0.3, 0.9}, mu[6] = {1e-3, 1e-3, 1e-3, 2e-3, 1e-3, 1e-3}, ground[6] = {0, 3, 4, 0, 5, 6},
                 pull[12] = {20, 0, 0, 0, 0, 0, 10, 0, 0, 0, 0, 0}, q[4] = {0.8, 0, 0.6, 0}, at[3] = {1, 2, 3};
    double mass[2 * 36], added[2 * 36];
    scene_diagonal(mass, 0.1, 0.1, 0.1, 1e-3, 1e-3, 1e-3), scene_diagonal(mass + 36, 0.2, 0.2, 0.2, 0, 0, 0);
    scene_diagonal(added, 0, 0.05, 0.05, 0, 0, 0), scene_diagonal(added + 36, 0, 0.04, 0.03, 0, 0, 0);
    OK(w->s, spar_beam_set_masses(b, 2, eta, mass));
    OK(w->s, spar_beam_set_foundation(b, 2, eta, ground));
    OK(w->s, spar_beam_set_pretension(b, 2, eta, pull));
    OK(w->s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_LOBATTO, 7));
    OK(w->s, spar_beam_set_damping(b, mu));
    OK(w->s, spar_beam_set_mass_damping(b, 0.3));
    OK(w->s, spar_member_set_placement(b, at, q));
    OK(w->s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(w->s, spar_member_set_added_mass(b, 2, eta, added));
    OK(w->s, spar_member_set_owner(b, 0));
}

static void make_fluid(scene *w, int k, spar_member *m, int furnished) {
    double x[3 * 3], q[4], at[3];
    OK(w->s, spar_member_get_placement(m, at, q));
    for (int i = 0; i < 3; i++) {
        const double X[3] = {3.0 * i + 1, 0.1 * i, 0.2};
        spari_rotate(q, X, x + 3 * i);
        for (int c = 0; c < 3; c++) {
            x[3 * i + c] += at[c];
        }
    }
    OK(w->s, spar_fluid_create(m, "fluid", &w->f[k]));
    OK(w->s, spar_fluid_set_motion_nodes(w->f[k], 3, x));
    OK(w->s, spar_fluid_set_force_nodes(w->f[k], 3, x));
    if (furnished) {
        OK(w->s, spar_fluid_set_motion_weights(w->f[k], 3, (const double[]){1, 0.75, 0.3}));
        OK(w->s, spar_fluid_set_projection(w->f[k], SPAR_PROJECT_RPOLY, 2.5));
        OK(w->s, spar_fluid_set_interpolation(w->f[k], SPAR_INTERPOLATE_CONSISTENT));
        OK(w->s, spar_fluid_set_layout(w->f[k], SPAR_NODES_MOTION, 1, 3));
        OK(w->s, spar_fluid_set_states(w->f[k], 2));
        OK(w->s, spar_fluid_set_option(w->f[k], "theta", "group"));
        OK(w->s, spar_fluid_set_option(w->f[k], "audit", "off"));
    }
    fluid_settings(w, w->f[k], 1);
    OK(w->s, spar_fluid_map(w->f[k]));
}

/* changed: settings are others than the defaults; effects_of: a committed twin, whose effects in force are given to
   this scene, or NULL */
static void make(scene *w, int changed, int writes, const scene *effects_of) {
    static const double box[3] = {80, 90, 70}, centre[3] = {0.1, 0, 0};
    double mass[36];
    *w = (scene){.writes = writes, .x = calloc(NUMBERS, sizeof *w->x)};
    OK(NULL, spar_session_create(&w->s));
    if (changed) {
        change_session(w->s);
    }
    session_settings(w);
    trial_settings(w);
    w->m[BLADE] = beam(w, "blade", 3), w->m[BARE] = beam(w, "bare", changed ? 1 : 3);
    scene_mass(mass, 2, centre, box);
    OK(w->s, spar_rigid_create(w->s, "body", NULL, NULL, mass, &w->m[BODY]));
    w->m[HELD] = beam(w, "held", 3);
    OK(w->s, spar_member_set_external(w->m[HELD], 1));
    if (changed) {
        furnish(w, w->m[BLADE]);
        scene_diagonal(mass, 1, 1, 1, 0, 0, 0);
        OK(w->s, spar_member_set_added_mass(w->m[BODY], 1, NULL, mass));
        OK(w->s, spar_member_set_added_mass_response(w->m[BODY], SPAR_RESPONSE_VELOCITY));
        OK(w->s, spar_member_set_effects(w->m[BLADE], SPAR_EFFECT_WORK, 0));
        OK(w->s, spar_member_set_fidelity(w->m[BARE], SPAR_FIDELITY_MODAL, 4));
    }
    for (int k = 0; k < MEMBERS; k++) {
        int effects;
        member_settings(w, w->m[k]);
        if (k != BODY) {
            beam_settings(w, w->m[k]);
        }
        if (effects_of) {
            OK(w->s, spar_member_get_effects(effects_of->m[k], &effects));
            OK(w->s, spar_member_set_effects(w->m[k], EFFECTS_ONLY(effects)));
        }
        OK(w->s, spar_member_commit(w->m[k]));
        OK(w->s, spar_member_get_effects(w->m[k], &effects));
        keep_one(w, effects);
    }
    for (int k = 0; k < FLUIDS; k++) {
        make_fluid(w, k, w->m[k], changed && k == BLADE);
    }
}

static void destroy(scene *w) {
    spar_session_destroy(&w->s);
    free(w->x);
}

/* Forces of an added mass, half of the members' own mass, and of a wind. */
static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *w = context;
    (void)iteration;
    for (int k = 0; k < FLUIDS; k++) {
        double v[2][9] = {{0}}, f[9] = {0};
        int64_t node, component;
        OK(s, spar_fluid_pull_motion(w->f[k], 0, NULL, v[0]));
        OK(s, spar_fluid_pull_motion(w->f[k], 1, NULL, v[1]));
        OK(s, spar_fluid_get_layout(w->f[k], SPAR_NODES_MOTION, &node, &component));
        for (int i = 0; i < 3; i++) {
            for (int c = 1; c < 3; c++) {
                f[3 * i + c] = 0.3 * (c == 1 ? sin(7 * t + i) : 1) -
                               0.1 * (v[1][node * i + component * c] - v[0][node * i + component * c]) / dt;
            }
        }
        OK(s, spar_fluid_push_forces(w->f[k], f, NULL));
    }
    return 0;
}

static void look(scene *w) {
    for (int k = 0; k < MEMBERS; k++) {
        double q[70], v[60], a[60];
        int64_t n;
        OK(w->s, spar_member_get_count(w->m[k], &n));
        OK(w->s, spar_member_get_motion(w->m[k], q, v, a));
        keep(w, 7 * n, q), keep(w, 6 * n, v), keep(w, 6 * n, a);
    }
}

/* In the middle of the run everything that can be set between steps is written back. */
static void run(scene *w) {
    for (int k = 0; k < STEPS; k++) {
        OK(w->s, spar_step(w->s, k < 2 ? 0.02 : 0.01, solve, w, NULL));
        if (k == 3) {
            session_settings(w);
            trial_settings(w);
            for (int f = 0; f < FLUIDS; f++) {
                fluid_settings(w, w->f[f], 0);
            }
        }
    }
    look(w);
}

static void compare(int changed) {
    scene without, with, again;
    make(&without, changed, 0, NULL), make(&with, changed, 1, NULL), make(&again, changed, 1, &without);
    run(&without), run(&with), run(&again);
    assert_int_equal(without.n, with.n);
    assert_int_equal(without.n, again.n);
    for (int i = 0; i < without.n; i++) {
        if (memcmp(without.x + i, with.x + i, sizeof *with.x) || memcmp(without.x + i, again.x + i, sizeof *again.x)) {
            fail_msg("number %d of %d: %.17g without writing back, %.17g with, %.17g with the effects in force", i,
                     without.n, without.x[i], with.x[i], again.x[i]);
        }
    }
    destroy(&without), destroy(&with), destroy(&again);
}

static void test_defaults(void **state) {
    (void)state;
    compare(0);
}

static void test_changed(void **state) {
    (void)state;
    compare(1);
}

/* ---- no setting is left out ---- */

/* Reads the public headers, one after the other. */
static char *headers(void) {
    const char *folder = SPAR_SOURCE_DIR "/include/spar";
    size_t size = 0, most = 1 << 20;
    char *text = calloc(most, 1), path[1024];
    DIR *list = opendir(folder);
    assert_non_null(list);
    for (struct dirent *entry; (entry = readdir(list));) {
        if (strstr(entry->d_name, ".h")) {
            (void)snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            FILE *file = fopen(path, "r");
            assert_non_null(file);
            size += fread(text + size, 1, most - size - 1, file);
            (void)fclose(file);
        }
    }
    (void)closedir(list);
    assert_true(size > 0 && size < most - 1);
    return text;
}

/* Each getter of the headers with a setter of the same name is tried above. Others of that name: what
   spar_joint_get_load and spar_aero_get_rotor give is no setting; spar_member_set_motion needs a step in progress. */
static void test_all_settings_are_tried(void **state) {
    (void)state;
    static const char *const tried =
        " session_gravity session_integrator session_newton session_predictor session_coupling session_relaxation "
        "session_reproducible session_threads session_option session_tolerance trial_steps trial_goals trial_motion "
        "trial_option beam_axis beam_sections beam_masses "
        "beam_foundation beam_pretension beam_quadrature beam_damping beam_mass_damping beam_plane member_placement "
        "member_root "
        "member_external member_effects member_fidelity member_added_mass member_owner fluid_motion_weights "
        "fluid_layout fluid_projection fluid_interpolation fluid_states fluid_option member_added_mass_response ";
    static const char *const other = " joint_load aero_rotor member_motion ";
    char *text = headers();
    int found = 0;
    for (const char *at = text; (at = strstr(at, "SPAR_API int spar_"));) {
        char name[80], setter[96], word[96];
        at += strlen("SPAR_API int spar_");
        int length = (int)strspn(at, "abcdefghijklmnopqrstuvwxyz0123456789_");
        (void)snprintf(name, sizeof name, "%.*s", length, at);
        char *get = strstr(name, "_get_");
        if (get) {
            (void)snprintf(setter, sizeof setter, "int spar_%.*s_set_%s(", (int)(get - name), name, get + 5);
            (void)snprintf(word, sizeof word, " %.*s_%s ", (int)(get - name), name, get + 5);
            if (strstr(text, setter) && !strstr(tried, word) && !strstr(other, word)) {
                fail_msg("spar_%s reads a setting that this test does not write back", name);
            }
            found += strstr(text, setter) && strstr(tried, word);
        }
    }
    assert_true(found >= 25);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_defaults), cmocka_unit_test(test_changed),
                                       cmocka_unit_test(test_all_settings_are_tried)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
