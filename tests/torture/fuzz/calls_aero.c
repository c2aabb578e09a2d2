/* The calls on polars and blade elements. */
#include "fuzz.h"

#include <limits.h>
#include <stdio.h>

static const double pi = 3.14159265358979323846;

void do_spar_polar_create(call *c) {
    int k = 0;
    while (k < POLARS && c->w->polar[k]) {
        k++;
    }
    if (k == POLARS) {
        return;
    }
    int whole = chance(c, 50);
    int64_t n = arg_count(c, 3, 7), room = length(n);
    double *alpha = arg_rising(c, room, whole ? -pi : -0.4, whole ? pi : 0.5), *cl = arg_reals(c, room, -1, 1.2),
           *cd = arg_reals(c, room, 0.01, 0.1), *cm = arg_reals_or_null(c, room, -0.1, 0.1);
    double *tables[] = {cl, cd, cm};
    for (int i = 0; whole && room > 1 && i < 3 && !odd(c); i++) {
        if (tables[i]) {
            tables[i][room - 1] = tables[i][0];
        }
    }
    spar_polar *p = NULL;
    int nowhere = odd(c);
    text(c, nowhere ? ", NULL" : ", &p%d", k);
    RUN(c, spar_polar_create(n, alpha, cl, cd, cm, nowhere ? NULL : &p));
    if ((c->status == SPAR_OK) != (p != NULL)) {
        fuzz_finding("handle", "%s answers %d and %s a handle", c->what->name, c->status, p ? "writes" : "writes no");
    }
    c->w->polar[k] = p;
    c->w->absurd |= p && c->wild;
}

void do_spar_polar_set_interpolation(call *c) {
    spar_polar *p = arg_polar(c);
    int kind = arg_int(c, SPAR_POLAR_LINEAR, SPAR_POLAR_CUBIC);
    RUN(c, spar_polar_set_interpolation(p, kind));
}

void do_spar_polar_evaluate(call *c) {
    const spar_polar *p = arg_polar(c);
    double alpha = arg_real(c, -4, 4), *cl = OUT_OR_NULL(c, 1), *cd = OUT_OR_NULL(c, 1), *cm = OUT_OR_NULL(c, 1);
    RUN(c, spar_polar_evaluate(p, alpha, cl, cd, cm));
}

void do_spar_polar_destroy(call *c) {
    int k = below(c, POLARS), nowhere = odd(c);
    text(c, nowhere ? "NULL" : "&p%d", k);
    RUN_VOID(c, spar_polar_destroy(nowhere ? NULL : &c->w->polar[k]));
}

/* Blades of one session mostly; then they are one fluid's and its like. */
static int pick_blades(call *c, int blades, int *index, spar_fluid **sections) {
    world *w = c->w;
    int first = below(c, FLUIDS), found = 0, session = -1, mixed = odd(c);
    int64_t n = 0;
    for (int k = 0; k < FLUIDS && found < blades; k++) {
        live_fluid *f = w->fluid + (first + k) % FLUIDS;
        int64_t m = fluid_count(f, SPAR_NODES_MOTION);
        if (!f->f || (!mixed && (m < 2 || fluid_count(f, SPAR_NODES_FORCE) != m || (found > 0 && m != n))) ||
            (!mixed && session >= 0 && session != f->session)) {
            continue;
        }
        session = session < 0 ? f->session : session;
        n = m;
        index[found] = (int)(f - w->fluid);
        sections[found++] = f->f;
        text(c, found > 1 ? ", f%d" : ", {f%d", (int)(f - w->fluid));
    }
    c->session = session;
    c->where[c->asked++] = session >= 0 ? w->session[session].s : NULL;
    return found;
}

void do_spar_aero_create(call *c) {
    live_aero *at = NULL;
    for (int i = 0; i < AEROS && !at; i++) {
        at = c->w->aero[i].a ? NULL : c->w->aero + i;
    }
    if (!at) {
        return;
    }
    int index[BLADES] = {-1, -1, -1}, wanted = chance(c, 5) ? 0 : 1 + below(c, BLADES);
    spar_fluid *sections[BLADES] = {NULL};
    int found = pick_blades(c, wanted, index, sections);
    int blades = odd(c) ? -1 - below(c, 3) : odd(c) && found < BLADES ? found + 1 : found;
    spar_aero *a = NULL;
    int nowhere = odd(c), none = odd(c);
    if (c->where[0]) {
        c->where[c->asked++] = NULL; /* a message before there is a session */
    }
    text(c, "}, %d%s%s", blades, none ? " (NULL)" : "", nowhere ? ", NULL" : "");
    RUN(c, spar_aero_create(blades, none ? NULL : sections, nowhere ? NULL : &a));
    if ((c->status == SPAR_OK) != (a != NULL)) {
        fuzz_finding("handle", "%s answers %d and %s a handle", c->what->name, c->status, a ? "writes" : "writes no");
    }
    if (a) {
        *at = (live_aero){.a = a, .session = blades > 0 ? c->session : -1, .blades = blades, .made = ++c->w->clock};
        at->n = blades > 0 ? fluid_count(c->w->fluid + index[0], SPAR_NODES_MOTION) : 0;
        for (int b = 0; b < BLADES; b++) {
            at->fluid[b] = index[b];
        }
    }
}

