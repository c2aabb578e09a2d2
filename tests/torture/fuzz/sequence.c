/* Sequences: a scene that holds together, mostly, then anything. */
#include "fuzz.h"

typedef struct writer {
    uint64_t random;
    record *list;
    int n, room;
} writer;

static int roll(writer *w, int n) {
    return (int)(fuzz_next(&w->random) % (uint64_t)n);
}

static void put(writer *w, int what, int style) {
    if (w->n < w->room) {
        w->list[w->n++] = (record){what, style, fuzz_next(&w->random)};
    }
}

/* Part of a scene: about the latest handle, and good, but for once in a while. */
static void part(writer *w, int percent, int what) {
    if (roll(w, 100) < percent) {
        put(w, what, STYLE_RECENT | (roll(w, 100) < 96 ? STYLE_GOOD : 0));
    }
}

static void settings(writer *w) {
    static const int calls[] = {CALL_spar_session_set_gravity,   CALL_spar_session_set_integrator,
                                CALL_spar_session_set_predictor, CALL_spar_session_set_coupling,
                                CALL_spar_session_set_coupling,  CALL_spar_session_set_option,
                                CALL_spar_session_set_log,       CALL_spar_session_set_relaxation};
    for (int k = roll(w, 5); k > 0; k--) {
        put(w, calls[roll(w, 8)], STYLE_GOOD);
    }
}

static void beam(writer *w) {
    part(w, 100, CALL_spar_beam_create);
    part(w, 97,
         roll(w, 100) < 5    ? CALL_spar_beam_read_beamdyn
         : roll(w, 100) < 70 ? CALL_spar_beam_set_axis
                             : CALL_spar_beam_set_nodes);
    part(w, 98, CALL_spar_beam_set_sections);
    part(w, 50, CALL_spar_member_set_fidelity);
    part(w, 30, CALL_spar_beam_set_damping);
    part(w, 15, CALL_spar_beam_set_mass_damping);
    part(w, 25, CALL_spar_beam_set_masses);
    part(w, 5, CALL_spar_beam_set_foundation);
    part(w, 5, CALL_spar_beam_set_pretension);
    part(w, 15, CALL_spar_beam_set_quadrature);
    part(w, 20, CALL_spar_member_set_added_mass);
    part(w, 20, CALL_spar_member_learn_added_mass);
    part(w, 10, CALL_spar_member_set_added_mass_response);
}

static void fluid(writer *w) {
    part(w, 100, CALL_spar_fluid_create);
    part(w, 15, CALL_spar_fluid_set_projection);
    part(w, 30, CALL_spar_fluid_set_interpolation);
    part(w, 30, CALL_spar_fluid_set_option);
    if (roll(w, 100) < 45) {
        part(w, 100, CALL_spar_fluid_set_stations);
    } else {
        part(w, 95, CALL_spar_fluid_set_motion_nodes);
        part(w, 95, CALL_spar_fluid_set_force_nodes);
    }
    part(w, 98, CALL_spar_fluid_map);
}

static void member(writer *w) {
    int kind = roll(w, 10);
    if (kind < 6) {
        beam(w);
    } else {
        part(w, 100, kind < 8 ? CALL_spar_rigid_create : CALL_spar_point_create);
    }
    part(w, 50, CALL_spar_member_set_root);
    part(w, 25, CALL_spar_member_set_effects);
    part(w, 30, CALL_spar_member_set_placement);
    part(w, 5, CALL_spar_member_set_external);
    part(w, 25, CALL_spar_member_set_initial_velocity);
    part(w, 98, CALL_spar_member_commit);
    part(w, 30, CALL_spar_member_drive);
    part(w, 30, CALL_spar_member_set_load);
    part(w, 20, CALL_spar_beam_set_line_load);
    part(w, 10, CALL_spar_member_get_work);
    for (int k = roll(w, 3); k > 0; k--) {
        fluid(w);
    }
}

static void blades(writer *w) {
    part(w, 100, CALL_spar_polar_create);
    part(w, 100, CALL_spar_aero_create);
    for (int k = 0; k < 8; k++) {
        part(w, 100, CALL_spar_aero_set_section);
    }
    part(w, 10, CALL_spar_aero_read_aerodyn);
    part(w, 60, CALL_spar_aero_set_rotor);
    part(w, 20, CALL_spar_aero_set_effects);
    part(w, 80, CALL_spar_aero_solve);
}

