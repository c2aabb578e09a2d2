/* What is alive, and what must hold after each call. */
#include "fuzz.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

world fuzz_world;

const description fuzz_calls[CALL_COUNT] = {
#define FUZZ_ROW(name, weight, flags) {#name, do_##name, weight, flags},
    FUZZ_CALLS(FUZZ_ROW)
#undef FUZZ_ROW
};

/* ---- what can be seen of a session ---- */

enum { SEEN = 24 * 64 * 8 };
static double seen[SEEN];
static int64_t seen_index[64];
static int seen_flags[64];

static void add(uint64_t *h, const void *data, size_t bytes) {
    const unsigned char *p = data;
    uint64_t x = *h, part;
    for (; bytes >= sizeof part; bytes -= sizeof part, p += sizeof part) {
        memcpy(&part, p, sizeof part);
        x = (x ^ part) * UINT64_C(0x9e3779b97f4a7c15);
        x ^= x >> 29;
    }
    for (; bytes > 0; bytes--, p++) {
        x = (x ^ *p) * UINT64_C(1099511628211);
    }
    *h = x;
}

/* The status of a getter and what it gave. */
static void add_seen(uint64_t *h, int status, int64_t n) {
    add(h, &status, sizeof status);
    if (status == SPAR_OK && n > 0) {
        add(h, seen, (size_t)n * sizeof *seen);
    }
}

static void see_member(const live_member *m, uint64_t *h) {
    int64_t n = nodes_of(m);
    add(h, &n, sizeof n);
    if (!m->committed || n > 64) {
        return;
    }
    add_seen(h, spar_member_get_reference(m->m, seen, seen + 3 * n), 7 * n);
    add_seen(h, spar_member_get_motion(m->m, seen, seen + 7 * n, seen + 13 * n), 19 * n);
    add_seen(h, spar_member_get_loads(m->m, seen), 6 * n);
    add_seen(h, spar_member_get_reaction(m->m, seen), 6);
    add_seen(h, spar_member_get_energy(m->m, 4, seen), 4);
    if (m->kind == KIND_BEAM) {
        const double eta[2] = {0.3, 1};
        add_seen(h, spar_beam_evaluate(m->m, 2, eta, seen, NULL, seen + 12, seen + 18), 26);
    }
}

static void see_fluid(const live_fluid *f, uint64_t *h, uint64_t *of_last_push) {
    for (int which = 0; which < 2; which++) {
        int64_t n = fluid_count(f, which);
        add(h, &n, sizeof n);
        if (n == 0 || n > 64) {
            continue;
        }
        int status = spar_fluid_get_map(f->f, which, seen, seen + n, seen_flags);
        add_seen(h, status, 2 * n);
        if (status == SPAR_OK) {
            add(h, seen_flags, (size_t)n * sizeof *seen_flags);
            add_seen(h, spar_fluid_get_nearest(f->f, which, seen, seen + 3 * n, seen + 7 * n), 10 * n);
            add_seen(h, spar_fluid_get_basis(f->f, which, seen_index, NULL), 0);
            add(h, seen_index, (size_t)n * sizeof *seen_index);
        }
        if (status == SPAR_OK && which == SPAR_NODES_MOTION) {
            add_seen(h, spar_fluid_get_positions(f->f, which, seen, NULL, seen + 3 * n, NULL), 6 * n);
        }
    }
    add_seen(of_last_push, spar_fluid_get_audit(f->f, 8, seen), 8);
}

static void see_aero(const live_aero *a, uint64_t *h) {
    int64_t n = a->blades * a->n, no_root = 0;
    if (n > 64) {
        return;
    }
    add_seen(h, spar_aero_get_rotor(a->a, seen, seen + 1, seen + 2), 3);
    add_seen(h, spar_aero_get_sections(a->a, seen, seen + n, seen + 2 * n, seen + 3 * n, seen + 4 * n), 5 * n);
    add_seen(h, spar_aero_get_loads(a->a, seen, seen + 6 * n, seen + 9 * n), 12 * n);
    if (n > 0) {
        add_seen(h, spar_aero_get_chord(a->a, seen, seen + a->n), 2 * a->n);
    }
    if (spar_aero_get_flags(a->a, seen_flags, &no_root) == SPAR_OK) {
        add(h, seen_flags, (size_t)n * sizeof *seen_flags);
        add(h, &no_root, sizeof no_root);
    }
}

