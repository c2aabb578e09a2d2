/* The NREL 5-MW rotor with AeroDyn as its fluid, at a given speed. Beside it, where it is asked for, the same rotor
   with spar's own blade elements, so that the two can be compared. --help lists the options. */
#include "deck.h"
#include "nrel5mw.h"
#include "plate.h"
#include "spar_aerodyn.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLADES = 3 };
enum { BESIDE_NOTHING, BESIDE_BEM, BESIDE_PLATE };

static const double pi = 3.14159265358979323846;
static const double hub_height = 90; /* m: InflowWind has no wind below the ground */

typedef struct options {
    const char *aerodyn, *inflow, *deck, *data;
    double wind, rpm, pitch, tilt, precone, seconds, dt, tolerance, allowed;
    int beside, iterations, rigid;
} options;

/* One rotor: with AeroDyn, or with spar's own blade elements. */
typedef struct scene {
    const options *o;
    const nrel5mw *data;
    nrel5mw_rotor rotor;
    double speed;
    spar_session *session;
    spar_member *blade[BLADES];
    spar_fluid *fluid[BLADES];
    int64_t nodes;
    spar_aerodyn *aerodyn; /* or */
    spar_aero *aero;
    double *inflow;
    double thrust, torque, flap; /* N, N m, m: of the last step */
} scene;

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

/* ---- the structure ---- */

static int create_blades(scene *s, double *twist) {
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = s->speed * s->rotor.axis[i];
    }
    for (int b = 0; b < BLADES; b++) {
        nrel5mw data = *s->data; /* its message alone is written to */
        TRY(nrel5mw_create_blade(&data, &s->rotor, s->session, b, s->o->rigid ? 0 : 1, 8, &s->blade[b]));
        TRY(spar_member_commit(s->blade[b]));
        TRY(spar_member_set_initial_velocity(s->blade[b], s->rotor.hub, NULL, omega));
        TRY(nrel5mw_create_sections(&data, &s->rotor, b, s->blade[b], &s->fluid[b], twist));
    }
    return spar_member_get_count(s->blade[0], &s->nodes);
}

static int create_session(scene *s) {
    TRY(spar_session_create(&s->session));
    TRY(spar_session_set_gravity(s->session, (const double[]){0, 0, -9.80665}));
    TRY(spar_session_set_integrator(s->session, 0.8, 1));
    return spar_session_set_coupling(s->session, SPAR_COUPLING_FIXED_POINT, 0, s->o->tolerance, s->o->iterations);
}

/* ---- hub and nacelle at time t ---- */

/* The hub's axes: x along the shaft, z to blade 1; then turned with the rotor. */
static void hub_at(const scene *s, double t, spar_aerodyn_body *hub, spar_aerodyn_body *nacelle) {
    const double lean = 0.5 * s->data->tilt, half = 0.5 * s->speed * t;
    const double own[4] = {cos(lean), 0, sin(lean), 0}, about[4] = {cos(half), sin(half), 0, 0};
    memset(hub, 0, sizeof *hub);
    memset(nacelle, 0, sizeof *nacelle);
    hub->q[0] = own[0] * about[0]; /* own about: the turn is about the hub's own x */
    hub->q[1] = own[0] * about[1];
    hub->q[2] = own[2] * about[0];
    hub->q[3] = -own[2] * about[1];
    nacelle->q[0] = 1;
    for (int i = 0; i < 3; i++) {
        hub->x[i] = nacelle->x[i] = s->rotor.hub[i];
        hub->v[3 + i] = s->speed * s->rotor.axis[i];
    }
}

static int drive(scene *s, double t) {
    for (int b = 0; b < BLADES; b++) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(s->data, &s->rotor, b, s->speed * t, s->speed, 0, q, v, a);
        TRY(spar_member_drive(s->blade[b], q, v, a));
    }
    return SPAR_OK;
}

/* ---- the fluid ---- */

static int solve_at(scene *s, double t, double dt) {
    spar_aerodyn_body hub, nacelle;
    hub_at(s, t + dt, &hub, &nacelle);
    return s->aerodyn ? spar_aerodyn_solve(s->aerodyn, t, dt, &hub, &nacelle)
                      : spar_aero_solve(s->aero, s->data->density, s->inflow, 1);
}

static int solve(spar_session *session, double t, double dt, int iteration, void *context) {
    (void)session, (void)iteration;
    return solve_at(context, t, dt);
}

