/* Save and load: a run that is stopped anywhere and goes on from its last file ends with the same bits as one that
   never stopped; a file that is not whole, or not of this session, is refused and changes nothing. The oracle is the
   uninterrupted run. */
#include "pistons.h"

#include <float.h>
#include <stdio.h>
#include <unistd.h>

enum { NODES = 12, STEPS = 20, TRACE = 256 };

typedef struct run {
    spar_session *session;
    spar_member *blade, *piston, *point;
    spar_fluid *around, *line, *added;
    double x[NODES][3];
} run;

/* A damped beam of two elements turned at its root with a fluid around it and one that keeps its node forces (an
   actuator line), a piston in heavy fluid, and a point that the host moves; steps of changing length, predictor of
   order 2. */
static void create(run *r, int scheme, double piston_mass) {
    static const double q[4] = {1, 0, 0, 0}, where[3] = {0, 5, 0}, centre[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    static const double mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3}, gravity[3] = {0, 0, -9.81};
    double K[36], M[36], mass[36];
    memset(r, 0, sizeof *r);
    spar_session *s = r->session = scene_session();
    scene_box(K, M);
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_predictor(s, 2));
    OK(s, spar_session_set_integrator(s, 0.8, 2));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-8, 100));
    OK(s, spar_session_set_relaxation(s, 0.3));
    r->blade = scene_beam(s, "blade", 2, 4, 10, K, M);
    OK(s, spar_beam_set_damping(r->blade, mu));
    OK(s, spar_member_set_root(r->blade, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_effects(r->blade, SPAR_EFFECT_FLUID_HISTORY, 0));
    OK(s, spar_member_commit(r->blade));
    scene_mass(mass, piston_mass, centre, J);
    OK(s, spar_rigid_create(s, "piston", where, q, mass, &r->piston));
    OK(s, spar_member_commit(r->piston));
    OK(s, spar_point_create(s, "point", where, q, &r->point));
    OK(s, spar_member_commit(r->point));
    for (int i = 0; i < NODES; i++) {
        r->x[i][0] = 10.0 * i / (NODES - 1);
        r->x[i][1] = 0.2 * cos(2.0 * i);
        r->x[i][2] = 0.2 * sin(2.0 * i);
    }
    OK(s, spar_fluid_create(r->blade, "around", &r->around));
    OK(s, spar_fluid_set_motion_nodes(r->around, NODES, r->x[0]));
    OK(s, spar_fluid_set_force_nodes(r->around, NODES, r->x[0]));
    OK(s, spar_fluid_map(r->around));
    OK(s, spar_fluid_create(r->blade, "line", &r->line));
    OK(s, spar_fluid_set_motion_nodes(r->line, NODES, r->x[0]));
    OK(s, spar_fluid_set_force_nodes(r->line, NODES, r->x[0]));
    OK(s, spar_fluid_map(r->line));
    OK(s, spar_fluid_create(r->piston, "added", &r->added));
    OK(s, spar_fluid_set_force_nodes(r->added, 1, where));
    OK(s, spar_fluid_map(r->added));
}

static void drive(const run *r, double t) {
    double turn = 0.4 * t * t, rate = 0.8 * t;
    double q[7] = {0, 0, 0, cos(turn / 2), 0, 0, sin(turn / 2)}, v[6] = {0, 0, 0, 0, 0, rate},
           a[6] = {0, 0, 0, 0, 0, 0.8};
    OK(r->session, spar_member_drive(r->blade, q, v, a));
}

/* The fluid: its answer depends on the present motion and on what the session itself remembers. */
static void fluid(const run *r) {
    double x[NODES][3], v[NODES][3], f[NODES][3], old[NODES][3], q[7], a[6], force[3];
    OK(r->session, spar_fluid_pull_motion(r->around, 1, x[0], v[0]));
    for (int i = 0; i < NODES; i++) {
        for (int k = 0; k < 3; k++) {
            f[i][k] = -0.5 * v[i][k] + 0.1 * sin(x[i][(k + 1) % 3]);
        }
    }
    OK(r->session, spar_fluid_push_forces(r->around, f[0], NULL));
    OK(r->session, spar_fluid_pull_forces(r->line, 0.5, old[0]));
    OK(r->session, spar_fluid_pull_motion(r->line, 0.5, x[0], v[0]));
    for (int i = 0; i < NODES; i++) {
        for (int k = 0; k < 3; k++) {
            f[i][k] = 0.3 * old[i][k] - 0.2 * v[i][k] + (k == 2);
        }
    }
    OK(r->session, spar_fluid_push_forces(r->line, f[0], v[0]));
    OK(r->session, spar_member_get_motion(r->piston, q, NULL, a));
    for (int k = 0; k < 3; k++) {
        force[k] = -8 * a[k] - 30 * q[k] + 1;
    }
    OK(r->session, spar_fluid_push_forces(r->added, force, NULL));
}