void fuzz_digest(world *w, int session, uint64_t digest[3]) {
    const live_session *s = w->session + session;
    w->quiet++;
    memset(digest, 0, 3 * sizeof *digest);
    int64_t step = 0;
    int iteration = 0;
    int status = spar_session_get_time(s->s, seen, &step, &iteration);
    add_seen(digest, status, 1);
    add(digest, &step, sizeof step);
    for (int i = 0; i < MEMBERS; i++) {
        if (w->member[i].m && w->member[i].session == session) {
            see_member(w->member + i, digest);
        }
    }
    for (int i = 0; i < JOINTS; i++) {
        if (w->joint[i].j && w->joint[i].session == session) {
            (void)spar_joint_get_motion(w->joint[i].j, seen, seen + 6, NULL);
            add_seen(digest, spar_joint_get_load(w->joint[i].j, seen + 12), 18);
        }
    }
    for (int i = 0; i < FLUIDS; i++) {
        if (w->fluid[i].f && w->fluid[i].session == session) {
            see_fluid(w->fluid + i, digest, digest + 1);
        }
    }
    add(digest + 1, &iteration, sizeof iteration);
    memset(seen, 0, 256 * sizeof *seen);
    status = spar_session_get_iterations(s->s, &iteration, 120, seen + 8, seen + 128);
    status = status == SPAR_OK ? spar_session_get_report(s->s, 8, seen) : status;
    add_seen(digest + 1, status, 256);
    add(digest + 1, &iteration, sizeof iteration);
    for (int i = 0; i < AEROS; i++) {
        if (w->aero[i].a && w->aero[i].session == session) {
            see_aero(w->aero + i, digest + 2);
        }
    }
    w->quiet--;
}

/* ---- before and after a call ---- */

static const char *mark_of(const spar_session *s) {
    return s ? "spar_session_set_predictor: " : "spar_session_create_fcomm: ";
}

/* A message of another call in all places where this one may leave its own: it must come from it. */
static void put_marks(call *c) {
    c->w->quiet++;
    for (int i = 0; i < c->asked; i++) {
        if (c->where[i]) {
            (void)spar_session_set_predictor((spar_session *)(uintptr_t)c->where[i], -1);
        } else {
            (void)spar_session_create_fcomm(-1, NULL);
        }
    }
    (void)spar_session_create_fcomm(-1, NULL);
    c->w->quiet--;
}

void fuzz_before(call *c) {
    if (c->asked == 0) {
        c->where[c->asked++] = NULL;
    }
    c->w->failures += c->watched && c->w->depth > 0; /* what is asked in between leaves messages */
    c->taint = c->w->taint;
    c->failures = c->w->failures;
    if (c->watched && c->session >= 0) {
        fuzz_digest(c->w, c->session, c->before);
    }
    if (c->watched) {
        put_marks(c);
    }
    if (c->session >= 0) {
        c->w->session[c->session].busy++;
    }
    if (c->w->verbose) {
        fuzz_say("%*s%s(%s)", 4 * c->w->depth, "", c->what->name, c->text);
    }
}

/* What the call has left, not what was there for it. */
static const char *message_of(const call *c) {
    for (int i = 0; i < c->asked; i++) {
        const char *message = spar_session_message(c->where[i]);
        if (strncmp(message, mark_of(c->where[i]), strlen(mark_of(c->where[i]))) != 0) {
            return message;
        }
    }
    return spar_session_message(c->where[0]);
}

