/* What accuracy costs: one knob of a scene is turned at a time, the error against a converged reference and the CPU
   time of the steps (the least of several runs) against the scene's default are written as CSV. accuracy [--full]
   [--out folder] Short form: under two minutes. Progress on stderr. */
#include "scenes.h"

#include <spar/spar_aero.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- turning knobs ---- */

static FILE *csv;
static int full, done;
static scene_reference reference;
static double standard_seconds;

/* The least time of a few runs. */
static int play(const scene *s, const knobs *k, int repeats, scene_result *result) {
    double least = INFINITY;
    int status = SPAR_OK;
    for (int i = 0; i < repeats && status == SPAR_OK; i++) {
        scene_run *run;
        status = scene_build(s, k, &run);
        status = status == SPAR_OK ? scene_march(run, result) : status;
        if (status != SPAR_OK && getenv("SPAR_ACCURACY_VERBOSE")) {
            fprintf(stderr, "\n%s\n", spar_session_message(run ? run->session : NULL));
        }
        scene_destroy(&run);
        least = fmin(least, result->seconds);
    }
    result->seconds = least;
    return status;
}

static void measure(const scene *s, const char *knob, const char *value, knobs k) {
    scene_result r;
    int status = play(s, &k, full ? 5 : 3, &r);
    fprintf(stderr, "\r%4d %-7s %-12s %-16s", ++done, s->name, knob, value);
    if (status != SPAR_OK) {
        fprintf(csv, "%s,%s,%s,,,,fails\n", s->name, knob, value);
        return;
    }
    fprintf(csv, "%s,%s,%s,%.4e,%.4f,%.3f,\n", s->name, knob, value, scene_error(&reference, &r),
            r.seconds / standard_seconds, (double)r.iterations / (double)r.steps);
    fflush(csv);
}

#define TURN(knob, field, format, ...)                                                                                 \
    do {                                                                                                               \
        const double list_[] = {__VA_ARGS__};                                                                          \
        for (size_t i_ = 0; i_ < sizeof list_ / sizeof *list_; i_++) {                                                 \
            knobs k_ = s->standard;                                                                                    \
            char text_[32];                                                                                            \
            k_.field = (__typeof__(k_.field))list_[i_];                                                                \
            snprintf(text_, sizeof text_, format, list_[i_]);                                                          \
            measure(s, knob, text_, k_);                                                                               \
        }                                                                                                              \
    } while (0)

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
        k.effects = 63 & ~all[i].bit;
        measure(s, "effects", all[i].name, k);
    }
    for (size_t i = 0; i < sizeof aero / sizeof *aero && s->spins; i++) {
        knobs k = s->standard;
        k.aero = 63 & ~aero[i].bit;
        measure(s, "effects", aero[i].name, k);
    }
}

static void rungs(const scene *s) {
    static const char *const names[] = {"prescribed", "rigid", "linear"};
    for (int rung = s->floats; rung < 3; rung++) {
        knobs k = s->standard;
        k.rung = rung;
        measure(s, "rung", names[rung], k);
    }
    for (int64_t modes = 2; modes <= 16 && !s->floats; modes *= 2) {
        knobs k = s->standard;
        char text[32];
        k.rung = SPAR_FIDELITY_MODAL, k.modes = modes;
        snprintf(text, sizeof text, "%d modes", (int)modes);
        measure(s, "rung", text, k);
    }
}

static void coupling(const scene *s) {
    static const char *const names[] = {"explicit", "fixed", "aitken", "iqn"};
    const double tolerances[] = {1e-2, 1e-4, 1e-6, 1e-9};
    for (int scheme = 0; scheme < 4; scheme++) {
        for (int t = 0; t < (scheme ? 4 : 1); t++) {
            knobs k = s->standard;
            char text[32];
            k.scheme = scheme, k.tolerance = tolerances[t];
            snprintf(text, sizeof text, scheme ? "%s %.0e" : "%s", names[scheme], tolerances[t]);
            measure(s, "coupling", text, k);
        }
    }
    for (int i = 2; i <= 4; i *= 2) { /* is it the coupling that a long step fails by? */
        knobs k = s->standard;
        char text[32];
        k.scheme = SPAR_COUPLING_IQN_ILS, k.tolerance = 1e-4, k.dt *= i;
        snprintf(text, sizeof text, "iqn 1e-04 dt %g", k.dt);
        measure(s, "coupling", text, k);
    }
}