/* What can be seen of a session, now. */
static void look(const run *r, double *out) {
    memset(out, 0, TRACE * sizeof *out);
    OK(r->session, spar_member_get_motion(r->blade, out, out + 56, out + 104));
    OK(r->session, spar_member_get_loads(r->blade, out + 152));
    OK(r->session, spar_member_get_motion(r->piston, out + 200, out + 207, out + 213));
    OK(r->session, spar_member_get_reaction(r->blade, out + 219));
    OK(r->session, spar_member_get_energy(r->blade, 4, out + 225));
    OK(r->session, spar_member_get_motion(r->point, out + 229, NULL, NULL));
    OK(r->session, spar_session_get_time(r->session, out + 236, NULL, NULL));
    OK(r->session, spar_session_get_report(r->session, SPAR_REPORT_COUNT, out + 237));
}

static double dt_of(int64_t step) {
    static const double dts[] = {0.02, 0.02, 0.03, 0.01, 0.02};
    return dts[step % 5];
}

/* Where a run is: the call to be made next. */
typedef struct place {
    int64_t step;
    int call; /* 0 begin, 1 solve, 2 fluid, 3 check, 4 accept */
} place;

static void advance(run *r, place *p) {
    spar_session *s = r->session;
    double t, q[7] = {0, 0, 0, 1, 0, 0, 0};
    int done;
    switch (p->call++) {
    case 0:
        OK(s, spar_session_get_time(s, &t, NULL, NULL));
        drive(r, t + dt_of(p->step));
        OK(s, spar_step_begin(s, dt_of(p->step)));
        q[0] = t;
        OK(s, spar_member_set_motion(r->point, q, NULL, NULL));
        break;
    case 1:
        OK(s, spar_step_solve(s));
        break;
    case 2:
        fluid(r);
        break;
    case 3:
        OK(s, spar_step_check(s, &done));
        p->call = done ? 4 : 1;
        break;
    default:
        OK(s, spar_step_accept(s));
        p->call = 0;
        p->step++;
    }
}

static void finish(run *r, place p, double *end) {
    while (p.step < STEPS) {
        advance(r, &p);
    }
    look(r, end);
    spar_session_destroy(&r->session);
}

static char file[64];

/* 100 places in a run, most of them within a step: saved, taken up by a fresh session, run to the end. */
static void same_bits(void **state) {
    (void)state;
    srand(5);
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        run r;
        place p = {0, 0};
        double end[TRACE], got[TRACE], seen[TRACE];
        /* with this added mass the explicit scheme and the plain iteration blow up: a light one for them */
        double mass = scheme < SPAR_COUPLING_AITKEN ? 100 : 3;
        int calls = 0, resumed = 0;
        create(&r, scheme, mass);
        while (p.step < STEPS) {
            advance(&r, &p);
            calls++;
        }
        look(&r, end);
        spar_session_destroy(&r.session);
        create(&r, scheme, mass);
        p = (place){0, 0};
        int part = calls / 25 + 1, k = 0, at = 0; /* one call of each part: 25 or a few less of each scheme */
        while (p.step < STEPS) {
            if (k % part == 0) {
                at = k + rand() % part;
            }
            if (k++ == at) {
                run fresh;
                OK(r.session, spar_session_save(r.session, file));
                create(&fresh, scheme, mass);
                OK(fresh.session, spar_session_load(fresh.session, file));
                look(&r, seen);
                look(&fresh, got);
                assert_memory_equal(got, seen, sizeof seen);
                finish(&fresh, p, got);
                assert_memory_equal(got, end, sizeof end);
                resumed++;
            }
            advance(&r, &p);
        }
        look(&r, got); /* saving leaves no trace */
        assert_memory_equal(got, end, sizeof end);
        assert_true(resumed >= 15);
        spar_session_destroy(&r.session);
    }
}

