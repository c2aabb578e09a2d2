#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "turbine_discon.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void (*discon_function)(float *swap, int *fail, char *input, char *output, char *message);

/* Records of the interface, from 1 as in its manual (Bladed user manual, appendix A); texts are not ended by 0 for all
   libraries, so their lengths go with them. */
enum {
    STATUS = 1,
    TIME = 2,
    STEP = 3,
    PITCH_1 = 4,
    SHAFT_POWER = 14,
    POWER = 15,
    GENERATOR_SPEED = 20,
    ROTOR_SPEED = 21,
    TORQUE = 23,
    WIND = 27,
    INDIVIDUAL = 28, /* 0: collective pitch, 1: of each blade */
    OUT_OF_PLANE_1 = 30,
    PITCH_2 = 33,
    PITCH_3 = 34,
    DEMAND_PITCH_1 = 42,
    DEMAND_PITCH = 45,
    DEMAND_TORQUE = 47,
    MESSAGE_LENGTH = 49,
    INPUT_LENGTH = 50,
    OUTPUT_LENGTH = 51,
    TOP_FORE = 53,
    TOP_SIDE = 54,
    AZIMUTH = 60,
    BLADES = 61,
    OUTPUT_MOST = 64,
    IN_PLANE_1 = 69,
    RECORDS = 3300, /* ROSCO has its own behind those of the manual, up to 3300 */
    TEXT = 1024
};

struct turbine_discon {
    void *library;
    discon_function call;
    float swap[RECORDS + 1]; /* [0] is not used */
    char input[TEXT], output[TEXT], message[TEXT];
    int called;
};

static int refuse(char *message, int size, const char *what, const char *why) {
    (void)snprintf(message, (size_t)size, "controller: %.400s: %.500s", what, why);
    return 1;
}

int turbine_discon_open(const char *library, const char *input, turbine_discon **discon, char *message, int size) {
    turbine_discon *d = calloc(1, sizeof *d);
    FILE *file = fopen(input, "r");
    if (!d || !file || strlen(input) >= TEXT) {
        free(d);
        if (file) {
            (void)fclose(file);
        }
        return refuse(message, size, input,
                      !d      ? "no memory"
                      : !file ? "cannot be read; --controller-input names the "
                                "controller's own file"
                              : "the path is too long");
    }
    (void)fclose(file);
    d->library = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!d->library) {
        const char *why = dlerror();
        free(d);
        return refuse(message, size, library, why ? why : "cannot be opened");
    }
    void *found = dlsym(d->library, "DISCON");
    memcpy(&d->call, &found, sizeof found); /* an object pointer is no function pointer in ISO C */
    if (!found) {
        (void)dlclose(d->library);
        free(d);
        return refuse(message, size, library, "has no function DISCON; a controller of the Bladed interface is wanted");
    }
    (void)snprintf(d->input, sizeof d->input, "%s", input);
    (void)snprintf(d->output, sizeof d->output, "turbine-controller");
    *discon = d;
    return 0;
}

static void fill(turbine_discon *d, const turbine_measures *m) {
    float *s = d->swap;
    s[TIME] = (float)m->t;
    s[STEP] = (float)m->dt;
    s[PITCH_1] = s[PITCH_2] = s[PITCH_3] = (float)m->pitch;
    s[SHAFT_POWER] = (float)(m->torque * m->generator_speed);
    s[POWER] = (float)m->power;
    s[GENERATOR_SPEED] = (float)m->generator_speed;
    s[ROTOR_SPEED] = (float)m->rotor_speed;
    s[TORQUE] = (float)m->torque;
    s[WIND] = (float)m->wind;
    s[TOP_FORE] = (float)m->top_fore;
    s[TOP_SIDE] = (float)m->top_side;
    s[AZIMUTH] = (float)m->azimuth;
    s[BLADES] = 3;
    for (int b = 0; b < 3; b++) {
        s[OUT_OF_PLANE_1 + b] = (float)m->root_moment[b];
        s[IN_PLANE_1 + b] = (float)m->in_plane[b];
    }
    s[MESSAGE_LENGTH] = TEXT - 1;
    s[INPUT_LENGTH] = (float)strlen(d->input);
    s[OUTPUT_LENGTH] = (float)strlen(d->output);
    s[OUTPUT_MOST] = TEXT - 1;
}

/* Fortran pads with blanks, and may leave no 0. */
static const char *text_of(char text[TEXT]) {
    text[TEXT - 1] = '\0';
    for (size_t n = strlen(text); n > 0 && (text[n - 1] == ' ' || text[n - 1] == '\n'); n--) {
        text[n - 1] = '\0';
    }
    return text;
}

int turbine_discon_step(turbine_discon *d, const turbine_measures *m, turbine_control *control, char *message,
                        int size) {
    int fail = 0;
    float *s = d->swap;
    fill(d, m);
    s[STATUS] = d->called ? 1 : 0;
    d->message[0] = '\0';
    d->call(s + 1, &fail, d->input, d->output, d->message);
    d->called = 1;
    if (fail < 0) {
        const char *why = text_of(d->message);
        return refuse(message, size, d->input, why[0] ? why : "failed without a message");
    }
    double pitch = s[DEMAND_PITCH], torque = s[DEMAND_TORQUE];
    if (s[INDIVIDUAL] == 1) {
        pitch = s[DEMAND_PITCH_1];
        if (s[DEMAND_PITCH_1 + 1] != s[DEMAND_PITCH_1] || s[DEMAND_PITCH_1 + 2] != s[DEMAND_PITCH_1]) {
            return refuse(message, size, d->input,
                          "demands another pitch of each blade, and this turbine has one; switch individual pitch off");
        }
    }
    if (!isfinite(pitch) || !isfinite(torque)) {
        return refuse(message, size, d->input, "demands a pitch or torque that is no number");
    }
    control->rate = (pitch - control->pitch) / m->dt;
    control->pitch = pitch;
    control->torque = torque;
    return 0;
}

void turbine_discon_close(turbine_discon **discon) {
    turbine_discon *d = discon ? *discon : NULL;
    if (!d) {
        return;
    }
    if (d->called) {
        int fail = 0;
        d->swap[STATUS] = -1;
        d->call(d->swap + 1, &fail, d->input, d->output, d->message);
    }
    (void)dlclose(d->library);
    free(d);
    *discon = NULL;
}