static int create_aerodyn(scene *s) {
    const options *o = s->o;
    const spar_aerodyn_options given = {.aerodyn_file = o->aerodyn,
                                        .inflow_file = o->inflow,
                                        .output = "aerodyn_rotor",
                                        .gravity = 9.80665,
                                        .density = s->data->density,
                                        .viscosity = 1.464e-5,
                                        .sound = 335,
                                        .dt = o->dt,
                                        .seconds = o->seconds,
                                        .order = 2};
    spar_aerodyn_body hub, nacelle;
    hub_at(s, 0, &hub, &nacelle);
    return spar_aerodyn_create(&given, BLADES, s->fluid, &hub, &nacelle, &s->aerodyn);
}

/* The blade elements of spar, or plates as the stand-in has them. */
static int create_elements(scene *s, const double *twist) {
    nrel5mw data = *s->data;
    s->inflow = calloc((size_t)(3 * BLADES * data.aero_n), sizeof *s->inflow);
    if (!s->inflow) {
        return SPAR_ERR_MEMORY;
    }
    for (int64_t i = 0; i < BLADES * data.aero_n; i++) {
        s->inflow[3 * i] = s->o->wind;
    }
    if (s->o->beside == BESIDE_BEM) {
        return nrel5mw_create_aero(&data, &s->rotor, BLADES, s->fluid, twist, &s->aero);
    }
    spar_polar *plate = NULL;
    int status = spar_polar_create(PLATE_ROWS, plate_alpha, plate_cl, plate_cd, plate_cms, &plate);
    status = status ? status : spar_aero_create(BLADES, s->fluid, &s->aero);
    for (int64_t i = 0; i < data.aero_n && status == SPAR_OK; i++) {
        status = spar_aero_set_section(s->aero, i, plate_chord, 0, plate);
    }
    spar_polar_destroy(&plate);
    return status;
}

/* ---- the run ---- */

/* Shape at rest under weight and wind first, then at speed. */
static int bend(scene *s) {
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = s->speed * s->rotor.axis[i];
    }
    TRY(solve_at(s, 0, 0));
    for (int b = 0; b < BLADES; b++) {
        TRY(s->o->rigid ? SPAR_OK : spar_member_solve_static(s->blade[b], 4));
        TRY(spar_member_set_initial_velocity(s->blade[b], s->rotor.hub, NULL, omega));
    }
    return solve_at(s, 0, 0);
}

static int create(scene *s, const options *o, const nrel5mw *data, int with_aerodyn) {
    double twist[256];
    s->o = o;
    s->data = data;
    nrel5mw_rotor_default(data, &s->rotor);
    s->rotor.pitch = o->pitch * pi / 180;
    s->rotor.hub[2] = hub_height;
    s->speed = o->rpm * pi / 30;
    TRY(create_session(s));
    TRY(create_blades(s, twist));
    TRY(with_aerodyn ? create_aerodyn(s) : create_elements(s, twist));
    return bend(s);
}

/* Force along the shaft and moment about it, and how far the first blade's tip is from where a rigid one would be,
 * downwind. */
static int look(scene *s, double t) {
    double motion[7 * 64], place[3 * 64], force[3], moment[3], q[7], v[6], a[6];
    s->thrust = s->torque = s->flap = 0;
    for (int b = 0; b < BLADES; b++) {
        TRY(spar_fluid_sum_loads(s->fluid[b], s->rotor.hub, force, moment));
        for (int i = 0; i < 3; i++) {
            s->thrust += force[i] * s->rotor.axis[i];
            s->torque += moment[i] * s->rotor.axis[i];
        }
    }
    TRY(spar_member_get_motion(s->blade[0], motion, NULL, NULL));
    TRY(spar_member_get_reference(s->blade[0], place, NULL));
    nrel5mw_root_motion(s->data, &s->rotor, 0, s->speed * t, s->speed, 0, q, v, a);
    for (int i = 0; i < 3; i++) { /* turning about the shaft moves nothing along it */
        s->flap += motion[7 * (s->nodes - 1) + i] * s->rotor.axis[i];
    }
    return SPAR_OK;
}

static int step(scene *s, double t, int *iterations) {
    TRY(drive(s, t + s->o->dt));
    TRY(spar_step(s->session, s->o->dt, solve, s, iterations));
    return look(s, t + s->o->dt);
}

static void release(scene *s) {
    spar_aerodyn_destroy(&s->aerodyn);
    spar_aero_destroy(&s->aero);
    spar_session_destroy(&s->session);
    free(s->inflow);
}