enum { BEAM_NODES = 8 };

/* A beam under its own weight, with a fluid at its tip. */
static spar_session *create_beam(int root, spar_member **beam, spar_fluid **fluid) {
    static const double gravity[3] = {0, 0, -9.81}, tip[3] = {10, 0, 0};
    double K[36], M[36];
    spar_session *s = scene_session();
    scene_box(K, M);
    OK(s, spar_session_set_newton(s, 1e-15, 1e-8, 50));
    OK(s, spar_session_set_gravity(s, gravity));
    *beam = scene_beam(s, "beam", 2, 4, 10, K, M);
    OK(s, spar_member_set_root(*beam, root));
    OK(s, spar_member_commit(*beam));
    OK(s, spar_fluid_create(*beam, "fluid", fluid));
    OK(s, spar_fluid_set_motion_nodes(*fluid, 1, tip));
    OK(s, spar_fluid_set_force_nodes(*fluid, 1, tip));
    OK(s, spar_fluid_map(*fluid));
    return s;
}

/* Without loads of a fluid so far, the coupling demands nothing of Newton. A session that is loaded before a solution
   solves with as many iterations as the saved one, and to the same bits. */
static void same_bits_without_loads(void **state) {
    (void)state;
    static const double still[3] = {0, 0, 0};
    spar_member *beam, *other;
    spar_fluid *fluid, *around;
    spar_session *s = create_beam(SPAR_ROOT_FIXED, &beam, &fluid);
    for (int step = 0, done = 0; step < 10; step++, done = 0) {
        OK(s, spar_step_begin(s, 0.05));
        while (!done) {
            double q[2][7 * BEAM_NODES] = {{0}};
            int64_t iterations[2], before[2];
            OK(s, spar_session_save(s, file));
            spar_session *loaded = create_beam(SPAR_ROOT_FIXED, &other, &around);
            OK(loaded, spar_session_load(loaded, file));
            OK(s, spar_member_get_iterations(beam, &before[0], NULL));
            OK(loaded, spar_member_get_iterations(other, &before[1], NULL));
            OK(s, spar_step_solve(s));
            OK(loaded, spar_step_solve(loaded));
            OK(s, spar_member_get_iterations(beam, &iterations[0], NULL));
            OK(loaded, spar_member_get_iterations(other, &iterations[1], NULL));
            assert_int_equal(iterations[1] - before[1], iterations[0] - before[0]);
            OK(s, spar_member_get_motion(beam, q[0], NULL, NULL));
            OK(loaded, spar_member_get_motion(other, q[1], NULL, NULL));
            assert_memory_equal(q[1], q[0], sizeof q[0]);
            spar_session_destroy(&loaded);
            OK(s, spar_fluid_push_forces(fluid, still, NULL));
            OK(s, spar_step_check(s, &done));
        }
        OK(s, spar_step_accept(s));
    }
    spar_session_destroy(&s);
}

/* One iteration of a step with a fluid as heavy as the beam. */
static int iterate(spar_session *s, spar_fluid *fluid) {
    double a[3], force[3];
    int done;
    OK(s, spar_step_solve(s));
    OK(s, spar_fluid_pull_poses(fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a, NULL));
    for (int k = 0; k < 3; k++) {
        force[k] = -0.5 * a[k] + 1;
    }
    OK(s, spar_fluid_push_forces(fluid, force, NULL));
    OK(s, spar_step_check(s, &done));
    return done;
}

/* The root of the beam turns, so that each step computes the images of the columns of earlier steps again. A step that
   is loaded and rejected leaves no more behind than one that is only rejected. */
