/* What accuracy costs: every knob of five scenes is turned on its own, and a few together.

     accuracy [--full] [--phases n] [--scene name] [--out file.csv]
         plays every setting and writes its errors (motion, loads) against a converged reference and the processor time
         of its steps (the least of several runs) over that of the scene's default; with phases, the least and the
         largest error of the scene as it is and begun n - 1 times elsewhere
     valgrind --tool=callgrind accuracy --count [--full] [--scene name]
         plays them once and dumps the instructions of the steps of each, labelled with its number; without --full only
         those of knobs default, fidelity and together (at the default's dt)

   Settings are numbered from 0 through all scenes. benchmarks/run joins the two. Progress on stderr. */
#include "scenes.h"

#include <spar/spar_aero.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef __has_include
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#define COUNTS 1
#endif
#endif

enum { SETTINGS_MAX = 1000, PHASES_MAX = 9 };

typedef struct setting {
    const scene *scene;
    const char *knob;
    char value[40];
    knobs knobs;
} setting;

static setting list[SETTINGS_MAX];
static int count;

/* ---- which settings there are ---- */

static void add(const scene *s, const char *knob, const char *value, knobs k) {
    if (count < SETTINGS_MAX) {
        setting *to = &list[count++];
        k.newton = k.newton > 0 ? k.newton : 1e-12;
        *to = (setting){.scene = s, .knob = knob, .knobs = k};
        snprintf(to->value, sizeof to->value, "%s", value);
    }
}

/* Adds a setting for every value of one field. */
#define TURN(knob, field, format, ...)                                                                                 \
    do {                                                                                                               \
        const double list_[] = {__VA_ARGS__};                                                                          \
        for (size_t i_ = 0; i_ < sizeof list_ / sizeof *list_; i_++) {                                                 \
            knobs k_ = s->standard;                                                                                    \
            char text_[40];                                                                                            \
            k_.field = (__typeof__(k_.field))list_[i_];                                                                \
            snprintf(text_, sizeof text_, format, list_[i_]);                                                          \
            add(s, knob, text_, k_);                                                                                   \
        }                                                                                                              \
    } while (0)

/* Adds a setting for one value of one field, by name. */
#define TAKE(knob, field, value, name)                                                                                 \
    do {                                                                                                               \
        knobs k_ = s->standard;                                                                                        \
        k_.field = (value);                                                                                            \
        add(s, knob, name, k_);                                                                                        \
    } while (0)

static void meshes(const scene *s) {
    static const int of[][2] = {{2, 8}, {4, 4}, {3, 6}, {8, 4}};
    TURN("nodes", nodes, "%g", 3, 4, 5, 6, 10, 12);
    if (s->spins) {
        TURN("nodes", nodes, "%g", 16);
    }
    for (size_t i = 0; i < (s->spins ? sizeof of / sizeof *of : 2); i++) { /* sections that vary ask for pieces */
        knobs k = s->standard;
        char text[40];
        k.elements = of[i][0], k.nodes = of[i][1];
        snprintf(text, sizeof text, "%d x %d nodes", k.elements, k.nodes);
        add(s, "elements", text, k);
    }
}

static void quadratures(const scene *s) {
    for (int i = 1; i <= 3; i++) {
        knobs k = s->standard;
        char text[40];
        k.rule = s->spins ? SPAR_QUADRATURE_SECTIONS : SPAR_QUADRATURE_GAUSS;
        k.points = s->spins ? i : 4 + 3 * i;
        snprintf(text, sizeof text, s->spins ? "%d a section" : "%d gauss", k.points);
        add(s, "quadrature", text, k);
    }
}