/* The call, or that of its parts that failed: a step's, a trial's. */
static int names(const call *c, const char *message) {
    int trial = (c->what->flags & FUZZ_TRIAL) != 0;
    return strstr(message, c->what->name) ||
           ((c->index == CALL_spar_step || c->index == CALL_spar_step_adaptive) && strstr(message, "spar_step_")) ||
           (trial && (strstr(message, "spar_step") || strstr(message, "spar_trial_run")));
}

/* So many characters twice in a message: the same said twice. An earlier failure may be of the same member. */
static int says_twice(const char *text) {
    enum { PIECE = 40 };
    const char *earlier = strstr(text, "; an earlier failure: ");
    int64_t n = earlier ? earlier - text : (int64_t)strlen(text);
    for (int64_t i = 0; i + 2 * PIECE <= n; i++) {
        for (int64_t j = i + PIECE; j + PIECE <= n; j++) {
            if (memcmp(text + i, text + j, PIECE) == 0 && memcmp(text + i, text + i + 1, PIECE - 1) != 0) {
                return 1; /* a long name is one letter many times */
            }
        }
    }
    return 0;
}

static void check_message(const call *c) {
    if (says_twice(message_of(c))) {
        fuzz_finding("twice", "%s answers %d, and the message says something twice: '%s'", c->what->name, c->status,
                     message_of(c));
    }
    for (int i = 0; i < c->asked; i++) {
        if (names(c, spar_session_message(c->where[i]))) {
            return;
        }
    }
    fuzz_finding("message", "%s answers %d, and the message is '%s'", c->what->name, c->status, message_of(c));
}

static void check_mark(const call *c) {
    for (int i = 0; i < c->asked; i++) {
        const char *message = spar_session_message(c->where[i]);
        if (strncmp(message, mark_of(c->where[i]), strlen(mark_of(c->where[i]))) != 0) {
            fuzz_finding("message", "%s succeeds, and the message of an earlier failure has become '%s'", c->what->name,
                         message);
        }
    }
}

/* Within a step a failure may have moved the iterate; a failed spar_step or static solution has made iterations. */
static void check_state(const call *c) {
    static const char *const part[3] = {"state", "report of coupling or audit", "blade element's results"};
    int flags = c->what->flags, parts[3] = {1, 1, 1};
    if (c->status == SPAR_OK && !(flags & (FUZZ_PURE | FUZZ_TRIAL))) {
        return;
    }
    if (c->status != SPAR_OK && c->status != SPAR_ERR_ARGUMENT && c->status != SPAR_ERR_STATE) {
        if (c->index == CALL_spar_step_solve || c->index == CALL_spar_step_check) {
            return;
        }
        parts[2] = c->index != CALL_spar_aero_solve;
    }
    if (c->index == CALL_spar_step || c->index == CALL_spar_step_adaptive ||
        c->index == CALL_spar_session_solve_initial || c->index == CALL_spar_session_solve_static) {
        parts[1] = parts[2] = 0;
    }
    parts[2] = parts[2] && !(flags & FUZZ_TRIAL);
    if (c->w->taint != c->taint) {
        return;
    }
    uint64_t now[3];
    char said[300] = "";
    if (c->status != SPAR_OK) {
        (void)snprintf(said, sizeof said, "%s", message_of(c));
    }
    fuzz_digest(c->w, c->session, now);
    for (int i = 0; i < 3; i++) {
        if (parts[i] && now[i] != c->before[i]) {
            fuzz_finding("state", "%s answers %d (%s), and the %s of s%d is another", c->what->name, c->status, said,
                         part[i], c->session);
        }
    }
}

/* The injected fault: three calls in this order. */
static void check_fault(const call *c) {
    int *at = &c->w->fault;
    *at += *at == 1 && c->index == CALL_spar_fluid_map && c->status == SPAR_OK;
    *at += *at == 2 && c->index == CALL_spar_session_set_predictor && c->status == SPAR_ERR_ARGUMENT;
    *at += *at == 3 && c->index == CALL_spar_step_accept && c->status == SPAR_OK;
    if (*at == 4) {
        fuzz_finding("injected", "a node was mapped, a predictor refused, a step accepted");
    }
}