static void same_bits_after_reject(void **state) {
    (void)state;
    const double dt = 0.05;
    spar_member *beam, *other;
    spar_fluid *fluid, *around;
    spar_session *s = create_beam(SPAR_ROOT_DRIVEN, &beam, &fluid);
    for (int step = 1; step <= 10; step++) {
        double turn = 0.1 * step, q[7] = {0, 0, 0, cos(turn / 2), 0, 0, sin(turn / 2)}, v[6] = {0, 0, 0, 0, 0, 2},
               a[6] = {0}, end[2][7 * BEAM_NODES] = {{0}};
        OK(s, spar_member_drive(beam, q, v, a));
        OK(s, spar_step_begin(s, dt));
        (void)iterate(s, fluid);
        OK(s, spar_session_save(s, file));
        spar_session *loaded = create_beam(SPAR_ROOT_DRIVEN, &other, &around);
        OK(loaded, spar_session_load(loaded, file));
        for (int k = 0; k < 2; k++) {
            spar_session *t = k ? loaded : s;
            OK(t, spar_step_reject(t));
            OK(t, spar_member_drive(k ? other : beam, q, v, a));
            OK(t, spar_step_begin(t, dt));
            while (!iterate(t, k ? around : fluid)) {
            }
            OK(t, spar_member_get_motion(k ? other : beam, end[k], NULL, NULL));
            OK(t, spar_step_accept(t));
        }
        assert_memory_equal(end[1], end[0], sizeof end[0]);
        spar_session_destroy(&loaded);
    }
    spar_session_destroy(&s);
}

/* The count of iterations since the commit goes on after a load, whatever the fidelity. */
static void iterations_go_on(void **state) {
    (void)state;
    static const int fidelities[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL,
                                     SPAR_FIDELITY_RIGID};
    double K[36], M[36];
    scene_box(K, M);
    for (size_t k = 0; k < sizeof fidelities / sizeof *fidelities; k++) {
        int64_t there = 0, here = 0;
        for (int again = 0; again < 2; again++) {
            spar_session *s = scene_session();
            spar_member *beam = scene_beam(s, "beam", 2, 4, 10, K, M);
            OK(s, spar_member_set_root(beam, SPAR_ROOT_FREE));
            OK(s, spar_member_set_fidelity(beam, fidelities[k], fidelities[k] == SPAR_FIDELITY_MODAL ? 9 : 0));
            OK(s, spar_member_commit(beam));
            if (again) {
                OK(s, spar_session_load(s, file));
            } else {
                scene_run(s, 0.01, 3);
                OK(s, spar_session_save(s, file));
            }
            OK(s, spar_member_get_iterations(beam, again ? &here : &there, NULL));
            spar_session_destroy(&s);
        }
        assert_true(there > 0);
        assert_int_equal(here, there);
    }
}

/* ---- refusals ---- */

static unsigned char *bytes;
static size_t length;

static void read_bytes(void) {
    FILE *f = fopen(file, "rb");
    assert_non_null(f);
    fseek(f, 0, SEEK_END);
    length = (size_t)ftell(f);
    rewind(f);
    bytes = malloc(length);
    assert_int_equal(fread(bytes, 1, length, f), length);
    fclose(f);
}

static void write_bytes(const char *path, size_t n) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, n, f), n);
    fclose(f);
}

/* The file as it stands must be refused with this word, and the session stay as it was. */
static void refused(run *r, const char *path, int status, const char *word) {
    double before[TRACE], after[TRACE];
    look(r, before);
    int got = spar_session_load(r->session, path);
    if (got != status || !strstr(spar_session_message(r->session), word)) {
        fail_msg("expected status %d and '%s', got %d: %s", status, word, got, spar_session_message(r->session));
    }
    look(r, after);
    assert_memory_equal(before, after, sizeof before);
}