static int complain(const scene *s, int status) {
    const char *text = s->aerodyn ? spar_aerodyn_message(s->aerodyn) : "";
    fprintf(stderr, "aerodyn_rotor: %s: %s\n", spar_status_text(status),
            text[0] ? text : spar_session_message(s->session));
    return 1;
}

/* Steps of both; the largest differences, relative to the largest of each figure. */
static int run(const options *o, scene *with, scene *beside) {
    const int steps = (int)ceil(o->seconds / o->dt - 1e-9), shown = steps > 20 ? steps / 20 : 1;
    double difference[3] = {0}, largest[3] = {1e-300, 1e-300, 1e-300}, impulse = 0;
    printf("%8s %12s %13s %12s %10s %5s%s\n", "time", "thrust", "torque", "power", "tip", "iter",
           o->beside ? "   spar's own: thrust        torque        tip" : "");
    for (int i = 0; i < steps; i++) {
        int iterations, own = 0, status = step(with, i * o->dt, &iterations);
        if (status != SPAR_OK) {
            return complain(with, status);
        }
        if (o->beside && (status = step(beside, i * o->dt, &own)) != SPAR_OK) {
            return complain(beside, status);
        }
        impulse += o->dt * with->thrust;
        const double here[3] = {with->thrust, with->torque, with->flap},
                     there[3] = {beside->thrust, beside->torque, beside->flap};
        for (int k = 0; k < 3; k++) {
            largest[k] = fmax(largest[k], fabs(here[k]));
            difference[k] = fmax(difference[k], fabs(here[k] - there[k]));
        }
        if ((i + 1) % shown == 0 || i + 1 == steps) {
            printf("%8.3f %9.3f kN %8.3f kN m %9.3f kW %8.4f m %5d", (i + 1) * o->dt, with->thrust * 1e-3,
                   with->torque * 1e-3, with->torque * with->speed * 1e-3, with->flap, iterations);
            if (o->beside) {
                printf("     %9.3f kN %8.3f kN m %8.4f m", beside->thrust * 1e-3, beside->torque * 1e-3, beside->flap);
            }
            printf("\n");
        }
    }
    if (o->beside) {
        double worst = 0;
        for (int k = 0; k < 3; k++) {
            worst = fmax(worst, o->rigid && k == 2 ? 0 : difference[k] / largest[k]);
        }
        printf("the two differ by %.1e of the thrust, %.1e of the torque", difference[0] / largest[0],
               difference[1] / largest[1]);
        printf(o->rigid ? "\n" : ", %.1e of the tip\n", difference[2] / largest[2]);
        if (o->beside == BESIDE_PLATE) { /* the stand-in's state, which must not count corrections */
            const double own = spar_aerodyn_get_channel(with->aerodyn, 0);
            printf("impulse of the thrust: %.6g N s, as the stand-in has it %.6g N s\n", impulse, own);
            return !(worst <= o->allowed) || !(fabs(own - impulse) <= o->allowed * impulse);
        }
        return !(worst <= o->allowed);
    }
    return 0;
}

/* ---- options ---- */

static void help(void) {
    puts("usage: aerodyn_rotor [options]\n\n"
         "  --deck FOLDER     writes the files of AeroDyn and InflowWind there, for this turbine and wind, and runs "
         "with "
         "them [aerodyn_deck]\n"
         "  --aerodyn FILE    in their place: AeroDyn's primary input file, of the NREL 5-MW turbine\n"
         "  --inflow FILE     InflowWind's\n"
         "  --wind M/S        of --deck; of the given files, for --beside [8]\n"
         "  --rpm REV/MIN     rotor speed [9.16]\n"
         "  --pitch DEG       blade pitch [0]\n"
         "  --tilt DEG        of the shaft [5]\n"
         "  --precone DEG     of the blades [2.5]\n"
         "  --rigid 1         rigid blades, as AeroDyn's own driver has them [0]\n"
         "  --seconds S       time to simulate [10]\n"
         "  --dt S            step of AeroDyn and of the coupling, one for the whole run [0.02]\n"
         "  --tolerance R     of the coupling; AeroDyn built in double precision, as it comes, reaches 1e-6 [1e-4]\n"
         "  --iterations N    of the coupling at most [20]\n"
         "  --beside bem|plate runs the rotor with spar's own blade elements too: those of the turbine, or the "
         "stand-in's plates\n"
         "  --allowed R       fails where the two differ by more, relative to the largest [1]\n"
         "  --data FOLDER     the tables of the turbine");
}