static void couplings(const scene *s) {
    static const char *const names[] = {"explicit", "fixed", "aitken", "iqn"};
    const double tolerances[] = {1e-2, 1e-4, 1e-6};
    for (int scheme = 0; scheme < 4; scheme++) {
        for (int t = 0; t < (scheme ? 3 : 1); t++) {
            knobs k = s->standard;
            char text[40];
            k.scheme = scheme, k.tolerance = tolerances[t];
            snprintf(text, sizeof text, scheme ? "%s %.0e" : "%s", names[scheme], tolerances[t]);
            add(s, "coupling", text, k);
        }
    }
    for (int i = 2; i <= 4; i *= 2) { /* is it the coupling that a long step fails by? */
        knobs k = s->standard;
        char text[40];
        k.scheme = SPAR_COUPLING_IQN_ILS, k.tolerance = 1e-4, k.dt *= i;
        snprintf(text, sizeof text, "iqn 1e-04 dt %g", k.dt);
        add(s, "coupling", text, k);
    }
}

/* An added mass that is known beforehand, right and wrong, or learned in ten steps: explicit, and iterated. */
static void guesses(const scene *s) {
    static const struct {
        double guess;
        int scheme, predictor;
        const char *name;
        int learn;
    } all[] = {{0.5, SPAR_COUPLING_EXPLICIT, 0, "half explicit predictor 0", 0},
               {0.8, SPAR_COUPLING_EXPLICIT, 1, "0.8 explicit", 0},
               {1, SPAR_COUPLING_EXPLICIT, 0, "right explicit predictor 0", 0},
               {1, SPAR_COUPLING_EXPLICIT, 1, "right explicit", 0},
               {1, SPAR_COUPLING_EXPLICIT, 2, "right explicit predictor 2", 0},
               {2, SPAR_COUPLING_EXPLICIT, 1, "twice explicit", 0},
               {0.5, SPAR_COUPLING_FIXED_POINT, 1, "half fixed point", 0},
               {1, SPAR_COUPLING_FIXED_POINT, 1, "right fixed point", 0},
               {2, SPAR_COUPLING_FIXED_POINT, 1, "twice fixed point", 0},
               {0.5, SPAR_COUPLING_IQN_ILS, 1, "half iqn", 0},
               {1, SPAR_COUPLING_IQN_ILS, 1, "right iqn", 0},
               {2, SPAR_COUPLING_IQN_ILS, 1, "twice iqn", 0},
               {0, SPAR_COUPLING_EXPLICIT, 0, "learned explicit predictor 0", 10},
               {0, SPAR_COUPLING_EXPLICIT, 1, "learned explicit", 10},
               {0, SPAR_COUPLING_EXPLICIT, 2, "learned explicit predictor 2", 10},
               {0, SPAR_COUPLING_FIXED_POINT, 1, "learned fixed point", 10},
               {0, SPAR_COUPLING_IQN_ILS, 1, "learned iqn", 10}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        knobs k = s->standard;
        k.guess = all[i].guess, k.scheme = all[i].scheme, k.predictor = all[i].predictor, k.learn = all[i].learn;
        add(s, "added mass", all[i].name, k);
    }
}

/* Single precision at the edge; where the coupling is iterated, how tight that can be. */
static void singles(const scene *s) {
    TAKE("f32", single, 1, "f32");
    for (int i = 2; i <= 7 && s->standard.scheme != SPAR_COUPLING_EXPLICIT; i++) {
        for (int acceleration = 0; acceleration < 2; acceleration++) {
            knobs k = s->standard;
            char text[40];
            k.single = 1, k.tolerance = pow(10, -i), k.acceleration = acceleration;
            snprintf(text, sizeof text, "f32 %siqn %.0e", acceleration ? "" : "differences ", k.tolerance);
            add(s, "f32", text, k);
        }
    }
}