static void bad_files(void **state) {
    (void)state;
    run r, other;
    place p = {0, 0}, q;
    double end[TRACE], got[TRACE];
    char bad[80];
    snprintf(bad, sizeof bad, "%s-bad", file);
    create(&r, SPAR_COUPLING_IQN_ILS, 3);
    while (p.step < 3) {
        advance(&r, &p);
    }
    OK(r.session, spar_session_save(r.session, file));
    read_bytes();
    while (p.step < 5) {
        advance(&r, &p);
    }
    q = p;
    srand(9);
    refused(&r, "no/such/file", SPAR_ERR_IO, "cannot read");
    refused(&r, "", SPAR_ERR_ARGUMENT, "path");
    refused(&r, NULL, SPAR_ERR_ARGUMENT, "path");
    for (int i = 0; i < 300; i++) { /* cut off anywhere */
        size_t n = i < 40 ? (size_t)i : (size_t)rand() % length;
        write_bytes(bad, n);
        refused(&r, bad, SPAR_ERR_IO, n < 8 ? "not a saved session" : "bytes");
    }
    for (int i = 0; i < 300; i++) { /* any bit turned */
        size_t bit = i < 200 ? (size_t)i : (size_t)rand() % (8 * length);
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        write_bytes(bad, length);
        refused(&r, bad, SPAR_ERR_IO,
                bit < 64    ? "not a saved session"
                : bit < 128 ? "version"
                : bit < 192 ? "bytes"
                            : "damaged");
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    write_bytes(bad, length);
    create(&other, SPAR_COUPLING_IQN_ILS, 4); /* another mass */
    refused(&other, bad, SPAR_ERR_ARGUMENT, "different description of member 'piston'");
    spar_session_destroy(&other.session);
    create(&other, SPAR_COUPLING_IQN_ILS, 3);
    spar_fluid_destroy(&other.line);
    refused(&other, bad, SPAR_ERR_ARGUMENT, "create the fluids");
    spar_session_destroy(&other.session);
    other.session = scene_session();
    assert_int_equal(spar_session_load(other.session, bad), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(other.session), "does not match this session"));
    spar_session_destroy(&other.session);
    /* where nothing can be written */
    assert_int_equal(spar_session_save(r.session, "no/such/folder/file"), SPAR_ERR_IO);
    assert_int_equal(spar_session_save(r.session, NULL), SPAR_ERR_ARGUMENT);
    /* and the run goes on as if nothing had happened */
    finish(&r, q, got);
    create(&r, SPAR_COUPLING_IQN_ILS, 3);
    finish(&r, (place){0, 0}, end);
    assert_memory_equal(got, end, sizeof end);
    /* a step under way is not loaded over */
    create(&r, SPAR_COUPLING_IQN_ILS, 3);
    p = (place){0, 0};
    advance(&r, &p);
    refused(&r, bad, SPAR_ERR_STATE, "a step is in progress");
    OK(r.session, spar_step_reject(r.session));
    OK(r.session, spar_session_load(r.session, bad));
    spar_session_destroy(&r.session);
    free(bytes);
    remove(bad);
}

/* Other coupling settings: fine between steps, refused within one. */
static void other_settings(void **state) {
    (void)state;
    run r, other;
    place p = {0, 0};
    create(&r, SPAR_COUPLING_IQN_ILS, 3);
    while (p.step < 3) {
        advance(&r, &p);
    }
    OK(r.session, spar_session_save(r.session, file));
    create(&other, SPAR_COUPLING_AITKEN, 3);
    OK(other.session, spar_session_load(other.session, file));
    finish(&other, p, (double[TRACE]){0});
    advance(&r, &p);
    advance(&r, &p);
    OK(r.session, spar_session_save(r.session, file));
    create(&other, SPAR_COUPLING_AITKEN, 3);
    refused(&other, file, SPAR_ERR_STATE, "same settings");
    spar_session_destroy(&other.session);
    spar_session_destroy(&r.session);
}

/* A file is replaced whole: no other is left beside it. */
static void leaves_one_file(void **state) {
    (void)state;
    run r;
    char temporary[80];
    snprintf(temporary, sizeof temporary, "%s.new", file);
    create(&r, SPAR_COUPLING_EXPLICIT, 100);
    OK(r.session, spar_session_save(r.session, file));
    OK(r.session, spar_session_save(r.session, file));
    assert_int_not_equal(access(temporary, F_OK), 0);
    OK(r.session, spar_session_load(r.session, file));
    spar_session_destroy(&r.session);
}

static int name_file(void **state) {
    (void)state;
    snprintf(file, sizeof file, "test_save_%ld.spar", (long)getpid());
    return 0;
}

static int remove_file(void **state) {
    (void)state;
    return remove(file) != 0;
}

static void count_errors(const spar_session *s, int level, const char *text, void *errors) {
    (void)s, (void)text;
    *(int *)errors += level == SPAR_LOG_ERROR;
}

