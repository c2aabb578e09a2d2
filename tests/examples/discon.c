/* A controller library of the Bladed interface for tests/examples/controller: the published controller behind the
   function DISCON. Its input file has one word: follow, or how to go wrong after half a second (fail, nan, individual).
 */
#include "turbine_control.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void DISCON(float *swap, int *fail, char *input, char *output, char *message);

void DISCON(float *swap, int *fail, char *input, char *output, char *message) {
    static turbine_control control;
    static char word[16];
    const float *s = swap - 1; /* records count from 1 */
    (void)output;
    *fail = 0;
    if (s[1] < 0) {
        return;
    }
    if (s[1] == 0) {
        FILE *file = fopen(input, "r");
        if (!file || strlen(input) != (size_t)s[50] || fscanf(file, "%15s", word) != 1) {
            *fail = -1;
            (void)snprintf(message, (size_t)s[49], "the input was not read");
        }
        if (file) {
            (void)fclose(file);
        }
        turbine_control_begin(&control, s[20], s[4]);
    }
    turbine_control_step(&control, s[20], s[3]);
    int late = s[2] > 0.5F;
    swap[44] = (float)control.pitch;
    swap[46] = late && strcmp(word, "nan") == 0 ? NAN : (float)control.torque;
    for (int b = 0; b < 3; b++) {
        swap[41 + b] = (float)control.pitch + (late && strcmp(word, "individual") == 0 ? 0.01F * (float)b : 0);
    }
    swap[27] = late && strcmp(word, "individual") == 0 ? 1 : 0;
    if (late && strcmp(word, "fail") == 0) {
        *fail = -1;
        memcpy(message, "generator too hot   ", 20); /* as Fortran leaves it: blanks, and no end */
    }
}