static void effects(const scene *s) {
    static const struct {
        const char *name;
        int bit;
    } all[] = {{"no inertia", SPAR_EFFECT_INERTIA},
               {"no gyroscopic", SPAR_EFFECT_GYROSCOPIC},
               {"no gravity", SPAR_EFFECT_GRAVITY},
               {"no damping", SPAR_EFFECT_DAMPING},
               {"no moment", SPAR_EFFECT_FLUID_MOMENT}},
      aero[] = {{"no induction", SPAR_AERO_INDUCTION}, {"no tip loss", SPAR_AERO_TIP_LOSS},
                {"no hub loss", SPAR_AERO_HUB_LOSS},   {"no swirl", SPAR_AERO_SWIRL},
                {"no drag", SPAR_AERO_DRAG},           {"no pitching", SPAR_AERO_MOMENT}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        knobs k = s->standard;
        k.effects = SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING |
                    SPAR_EFFECT_FLUID_MOMENT;
        k.effects &= ~all[i].bit;
        add(s, "effects", all[i].name, k);
    }
    if (s->floats) {
        TAKE("effects", effects, SPAR_EFFECT_INERTIA, "inertia alone");
    }
    for (size_t i = 0; i < sizeof aero / sizeof *aero && s->spins; i++) {
        knobs k = s->standard;
        k.aero = 63 & ~aero[i].bit;
        add(s, "effects", aero[i].name, k);
    }
}

static void fidelities(const scene *s) {
    static const char *const names[] = {"prescribed", "rigid", "linear"};
    for (int fidelity = s->floats; fidelity < 3; fidelity++) {
        knobs k = s->standard;
        k.fidelity = fidelity;
        add(s, "fidelity", names[fidelity], k);
    }
    for (int64_t modes = 2; modes <= 16 && !s->floats; modes *= 2) {
        knobs k = s->standard;
        char text[40];
        k.fidelity = SPAR_FIDELITY_MODAL, k.modes = modes;
        snprintf(text, sizeof text, "%d modes", (int)modes);
        add(s, "fidelity", text, k);
    }
}

/* Several knobs at once, over dt: what the single ones suggest. */
static void together(const scene *s) {
    static const double factor[] = {0.25, 0.5, 1, 2};
    enum { NEWTON, PREDICTOR, LEAN, LEAN_ELEMENTS, LEAN_MODAL, RIGID };
    static const char *const names[] = {"newton 1e-6", "predictor 2", "lean", "lean 3 x 6", "lean/modal", "rigid"};
    for (int kind = NEWTON; kind <= RIGID; kind++) {
        if ((kind == LEAN_ELEMENTS && !s->spins) || (kind == (s->floats ? LEAN_MODAL : RIGID))) {
            continue;
        }
        for (size_t i = 0; i < sizeof factor / sizeof *factor; i++) {
            knobs k = s->standard;
            char text[40];
            k.dt *= factor[i];
            k.newton = 1e-6;
            k.predictor = kind == PREDICTOR ? 2 : k.predictor;
            if (kind > PREDICTOR) { /* fewer nodes and points, the coupling no tighter than the step */
                k.nodes = 6, k.elements = kind == LEAN_ELEMENTS ? 3 : 1;
                k.rule = s->spins ? SPAR_QUADRATURE_SECTIONS : -1, k.points = 1;
                k.tolerance = 1e-2;
            }
            if (kind == LEAN_MODAL) {
                k.fidelity = SPAR_FIDELITY_MODAL, k.modes = 8;
            }
            if (kind == RIGID || (kind == PREDICTOR && s->floats)) {
                k.fidelity = SPAR_FIDELITY_RIGID;
            }
            snprintf(text, sizeof text, "%s%s dt %g",
                     k.fidelity == SPAR_FIDELITY_RIGID && kind != RIGID ? "rigid " : "", names[kind], k.dt);
            add(s, "together", text, k);
        }
    }
}

static void settings_of(const scene *s) {
    const double d = s->standard.dt;
    add(s, "default", "default", s->standard); /* the first of its scene: benchmarks/run takes it so */
    TURN("dt", dt, "%g", d / 4, d / 2, d * 2, d * 4);
    meshes(s);
    quadratures(s);
    TURN("rho", rho, "%g", 0, 0.5, 1);
    TURN("substeps", substeps, "%g", 2, 4);
    TURN("newton", newton, "%.0e", 1e-3, 1e-5, 1e-6, 1e-8, 1e-10);
    TURN("predictor", predictor, "%g", 0, 2);
    TURN("theta", theta, "%g", 0, 0.5);
    TAKE("start", start, 0, "no loads at t = 0");
    TAKE("consistent", consistent, SPAR_INTERPOLATE_CONSISTENT, "consistent");
    if (s->nodes) {
        TAKE("projection", projection, SPAR_PROJECT_RPOLY, "rpoly");
    }
    if (s->standard.scheme != SPAR_COUPLING_EXPLICIT) {
        TAKE("acceleration", acceleration, 0, "differences of velocities");
        guesses(s);
    }
    singles(s);
    couplings(s);
    effects(s);
    fidelities(s);
    together(s);
}

