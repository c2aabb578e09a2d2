/* What the adapter must refuse, with the stand-in: another dt, a start elsewhere, names that are too long; and a
   message of the library's full length. One straight blade on the shaft's axis at 90 m. */
#include "adi.h"
#include "spar_aerodyn.h"
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <string.h>

enum { STATIONS = 5 };

static int failures;

static void expect(int good, const char *what, const char *said) {
    printf("  %-70s %s%s%.60s\n", what, good ? "" : "WRONG ", said[0] ? ": " : "", said);
    failures += !good;
}

/* The blade stands upright, its y axis to the trailing edge along y, z upwind. */
static int make(spar_session **session, spar_fluid **air) {
    const double ends[2] = {0, 1}, line[6] = {0, 0, 0, 60, 0, 0}, root[3] = {0, 0, 91.5},
                 q[4] = {0.70710678118654752, 0, -0.70710678118654752, 0}, eta[STATIONS] = {0, 0.25, 0.5, 0.75, 1};
    double K[36] = {0}, M[36] = {0};
    spar_member *blade;
    for (int i = 0; i < 6; i++) {
        K[7 * i] = 1e9;
        M[7 * i] = i < 3 ? 300 : 100;
    }
    int status = spar_session_create(session);
    status = status ? status : spar_beam_create(*session, "blade", 1, 4, &blade);
    status = status ? status : spar_beam_set_axis(blade, 2, ends, line, NULL);
    status = status ? status : spar_member_set_placement(blade, root, q);
    status = status ? status : spar_beam_set_sections(blade, 1, eta, K, M);
    status = status ? status : spar_member_commit(blade);
    status = status ? status : spar_fluid_create(blade, "air", air);
    status = status ? status : spar_fluid_set_stations(*air, STATIONS, eta, NULL);
    return status ? status : spar_fluid_map(*air);
}

static spar_aerodyn_options options_of(const char *aerodyn) {
    return (spar_aerodyn_options){.aerodyn_file = aerodyn,
                                  .inflow_file = STAND_IN_FILE,
                                  .output = "checks",
                                  .gravity = 9.81,
                                  .density = 1.225,
                                  .viscosity = 1.464e-5,
                                  .sound = 335,
                                  .dt = 0.02,
                                  .seconds = 1,
                                  .order = 2};
}

static const spar_aerodyn_body hub = {.x = {0, 0, 90}, .q = {1, 0, 0, 0}};

/* A step of dt from t, in the session and in AeroDyn. */
static int step(spar_session *session, spar_aerodyn *aerodyn, double t, double dt) {
    int status = spar_step_begin(session, dt);
    status = status ? status : spar_step_solve(session);
    status = status ? status : spar_aerodyn_solve(aerodyn, t, dt, &hub, &hub);
    if (status != SPAR_OK) {
        spar_step_reject(session);
        return status;
    }
    return spar_step_accept(session);
}

static void check_clock(void) {
    spar_session *session = NULL;
    spar_fluid *air = NULL;
    spar_aerodyn *aerodyn = NULL;
    const spar_aerodyn_options options = options_of(STAND_IN_FILE);
    int status = make(&session, &air);
    status = status ? status : spar_aerodyn_create(&options, 1, &air, &hub, &hub, &aerodyn);
    status = status ? status : spar_aerodyn_solve(aerodyn, 0, 0, &hub, &hub);
    status = status ? status : step(session, aerodyn, 0, 0.02);
    expect(status == SPAR_OK, "a step of dt", status ? spar_aerodyn_message(aerodyn) : "");
    status = step(session, aerodyn, 0.02, 0.01);
    expect(status == SPAR_ERR_ARGUMENT &&
               strstr(spar_aerodyn_message(aerodyn), "counts steps of the dt that it was made with"),
           "another dt is refused", spar_aerodyn_message(aerodyn));
    status = step(session, aerodyn, 0.03, 0.02);
    expect(status == SPAR_ERR_ARGUMENT, "a step from between two steps is refused", spar_aerodyn_message(aerodyn));
    status = step(session, aerodyn, 0.02, 0.02);
    expect(status == SPAR_OK, "and the next step of dt goes on", status ? spar_aerodyn_message(aerodyn) : "");
    spar_aerodyn_destroy(&aerodyn);
    spar_session_destroy(&session);
}

static void check_texts(void) {
    static char path[3 * ADI_TEXT];
    spar_session *session = NULL;
    spar_fluid *air = NULL;
    spar_aerodyn *aerodyn = NULL;
    spar_aerodyn_options options = options_of(path);
    memset(path, 'x', ADI_TEXT - 1); /* the longest name that the library takes */
    int status = make(&session, &air);
    status = status ? status : spar_aerodyn_create(&options, 1, &air, &hub, &hub, &aerodyn);
    expect(status == SPAR_ERR_USER && strlen(spar_aerodyn_message(aerodyn)) > ADI_TEXT,
           "the library's message, longer than a name", spar_aerodyn_message(aerodyn));
    spar_aerodyn_destroy(&aerodyn);
    memset(path, 'x', 2 * ADI_TEXT);
    status = spar_aerodyn_create(&options, 1, &air, &hub, &hub, &aerodyn);
    expect(status == SPAR_ERR_ARGUMENT, "a longer name is refused", spar_aerodyn_message(aerodyn));
    spar_aerodyn_destroy(&aerodyn);
    spar_session_destroy(&session);
}

int main(void) {
    check_clock();
    check_texts();
    return failures > 0;
}