/* Says what is wrong with an option. */
static int wrong(const char *name, const char *value) {
    if (strcmp(name, "--cfl") == 0) {
        fprintf(stderr,
                "aerodyn_rotor: --cfl: AeroDyn's library counts steps of one dt from t = 0, so that dt cannot follow "
                "the flow; give --dt\n");
    } else if (strcmp(name, "--help") == 0) {
        help();
    } else {
        fprintf(stderr, "aerodyn_rotor: %s %s: no such option or value; --help lists them\n", name, value);
    }
    return 0;
}

static int options_read(options *o, int argc, char **argv) {
    double rigid = 0, iterations = o->iterations;
    struct {
        const char *name;
        double *number;
        const char **text;
    } known[] = {
        {"--aerodyn", NULL, &o->aerodyn},     {"--inflow", NULL, &o->inflow}, {"--data", NULL, &o->data},
        {"--wind", &o->wind, NULL},           {"--rpm", &o->rpm, NULL},       {"--pitch", &o->pitch, NULL},
        {"--seconds", &o->seconds, NULL},     {"--dt", &o->dt, NULL},         {"--allowed", &o->allowed, NULL},
        {"--tolerance", &o->tolerance, NULL}, {"--deck", NULL, &o->deck},     {"--tilt", &o->tilt, NULL},
        {"--precone", &o->precone, NULL},     {"--rigid", &rigid, NULL},      {"--iterations", &iterations, NULL}};
    for (int i = 1; i < argc; i += 2) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        char *end = "";
        size_t k = 0, n = sizeof known / sizeof known[0];
        while (k < n && strcmp(argv[i], known[k].name) != 0) {
            k++;
        }
        if (k < n && known[k].text && value[0]) {
            *known[k].text = value;
        } else if (k < n && known[k].number && value[0]) {
            *known[k].number = strtod(value, &end);
        } else if (strcmp(argv[i], "--beside") == 0 && (strcmp(value, "plate") == 0 || strcmp(value, "bem") == 0)) {
            o->beside = strcmp(value, "plate") == 0 ? BESIDE_PLATE : BESIDE_BEM;
        } else {
            return wrong(argv[i], value);
        }
        if (*end) {
            return wrong(argv[i], value);
        }
    }
    o->iterations = (int)iterations;
    o->rigid = rigid != 0;
    if (!(o->dt > 0 && o->seconds > 0 && o->iterations > 0)) {
        return wrong("--dt, --seconds, --iterations", "are positive");
    }
    if (!o->aerodyn != !o->inflow) {
        return wrong("--aerodyn", "goes with --inflow");
    }
    return 1;
}

/* The files that it runs with, where none are given. */
static int make_deck(options *o, nrel5mw *data) {
    static char aerodyn[1024], inflow[1024];
    if (o->aerodyn) {
        return SPAR_OK;
    }
    snprintf(aerodyn, sizeof aerodyn, "%.1000s/AeroDyn.dat", o->deck);
    snprintf(inflow, sizeof inflow, "%.1000s/InflowWind.dat", o->deck);
    o->aerodyn = aerodyn;
    o->inflow = inflow;
    return deck_write(data, o->deck, o->wind);
}

int main(int argc, char **argv) {
    options o = {.data = SPAR_DATA_DIR "/nrel5mw",
                 .deck = "aerodyn_deck",
                 .wind = 8,
                 .tilt = NAN,
                 .precone = NAN,
                 .rpm = 9.16,
                 .seconds = 10,
                 .dt = 0.02,
                 .tolerance = 1e-4,
                 .allowed = 1,
                 .iterations = 20};
    nrel5mw data;
    static scene with, beside;
    if (!options_read(&o, argc, argv)) {
        return 2;
    }
    int status = nrel5mw_load(&data, o.data), failed;
    data.tilt = isnan(o.tilt) ? data.tilt : o.tilt * pi / 180;
    data.precone = isnan(o.precone) ? data.precone : o.precone * pi / 180;
    status = status ? status : make_deck(&o, &data);
    if (status != SPAR_OK) {
        fprintf(stderr, "aerodyn_rotor: %s\n", data.message);
        nrel5mw_free(&data);
        return 1;
    }
    status = create(&with, &o, &data, 1);
    failed = status ? complain(&with, status) : 0;
    status = !failed && o.beside ? create(&beside, &o, &data, 0) : SPAR_OK;
    failed = failed || (status && complain(&beside, status)) || run(&o, &with, &beside);
    release(&with);
    release(&beside);
    nrel5mw_free(&data);
    return failed;
}