/* ---- errors and times ---- */

static int play(int i, scene_result *result) {
    scene_run *run;
    int status = scene_build(list[i].scene, &list[i].knobs, &run);
    status = status == SPAR_OK ? scene_march(run, result) : status;
    if (status != SPAR_OK && getenv("SPAR_ACCURACY_VERBOSE")) {
        fprintf(stderr, "\n%s\n", spar_session_message(run ? run->session : NULL));
    }
    scene_destroy(&run);
    return status;
}

/* The least time of a few runs. */
static int repeat(int i, int times, scene_result *result) {
    double least = INFINITY;
    int status = SPAR_OK;
    for (int n = 0; n < times && status == SPAR_OK; n++) {
        status = play(i, result);
        least = fmin(least, result->seconds);
    }
    result->seconds = least;
    return status;
}

/* Where a scene begins: as it is, or elsewhere. */
static double phase_of(int p) {
    return 0.9 * p;
}

/* The references, one to a phase, and how far a coarser one on other nodes is from the first: an upper estimate of its
   own error. */
static int converge(const scene *s, int full, int phases, scene_reference *reference, double *own) {
    scene_reference coarse;
    const double refine = full ? 64 : 32;
    int status = SPAR_OK, elements = s->spins ? 8 : 1, nodes = s->spins ? 8 : 18;
    for (int p = 0; p < phases && status == SPAR_OK; p++) {
        fprintf(stderr, "\r     %-7s reference %d of %d%30s", s->name, p + 1, phases, "");
        status = scene_converge_at(s, phase_of(p), p ? refine / 2 : refine, elements, nodes, &reference[p]);
    }
    status = status == SPAR_OK ? scene_converge(s, refine / 2, 1, 24, &coarse) : status;
    if (status != SPAR_OK) {
        fprintf(stderr, "\n%s: the reference fails: %s\n", s->name, spar_status_text(status));
        return 1;
    }
    *own = scene_distance(reference->history, coarse.history) / reference->scale;
    return 0;
}

typedef struct errors {
    double motion, load, least, most; /* the last two over phases, of the motion */
} errors;

/* A setting that fails in one phase fails. */
static int errors_of(int i, int full, int phases, const scene_reference *reference, scene_result *r, errors *e) {
    int status = repeat(i, full ? 5 : 3, r);
    *e = (errors){0};
    if (status == SPAR_OK) {
        e->motion = e->least = e->most = scene_error(reference, r);
        e->load = scene_load_error(reference, r);
    }
    for (int p = 1; p < phases && status == SPAR_OK; p++) {
        scene_result other;
        list[i].knobs.phase = phase_of(p);
        status = play(i, &other);
        list[i].knobs.phase = 0;
        double error = status == SPAR_OK ? scene_error(&reference[p], &other) : 0;
        e->least = fmin(e->least, error), e->most = fmax(e->most, error);
    }
    return status;
}