void fuzz_after(call *c, int status) {
    world *w = c->w;
    c->status = status;
    if (c->session >= 0) {
        w->session[c->session].busy--;
    }
    if (w->verbose) {
        fuzz_say("%*s= %d%s%s", 4 * w->depth + 2, "", status, status ? " " : "", status ? message_of(c) : "");
    }
    if (status < SPAR_OK || status > SPAR_ERR_LIMIT) {
        fuzz_finding("status", "%s answers %d", c->what->name, status);
    }
    fuzz_count(c->index, status);
    if (status != SPAR_OK) {
        check_message(c);
        w->failures++;
    } else if (c->watched && !(c->what->flags & FUZZ_TEXT) && w->failures == c->failures) {
        check_mark(c);
    }
    if (c->watched && c->session >= 0) {
        check_state(c);
    }
    if (status == SPAR_OK && w->depth > 0 && !(c->what->flags & (FUZZ_PURE | FUZZ_TRIAL | FUZZ_PUSH))) {
        w->taint++;
    }
    if (status == SPAR_OK && c->session >= 0 && c->wild) {
        w->session[c->session].wild = 1;
    }
    check_fault(c);
}

void fuzz_run(world *w, const record *r) {
    call c;
    c.w = w;
    c.index = r->call;
    c.what = fuzz_calls + r->call;
    c.random = r->seed;
    c.style = r->style;
    c.held = c.asked = c.wild = 0;
    c.session = -1;
    c.used = 0;
    c.text[0] = '\0';
    c.odds = 0;
    if (!(r->style & STYLE_GOOD)) {
        c.odds = chance(&c, 60) ? 0 : chance(&c, 80) ? 40 : 128;
    }
    c.watched = !(c.what->flags & FUZZ_HARNESS) && chance(&c, 30);
    c.what->run(&c);
    for (int i = 0; i < c.held; i++) {
        free(c.hold[i]);
    }
}

/* ---- a whole life ---- */

void fuzz_world_begin(world *w, int verbose) {
    char folder[sizeof w->folder];
    int fault = w->fault > 0;
    memcpy(folder, w->folder, sizeof folder);
    memset(w, 0, sizeof *w);
    memcpy(w->folder, folder, sizeof folder);
    w->verbose = verbose;
    w->fault = fault;
}

static void must(world *w, const char *what, int status, int or_status, const spar_session *s) {
    if (w->verbose) {
        fuzz_say("  at the end: %s = %d", what, status);
    }
    if (status != SPAR_OK && status != or_status) {
        fuzz_finding("end", "at the end %s answers %d: %s", what, status, spar_session_message(s));
    }
}

/* What a host can do about a fluid whose loads were refused: push others, after mapping it perhaps, or let it go. */
static void unload_fluid(live_fluid *f, const double *zero) {
    int status = spar_fluid_push_forces(f->f, zero, NULL);
    if (status == SPAR_ERR_STATE && spar_fluid_map(f->f) == SPAR_OK) {
        status = spar_fluid_push_forces(f->f, zero, NULL);
    }
    if (status == SPAR_ERR_STATE && strstr(spar_session_message(fuzz_world.session[f->session].s), "no step")) {
        return;
    }
    if (status != SPAR_OK || fluid_count(f, SPAR_NODES_FORCE) == 0) {
        spar_fluid_destroy(&f->f);
    }
}

static void unload(world *w, int session) {
    static const double zero[6 * 64];
    for (int i = 0; i < FLUIDS; i++) {
        live_fluid *f = w->fluid + i;
        if (f->f && f->session == session && fluid_room(f, SPAR_NODES_FORCE) <= 3 * 64) {
            unload_fluid(f, zero);
        }
    }
    for (int i = 0; i < MEMBERS; i++) {
        const live_member *m = w->member + i;
        for (int64_t k = 0; m->m && m->session == session && k < nodes_of(m); k++) {
            (void)spar_member_set_load(m->m, k, SPAR_LOAD_DEAD, zero);
            (void)spar_member_set_load(m->m, k, SPAR_LOAD_FOLLOWER, zero);
        }
        if (m->m && m->session == session && m->kind == KIND_BEAM) {
            (void)spar_beam_set_line_load(m->m, SPAR_LOAD_DEAD, 0, NULL, NULL);
            (void)spar_beam_set_line_load(m->m, SPAR_LOAD_FOLLOWER, 0, NULL, NULL);
        }
    }
}