/* A large file is loaded without a word in the log. */
static void large_file(void **state) {
    (void)state;
    int errors = 0;
    for (int again = 0; again < 2; again++) {
        double K[36], M[36];
        spar_session *s = scene_session();
        OK(s, spar_session_set_log(s, count_errors, &errors));
        scene_box(K, M);
        OK(s, spar_member_commit(scene_beam(s, "long", 200, 4, 100, K, M)));
        if (again) {
            OK(s, spar_session_load(s, file));
        } else {
            OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
            OK(s, spar_session_save(s, file));
        }
        spar_session_destroy(&s);
    }
    assert_int_equal(errors, 0);
}

/* What a description says in other words is the same description: the default by its name, zeros, effects switched off
   that are not there. Another number of points is another. */
static void same_meaning(void **state) {
    (void)state;
    enum { PLAIN, GAUSS, POINTS, VELOCITY, TWIST, EFFECTS, MODES, OTHER, WAYS };
    const double none[3] = {0}, twist[2] = {0}, eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 1, 0, 0};
    double K[36], M[36];
    for (int way = 0; way < WAYS; way++) {
        spar_session *s = scene_session();
        scene_box(K, M);
        spar_member *b = scene_beam(s, "beam", 2, 4, 1, K, M);
        OK(s, way == GAUSS    ? spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 0)
              : way == POINTS ? spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 4)
              : way == OTHER  ? spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 5)
                              : SPAR_OK);
        OK(s, way == VELOCITY ? spar_member_set_initial_velocity(b, xyz + 3, none, none) : SPAR_OK);
        OK(s, way == TWIST ? spar_beam_set_axis(b, 2, eta, xyz, twist) : SPAR_OK);
        OK(s, way == EFFECTS ? spar_member_set_effects(b, 0, SPAR_EFFECT_FOUNDATION) : SPAR_OK);
        OK(s, way == MODES ? spar_member_set_fidelity(b, SPAR_FIDELITY_EXACT, 5) : SPAR_OK);
        OK(s, spar_member_commit(b));
        if (way == PLAIN) {
            OK(s, spar_step(s, 1e-3, NULL, NULL, NULL));
            OK(s, spar_session_save(s, file));
        } else if (way == OTHER) {
            REFUSED(s, SPAR_ERR_ARGUMENT, "a different description of member 'beam'", spar_session_load(s, file));
        } else {
            OK(s, spar_session_load(s, file));
        }
        spar_session_destroy(&s);
    }
}

/* A member that differs from the saved one in one part of its description is refused with the name of this part. */
static void difference_is_named(void **state) {
    (void)state;
    static const char *const part[] = {"fidelity",   "root",     "effects", "elements and nodes", "added mass", "line",
                                       "quadrature", "sections", NULL};
    enum { SAVED = sizeof part / sizeof *part - 1 };
    const double eta[2] = {0, 1}, bent[6] = {0, 0, 0, 1, 0.1, 0};
    double K[36], M[36], added[36] = {0};
    added[7] = 1;
    for (int k = SAVED; k >= -1; k--) { /* saved, then each difference, then the same again */
        const int way = k == SAVED || k < 0 ? SAVED : k;
        spar_session *s = scene_session();
        scene_box(K, M);
        K[0] *= way == 7 ? 1 + 1e-6 : 1;
        spar_member *b = scene_beam(s, "beam", way == 3 ? 1 : 2, way == 3 ? 8 : 4, 1, K, M);
        OK(s, way == 0 ? spar_member_set_fidelity(b, SPAR_FIDELITY_LINEAR, 0) : SPAR_OK);
        OK(s, way == 1 ? spar_member_set_root(b, SPAR_ROOT_PINNED) : SPAR_OK);
        OK(s, way == 2 ? spar_member_set_effects(b, 0, SPAR_EFFECT_GRAVITY) : SPAR_OK);
        OK(s, way == 4 ? spar_member_set_added_mass(b, 1, eta, added) : SPAR_OK);
        OK(s, way == 5 ? spar_beam_set_axis(b, 2, eta, bent, NULL) : SPAR_OK);
        OK(s, way == 6 ? spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 5) : SPAR_OK);
        OK(s, spar_member_commit(b));
        if (k == SAVED) {
            OK(s, spar_session_save(s, file));
        } else if (k < 0) {
            OK(s, spar_session_load(s, file));
        } else {
            char text[100];
            (void)snprintf(text, sizeof text, "a different description of member 'beam': its %s", part[way]);
            REFUSED(s, SPAR_ERR_ARGUMENT, text, spar_session_load(s, file));
        }
        spar_session_destroy(&s);
    }
}