static int measure(const char *only, int full, int phases, FILE *csv) {
    scene_reference reference[PHASES_MAX];
    scene_result r;
    double own = 0, standard = 1;
    const scene *s = NULL;
    fprintf(csv, "index,scene,knob,value,error,time ratio,iterations per step,steps,note,load error,least,most\n");
    for (int i = 0; i < count; i++) {
        const setting *at = &list[i];
        errors e;
        if (only && strcmp(only, at->scene->name) != 0) {
            continue;
        }
        if (at->scene != s) {
            s = at->scene;
            if (converge(s, full, phases, reference, &own) || repeat(i, 5, &r) != SPAR_OK) {
                return 1;
            }
            standard = r.seconds;
            fprintf(csv, ",%s,reference,own error,%.2e,,,,,,,\n", s->name, own);
        }
        fprintf(stderr, "\r%4d of %d %-7s %-12s %-24s", i + 1, count, s->name, at->knob, at->value);
        fprintf(csv, "%d,%s,%s,%s,", i, s->name, at->knob, at->value);
        if (errors_of(i, full, phases, reference, &r, &e) == SPAR_OK) {
            fprintf(csv, "%.4e,%.4f,%.3f,%lld,%s,%.4e,%.4e,%.4e\n", e.motion, r.seconds / standard,
                    (double)r.iterations / (double)r.steps, (long long)r.steps,
                    e.motion < own ? "below the reference's error" : "", e.load, e.least, e.most);
        } else {
            fprintf(csv, ",,,,fails,,,\n");
        }
        fflush(csv);
    }
    return 0;
}

/* ---- instructions ---- */

#ifdef COUNTS
/* The building of a scene is counted too, and thrown away. */
static void count_steps(int i) {
    char label[16];
    scene_run *run;
    scene_result result;
    int status = scene_build(list[i].scene, &list[i].knobs, &run);
    snprintf(label, sizeof label, "%d", i);
    CALLGRIND_ZERO_STATS;
    status = status == SPAR_OK ? scene_march(run, &result) : status;
    if (status == SPAR_OK) {
        CALLGRIND_DUMP_STATS_AT(label);
    }
    scene_destroy(&run);
}

static int counted(const setting *at, int full) {
    static const char *const some[] = {"default", "fidelity", "together"};
    int among = strcmp(at->knob, "newton") == 0;
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        among |= strcmp(at->knob, some[i]) == 0;
    }
    return full || (among && at->knobs.dt == at->scene->standard.dt);
}
#endif

static int count_all(const char *only, int full) {
#ifdef COUNTS
    for (int i = 0; i < count && RUNNING_ON_VALGRIND; i++) {
        if ((!only || strcmp(only, list[i].scene->name) == 0) && counted(&list[i], full)) {
            count_steps(i);
        }
    }
    if (RUNNING_ON_VALGRIND) {
        return 0;
    }
#endif
    (void)only, (void)full;
    fprintf(stderr, "accuracy: --count needs valgrind --tool=callgrind, and its header when this was built\n");
    return 1;
}

int main(int argc, char **argv) {
    const char *out = "accuracy.csv", *only = NULL;
    int full = 0, counting = 0, phases = 1;
    for (int i = 1; i < argc; i++) {
        full |= strcmp(argv[i], "--full") == 0;
        out = strcmp(argv[i], "--out") == 0 && i + 1 < argc ? argv[++i] : out;
        only = strcmp(argv[i], "--scene") == 0 && i + 1 < argc ? argv[++i] : only;
        phases = strcmp(argv[i], "--phases") == 0 && i + 1 < argc ? atoi(argv[++i]) : phases;
        counting |= strcmp(argv[i], "--count") == 0;
    }
    if (phases < 1 || phases > PHASES_MAX) {
        fprintf(stderr, "accuracy: --phases 1 to %d\n", PHASES_MAX);
        return 2;
    }
    for (int i = 0; i < SCENE_COUNT; i++) {
        settings_of(&scenes[i]);
    }
    if (counting) {
        int failed = count_all(only, full);
        scenes_free();
        return failed;
    }
    FILE *csv = fopen(out, "w");
    if (!csv) {
        perror(out);
        return 1;
    }
    clock_t since = clock();
    int failed = measure(only, full, phases, csv);
    failed |= fclose(csv) != 0;
    scenes_free();
    fprintf(stderr, "\r%.0f s of processor time; %s%40s\n", (double)(clock() - since) / CLOCKS_PER_SEC, out, "");
    return failed;
}