void do_spar_aero_destroy(call *c) {
    live_aero *a = arg_aero(c);
    c->asked = 0;
    c->session = -1;
    if (!a->a || a->busy) {
        RUN_VOID(c, spar_aero_destroy(NULL));
        return;
    }
    RUN_VOID(c, spar_aero_destroy(&a->a));
}

/* AeroDyn's files; now and then ones that are not there, or not what they should be. */
static void pick_files(call *c, const char **primary, const char **blade) {
    static const char *const files[] = {SPAR_SOURCE_DIR "/tests/data/aerodyn/primary.dat",
                                        SPAR_SOURCE_DIR "/tests/data/aerodyn/blade.dat",
                                        SPAR_SOURCE_DIR "/tests/data/aerodyn/DU40_A17.dat", "nowhere.dat"};
    *primary = odd(c) ? NULL : files[odd(c) ? below(c, 4) : 0];
    *blade = chance(c, 60) ? NULL : files[odd(c) ? below(c, 4) : 1];
    text(c, ", %s, %s", *primary ? *primary : "NULL", *blade ? *blade : "NULL");
}

void do_spar_fluid_read_aerodyn(call *c) {
    live_fluid *f = arg_fluid(c);
    const char *primary, *blade;
    pick_files(c, &primary, &blade);
    double *q = chance(c, 50) ? NULL : arg_quaternions(c, 1, 1);
    int stations = chance(c, 30);
    int64_t n = stations ? 0 : arg_count(c, 2, 4);
    double *span = stations ? NULL : arg_rising(c, length(n), 0, 61);
    c->wild = 1; /* far from members of a metre */
    RUN(c, spar_fluid_read_aerodyn(f->f, primary, blade, q, n, span));
}

void do_spar_aero_read_aerodyn(call *c) {
    live_aero *a = arg_aero(c);
    const char *primary, *blade;
    if (a->a && a->orphan) {
        return;
    }
    pick_files(c, &primary, &blade);
    double *q = chance(c, 50) ? NULL : arg_quaternions(c, 1, 1);
    int stations = a->a && a->n == 19 ? chance(c, 50) : odd(c);
    double *span = stations ? NULL : arg_rising(c, a->a && a->n > 0 ? a->n : 2, 0, 61);
    c->wild = 1; /* chords of metres */
    RUN(c, spar_aero_read_aerodyn(a->a, primary, blade, q, span));
}

void do_spar_aero_set_section(call *c) {
    live_aero *a = arg_aero(c);
    static const int64_t odds[] = {-1, INT64_MIN, INT64_MAX, 50, INT64_C(1) << 60};
    int64_t i = odd(c) ? odds[below(c, 5)] : below(c, a->a && a->n > 0 ? (int)a->n : 1);
    text(c, ", %lld", (long long)i);
    double chord = arg_real(c, 0.05, 0.3), twist = arg_real(c, -0.3, 0.3);
    const spar_polar *p = arg_polar(c);
    RUN(c, spar_aero_set_section(a->a, i, chord, twist, p));
}

void do_spar_aero_set_rotor(call *c) {
    live_aero *a = arg_aero(c);
    double *hub = arg_reals(c, 3, -0.2, 0.1), *axis = arg_reals(c, 3, -1, 1), inner = arg_real(c, 0, 0.1),
           outer = arg_real(c, 1, 4);
    RUN(c, spar_aero_set_rotor(a->a, hub, axis, inner, outer));
}

void do_spar_aero_set_turn(call *c) {
    live_aero *a = arg_aero(c);
    int turn = odd(c) ? arg_int(c, -2, 2) : chance(c, 50) ? 1 : -1;
    text(c, ", %d", turn);
    RUN(c, spar_aero_set_turn(a->a, turn));
}