/* Several knobs at once, over dt: what the single ones suggest. */
static void together(const scene *s) {
    static const double factor[] = {0.25, 0.5, 1, 2};
    static const char *const names[] = {"newton 1e-6", "lean", "lean/modal", "rigid"};
    for (int kind = 0; kind < 4; kind++) {
        if ((kind == 2) == s->floats && kind > 1) {
            continue;
        }
        for (size_t i = 0; i < sizeof factor / sizeof *factor; i++) {
            knobs k = s->standard;
            char text[48];
            k.dt *= factor[i];
            k.newton = 1e-6;
            if (kind > 0) { /* fewer nodes and points, the coupling no tighter than the step */
                k.nodes = 6;
                k.rule = s->spins ? SPAR_QUADRATURE_SECTIONS : -1, k.points = 1;
                k.tolerance = 1e-2;
            }
            if (kind == 2) {
                k.rung = SPAR_FIDELITY_MODAL, k.modes = 8;
            }
            if (kind == 3) {
                k.rung = SPAR_FIDELITY_RIGID;
            }
            snprintf(text, sizeof text, "%s dt %g", names[kind], k.dt);
            measure(s, "together", text, k);
        }
    }
}

static int benchmark(const scene *s) {
    scene_result r;
    fprintf(stderr, "\r%4d %-7s reference            ", done, s->name);
    int status = scene_converge(s, full ? 40 : 16, 14, &reference);
    if (status != SPAR_OK) {
        fprintf(stderr, "\n%s: the reference fails: %s\n", s->name, spar_status_text(status));
        return 1;
    }
    if (play(s, &s->standard, 5, &r) != SPAR_OK) {
        fprintf(stderr, "\n%s: the default fails\n", s->name);
        return 1;
    }
    standard_seconds = r.seconds;
    measure(s, "default", "default", s->standard);
    double d = s->standard.dt;
    TURN("dt", dt, "%g", d / 4, d / 2, d * 2, d * 4);
    TURN("nodes", nodes, "%g", 3, 4, 5, 6, 8, 10, 12);
    TURN("elements", elements, "%g", 1, 2, 3);
    for (int points = 1; points <= 4 && s->spins; points++) {
        knobs k = s->standard;
        char text[32];
        k.rule = SPAR_QUADRATURE_SECTIONS, k.points = points;
        snprintf(text, sizeof text, "%d a section", points);
        measure(s, "quadrature", text, k);
    }
    for (int points = 7; points <= 16 && !s->spins; points += 3) {
        knobs k = s->standard;
        char text[32];
        k.rule = SPAR_QUADRATURE_GAUSS, k.points = points;
        snprintf(text, sizeof text, "%d gauss", points);
        measure(s, "quadrature", text, k);
    }
    TURN("rho", rho, "%g", 0, 0.5, 1);
    TURN("substeps", substeps, "%g", 2, 4);
    TURN("newton", newton, "%g", 1e-3, 1e-6, 1e-9);
    TURN("predictor", predictor, "%g", 0, 1, 2);
    TURN("theta", theta, "%g", 0, 0.5);
    TURN("consistent", consistent, "%g", 1);
    if (s->nodes) {
        TURN("projection", projection, "%g", 1);
        TURN("f32", single, "%g", 1);
    }
    coupling(s);
    effects(s);
    rungs(s);
    together(s);
    return 0;
}

int main(int argc, char **argv) {
    const char *out = "accuracy.csv", *only = NULL;
    for (int i = 1; i < argc; i++) {
        full |= strcmp(argv[i], "--full") == 0;
        out = strcmp(argv[i], "--out") == 0 && i + 1 < argc ? argv[++i] : out;
        only = strcmp(argv[i], "--scene") == 0 && i + 1 < argc ? argv[++i] : only;
    }
    csv = fopen(out, "w");
    if (!csv) {
        perror(out);
        return 1;
    }
    fprintf(csv, "scene,knob,value,error,cost,iterations,note\n");
    int failed = 0;
    clock_t since = clock();
    for (int i = 0; i < SCENE_COUNT; i++) {
        failed |= !only || strcmp(only, scenes[i].name) == 0 ? benchmark(&scenes[i]) : 0;
    }
    fclose(csv);
    scenes_free();
    fprintf(stderr, "\n%d settings in %.0f s; %s\n", done, (double)(clock() - since) / CLOCKS_PER_SEC, out);
    return failed;
}