/* Random joints may ask for what cannot be. */
static int is_tied(const world *w, int session) {
    for (int i = 0; i < JOINTS; i++) {
        if (w->joint[i].j && w->joint[i].session == session) {
            return 1;
        }
    }
    return w->session[session].tied;
}

/* What a host can do about nodes that are not mapped. */
static void map_or_release(world *w, int session) {
    for (int i = 0; i < FLUIDS; i++) {
        live_fluid *f = w->fluid + i;
        if (f->f && f->session == session && spar_fluid_map(f->f) != SPAR_OK) {
            spar_fluid_destroy(&f->f);
        }
    }
}

static void end_session(world *w, int session) {
    live_session *l = w->session + session;
    spar_session *s = l->s;
    const double zero[3] = {0, 0, 0};
    must(w, "spar_step_reject", spar_step_reject(s), SPAR_ERR_STATE, s);
    unload(w, session);
    must(w, "spar_session_set_gravity", spar_session_set_gravity(s, zero), SPAR_OK, s);
    must(w, "spar_session_set_coupling", spar_session_set_coupling(s, SPAR_COUPLING_EXPLICIT, 1e-9, 1e-6, 5), SPAR_OK,
         s);
    must(w, "spar_session_set_newton", spar_session_set_newton(s, 1e-12, 1e-9, 50), SPAR_OK, s);
    must(w, "spar_session_set_option", spar_session_set_option(s, "newton.budget", "100000"), SPAR_OK, s);
    must(w, "spar_session_set_progress", spar_session_set_progress(s, NULL, NULL), SPAR_OK, s);
    int status = spar_step_begin(s, 1e-3);
    if (status == SPAR_ERR_STATE && strstr(spar_session_message(s), "not mapped")) {
        map_or_release(w, session);
        status = spar_step_begin(s, 1e-3);
    }
    if (status == SPAR_ERR_STATE && strstr(spar_session_message(s), "not committed")) {
        return;
    }
    if (status == SPAR_ERR_ARGUMENT && strstr(spar_session_message(s), "do not resolve it")) {
        return; /* after a step of 1e9 s and more */
    }
    int tied = is_tied(w, session);
    if (tied && status != SPAR_OK && strstr(spar_session_message(s), "joint")) { /* of what cannot be tied */
        return;
    }
    must(w, "spar_step_begin", status, SPAR_OK, s);
    status = spar_step_solve(s);
    must(w, "spar_step_solve", status, l->wild || tied ? SPAR_ERR_NUMERIC : SPAR_OK, s);
    must(w, "spar_step_reject", spar_step_reject(s), SPAR_OK, s);
    if (status == SPAR_OK) {
        must(w, "spar_step", spar_step(s, 1e-3, NULL, NULL, NULL), l->wild || tied ? SPAR_ERR_NUMERIC : SPAR_OK, s);
    }
    must(w, "spar_step_begin", spar_step_begin(s, 2e-3), SPAR_OK, s);
}

void fuzz_world_end(world *w) {
    w->quiet++;
    for (int i = 0; i < SESSIONS; i++) {
        if (w->session[i].s) {
            end_session(w, i);
        }
    }
    for (int i = 0; i < AEROS; i++) {
        spar_aero_destroy(&w->aero[i].a);
    }
    for (int i = 0; i < POLARS; i++) {
        spar_polar_destroy(&w->polar[i]);
    }
    w->absurd = 0;
    for (int i = 0; i < SESSIONS; i++) {
        spar_session_destroy(&w->session[i].s);
    }
}