/* Numbers of a description that a host computes: n of x, those of `part` times 1 + off or 1 - off / 2 in turn. */
enum { SECTIONS, LINE, ADDED, DAMPING, FOUNDATION, PRETENSION, MASSES, POSITION, MASS, HINGE, LINK, VELOCITY, PARTS };

typedef struct rounding {
    double off;
    int part; /* PARTS: all of them */
} rounding;

static void change(rounding r, int part, int n, double *x) {
    for (int k = 0; k < n && (part == r.part || r.part == PARTS); k++) {
        x[k] *= 1 + (k % 2 ? -r.off / 2 : r.off);
    }
}

static void diagonal(rounding r, int part, double size, double matrix[36]) {
    double of[2] = {size, size / 3};
    change(r, part, 2, of);
    memset(matrix, 0, 36 * sizeof *matrix);
    for (int k = 0; k < 6; k++) {
        matrix[7 * k] = of[k / 3];
    }
}

/* Six decades from root to tip; bending along the one axis twists, by a number that cancellation leaves. */
static void computed_sections(rounding r, spar_session *s, spar_member *beam) {
    enum { STATIONS = 7 };
    double eta[STATIONS], xyz[3 * STATIONS], twist[STATIONS], K[36 * STATIONS], M[36 * STATIONS], box[2][36];
    scene_box(box[0], box[1]);
    for (int i = 0; i < STATIONS; i++) {
        double x = (double)i / (STATIONS - 1), size[2] = {exp(-14 * x), exp(-6 * x)};
        change(r, SECTIONS, 1, size + i % 2);
        eta[i] = x, twist[i] = 0.2 * cos(x);
        xyz[3 * i] = x, xyz[3 * i + 1] = 0.05 * sin(x), xyz[3 * i + 2] = 0;
        for (int k = 0; k < 36; k++) {
            K[36 * i + k] = box[0][k] * size[0];
            M[36 * i + k] = box[1][k] * size[1];
        }
        K[36 * i + 23] = K[36 * i + 33] = r.off * 1e-4 * K[36 * i + 21];
    }
    change(r, LINE, 3 * STATIONS, xyz);
    change(r, LINE, STATIONS, twist);
    OK(s, spar_beam_set_axis(beam, STATIONS, eta, xyz, twist));
    OK(s, spar_beam_set_sections(beam, STATIONS, eta, K, M));
}