void do_spar_aero_set_shear(call *c) {
    live_aero *a = arg_aero(c);
    int law = odd(c) ? arg_int(c, -1, 3) : below(c, 3);
    text(c, ", %d", law);
    double *ground = arg_reals(c, 3, -3, 3), *up = arg_reals(c, 3, -1, 1), height = arg_real(c, 1, 20),
           parameter = arg_real(c, 0, 0.5);
    RUN(c, spar_aero_set_shear(a->a, law, ground, up, height, parameter));
}

void do_spar_aero_set_tower(call *c) {
    live_aero *a = arg_aero(c);
    double *base = arg_reals(c, 3, -3, 3), *top = arg_reals(c, 3, -3, 3), wide = arg_real(c, 0.1, 0.5),
           narrow = arg_real(c, 0.1, 0.5);
    RUN(c, spar_aero_set_tower(a->a, base, top, wide, narrow));
}

void do_spar_aero_set_blades(call *c) {
    live_aero *a = arg_aero(c);
    int total = arg_int(c, 3, 5);
    RUN(c, spar_aero_set_blades(a->a, total));
}

void do_spar_aero_set_effects(call *c) {
    live_aero *a = arg_aero(c);
    if (a->a && a->orphan) {
        return;
    }
    int effects = arg_flags(c, 2 * SPAR_AERO_UNSTEADY - 1);
    RUN(c, spar_aero_set_effects(a->a, effects));
}

void do_spar_aero_solve(call *c) {
    live_aero *a = arg_aero(c);
    if (a->a && a->orphan) {
        return;
    }
    double density = arg_real(c, 1, 1.3), *wind = arg_reals(c, a->a ? 3 * a->blades * a->n : 0, -12, 12),
           theta = chance(c, 80) ? 1 : arg_real(c, 0, 1);
    c->wild |= c->w->absurd;
    RUN(c, spar_aero_solve(a->a, density, wind, theta));
}

static int64_t places(const live_aero *a) {
    return a->a ? a->blades * a->n : 0;
}

void do_spar_aero_get_rotor(call *c) {
    live_aero *a = arg_aero(c);
    double *thrust = OUT_OR_NULL(c, 1), *torque = OUT_OR_NULL(c, 1), *power = OUT_OR_NULL(c, 1);
    RUN(c, spar_aero_get_rotor(a->a, thrust, torque, power));
}

void do_spar_aero_get_sections(call *c) {
    live_aero *a = arg_aero(c);
    int64_t n = places(a);
    double *alpha = OUT_OR_NULL(c, n), *cl = OUT_OR_NULL(c, n), *cd = OUT_OR_NULL(c, n), *ax = OUT_OR_NULL(c, n),
           *at = OUT_OR_NULL(c, n);
    RUN(c, spar_aero_get_sections(a->a, alpha, cl, cd, ax, at));
}

void do_spar_aero_get_chord(call *c) {
    live_aero *a = arg_aero(c);
    double *chord = OUT_OR_NULL(c, places(a)), *twist = OUT_OR_NULL(c, places(a));
    RUN(c, spar_aero_get_chord(a->a, chord, twist));
}

void do_spar_aero_get_flags(call *c) {
    live_aero *a = arg_aero(c);
    int *flags = arg_out(c, places(a) * (int64_t)sizeof(int), 1);
    int64_t *no_root = arg_out(c, sizeof *no_root, 1);
    RUN(c, spar_aero_get_flags(a->a, flags, no_root));
}

void do_spar_aero_get_loads(call *c) {
    live_aero *a = arg_aero(c);
    int64_t n = places(a);
    double *per_length = OUT_OR_NULL(c, 6 * n), *force = OUT_OR_NULL(c, 3 * n), *moment = OUT_OR_NULL(c, 3 * n);
    RUN(c, spar_aero_get_loads(a->a, per_length, force, moment));
}

void do_spar_aero_report_effects(call *c) {
    live_aero *a = arg_aero(c);
    live_trial *t = arg_trial(c);
    if (a->a && a->orphan) {
        return;
    }
    c->session = t->t ? t->session : -1;
    a->busy++;
    t->busy++;
    RUN(c, spar_aero_report_effects(a->a, t->t));
    t->busy--;
    a->busy--;
}

void do_spar_aero_get_effect(call *c) {
    live_aero *a = arg_aero(c);
    int row = arg_int(c, 0, SPAR_AERO_ROW_COUNT - 1);
    int *in_force = arg_out(c, sizeof *in_force, 1), *fails = arg_out(c, sizeof *fails, 1);
    double *size = OUT_OR_NULL(c, 1), *motion = OUT_OR_NULL(c, 1), *reaction = OUT_OR_NULL(c, 1),
           *share = OUT_OR_NULL(c, 1);
    RUN(c, spar_aero_get_effect(a->a, row, in_force, fails, size, motion, reaction, share));
}