static void step(writer *w) {
    part(w, 10, CALL_spar_session_solve_initial);
    put(w, roll(w, 20) == 0 ? CALL_spar_step_begin_initial : CALL_spar_step_begin, STYLE_GOOD | STYLE_RECENT);
    for (int k = 1 + (roll(w, 4) == 0) * roll(w, 4); k > 0; k--) {
        put(w, CALL_spar_step_solve, STYLE_GOOD | STYLE_RECENT);
        part(w, 50, CALL_spar_fluid_pull_motion);
        part(w, 50, CALL_spar_fluid_push_forces);
        part(w, 20, CALL_spar_aero_solve);
        part(w, 90, CALL_spar_step_check);
    }
    part(w, 80, CALL_spar_step_accept);
    part(w, 10, CALL_spar_session_solve_static);
}

/* Small motions about an equilibrium, which a static solution mostly is. */
static void small_motions(writer *w) {
    part(w, 80, CALL_spar_session_solve_static);
    for (int k = 0; k < 3; k++) {
        part(w, 100, CALL_spar_trial_set_motion);
        part(w, 90, CALL_spar_trial_solve_eigenvalues);
    }
    part(w, 80, CALL_spar_trial_solve_floquet);
}

/* Advice makes hundreds of runs, a report dozens: they are asked for seldom, or all the time is theirs. */
static void what_if(writer *w) {
    int k = roll(w, 1000);
    put(w, CALL_spar_step_reject, STYLE_GOOD | STYLE_RECENT);
    part(w, 100, CALL_spar_trial_create);
    part(w, 98, CALL_spar_trial_set_steps);
    part(w, 90, CALL_spar_trial_set_callbacks);
    part(w, 30, CALL_spar_trial_set_option);
    if (k >= 550 && k < 800) {
        small_motions(w);
        return;
    }
    part(w, 100,
         k < 500   ? CALL_spar_trial_run
         : k < 550 ? CALL_spar_trial_report_effects
         : k < 950 ? CALL_spar_aero_report_effects
                   : CALL_spar_trial_advise);
    part(w, 50,
         k < 500   ? CALL_spar_trial_run
         : k < 550 ? CALL_spar_trial_get_effect
         : k < 950 ? CALL_spar_aero_get_effect
                   : CALL_spar_trial_get_beam);
    if (k >= 950) {
        put(w, CALL_spar_trial_get_settings, STYLE_GOOD | STYLE_RECENT);
        put(w, CALL_spar_trial_get_outcome, STYLE_GOOD | STYLE_RECENT);
        put(w, CALL_spar_trial_get_search, STYLE_GOOD | STYLE_RECENT);
        put(w, CALL_spar_trial_get_beam, STYLE_GOOD | STYLE_RECENT);
    }
    part(w, k < 950 ? 5 : 95, CALL_spar_trial_apply);
    part(w, 50, CALL_spar_step);
}

/* A few saves, as there are a few names; and back, from between steps. */
static void save_and_load(writer *w) {
    for (int k = 0; k < 3; k++) {
        put(w, CALL_spar_session_save, STYLE_GOOD | STYLE_RECENT);
    }
    if (roll(w, 2)) {
        step(w);
    }
    put(w, CALL_spar_step_reject, STYLE_GOOD | STYLE_RECENT);
    put(w, CALL_spar_session_load, STYLE_GOOD | STYLE_RECENT);
}

static int any_call(writer *w) {
    static int total;
    if (total == 0) {
        for (int i = 0; i < CALL_COUNT; i++) {
            total += fuzz_calls[i].weight;
        }
    }
    int at = roll(w, total), i = 0;
    while (at >= fuzz_calls[i].weight) {
        at -= fuzz_calls[i++].weight;
    }
    return i;
}

int fuzz_sequence(uint64_t seed, record *list, int room) {
    writer w = {seed, list, 0, room};
    int sessions = 1 + (roll(&w, 10) < 3) + (roll(&w, 20) == 0), random = 20 + roll(&w, 120);
    for (int k = 0; k < sessions; k++) {
        put(&w, CALL_spar_session_create, STYLE_GOOD);
    }
    settings(&w);
    for (int k = 1 + roll(&w, 3); k > 0; k--) {
        member(&w);
    }
    if (roll(&w, 10) < 4) {
        blades(&w);
    }
    if (roll(&w, 10) < 3) {
        settings(&w);
    }
    for (int k = 0; k < random; k++) {
        if (roll(&w, 15) == 0) {
            step(&w);
        } else if (roll(&w, 200) == 0) {
            member(&w);
        } else if (roll(&w, 200) == 0) {
            fluid(&w);
        } else if (roll(&w, 150) == 0) {
            what_if(&w);
        } else if (roll(&w, 300) == 0) {
            save_and_load(&w);
        } else {
            put(&w, any_call(&w), roll(&w, 2) ? STYLE_GOOD : 0);
        }
    }
    return w.n;
}