/* A beam with all that it may carry, a rigid body on a hinge, and a link. */
static spar_session *computed(rounding r, spar_member **out) {
    const double eta[2] = {0, 1};
    double mu[6] = {1e-3, 2e-3, 2e-3, 1e-3, 3e-3, 3e-3}, springs[6] = {1e3, 2e3, 1.5e3, 1e3, 1e3, 1e3};
    double tension[12] = {100, 1, 2, 3, 4, 5, 50, 1, 2, 3, 4, 5}, where[3] = {10, -4, 3}, velocity[3] = {1, 2, 0.5};
    double turn[4] = {cos(0.3), 0.6 * sin(0.3), 0, 0.8 * sin(0.3)}, axis[4] = {cos(0.35), 0, sin(0.35), 0};
    double ends[6] = {11, -4, 3, 9, 9, 9}, link[3] = {1e3, 10, 17.5}, matrix[36], angle = 0.35;
    spar_session *s = scene_session();
    spar_member *beam, *body;
    spar_joint *hinge, *rope;
    change(r, DAMPING, 6, mu);
    change(r, FOUNDATION, 6, springs);
    change(r, PRETENSION, 12, tension);
    change(r, VELOCITY, 3, velocity);
    change(r, HINGE, 1, &angle);
    axis[0] = cos(angle), axis[2] = sin(angle);
    OK(s, spar_beam_create(s, "beam", 2, 4, &beam));
    computed_sections(r, s, beam);
    OK(s, spar_beam_set_damping(beam, mu));
    OK(s, spar_beam_set_foundation(beam, 2, eta, springs));
    OK(s, spar_beam_set_pretension(beam, 2, eta, tension));
    diagonal(r, MASSES, 2, matrix);
    OK(s, spar_beam_set_masses(beam, 1, eta + 1, matrix));
    diagonal(r, ADDED, 1e-6, matrix);
    OK(s, spar_member_set_added_mass(beam, 1, eta, matrix));
    OK(s, spar_member_set_root(beam, SPAR_ROOT_FREE));
    OK(s, spar_member_set_initial_velocity(beam, where, velocity, velocity));
    diagonal(r, MASS, 4, matrix);
    OK(s, spar_rigid_create(s, "body", where, NULL, matrix, &body));
    OK(s, spar_joint_create(s, "hinge", beam, 0, body, 0, SPAR_FREE_RX, &hinge));
    OK(s, spar_joint_set_frame(hinge, where, axis));
    change(r, LINK, 6, ends);
    change(r, LINK, 3, link);
    OK(s, spar_link_create(s, "rope", body, 0, ends, NULL, 0, ends + 3, &rope));
    OK(s, spar_link_set_spring(rope, link[0], link[1], link[2], 0));
    change(r, POSITION, 3, where);
    OK(s, spar_member_set_placement(beam, where, turn));
    OK(s, spar_member_commit(beam));
    OK(s, spar_member_commit(body));
    *out = beam;
    return s;
}

/* Another processor rounds what a host computes in other last bits: the file is read, and the state in it, to the bit.
   A difference that is meant is refused, by its name. Initial velocities are those of the file. Amplified rounding: a
   thousand times the last bit. */
static void other_rounding(void **state) {
    (void)state;
    static const char *const names[PARTS] = {"sections",   "line",          "added mass",   "damping",
                                             "foundation", "pretension",    "point masses", "initial position",
                                             "mass",       "joint 'hinge'", "joint 'rope'", NULL};
    double saved[3][7 * 8], loaded[3][7 * 8];
    spar_member *beam;
    spar_session *s = computed((rounding){0, PARTS}, &beam);
    OK(s, spar_step(s, 1e-3, NULL, NULL, NULL));
    OK(s, spar_session_save(s, file));
    OK(s, spar_member_get_motion(beam, saved[0], saved[1], saved[2]));
    spar_session_destroy(&s);
    for (int part = 0; part <= PARTS; part++) {
        s = computed((rounding){1000 * DBL_EPSILON, part}, &beam);
        OK(s, spar_session_load(s, file));
        OK(s, spar_member_get_motion(beam, loaded[0], loaded[1], loaded[2]));
        assert_memory_equal(loaded[0], saved[0], 7 * 8 * sizeof(double));
        assert_memory_equal(loaded[1], saved[1], 6 * 8 * sizeof(double));
        spar_session_destroy(&s);
        s = computed((rounding){1e-5, part}, &beam);
        if (part == VELOCITY) {
            OK(s, spar_session_load(s, file));
        } else {
            char text[100];
            (void)snprintf(text, sizeof text, "%s%s", part < HINGE ? "its " : "", part < PARTS ? names[part] : "");
            REFUSED(s, SPAR_ERR_ARGUMENT, "a different description of", spar_session_load(s, file));
            REFUSED(s, SPAR_ERR_ARGUMENT, text, spar_session_load(s, file));
        }
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(same_bits),
                                       cmocka_unit_test(same_bits_without_loads),
                                       cmocka_unit_test(same_bits_after_reject),
                                       cmocka_unit_test(iterations_go_on),
                                       cmocka_unit_test(bad_files),
                                       cmocka_unit_test(other_settings),
                                       cmocka_unit_test(leaves_one_file),
                                       cmocka_unit_test(same_meaning),
                                       cmocka_unit_test(difference_is_named),
                                       cmocka_unit_test(other_rounding),
                                       cmocka_unit_test(large_file)};
    return cmocka_run_group_tests(tests, name_file, remove_file);
}
