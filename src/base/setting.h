/* A setting: one row of a table (session/settings.c, fluid/options.c), and how its value is stored and written. */
#ifndef SPARI_SETTING_H
#define SPARI_SETTING_H

#include "message.h"

#include <stddef.h>

typedef struct spari_setting {
    const char *name; /* full name: "rho_inf of spar_session_set_integrator" */
    const char *key;  /* name of the option or argument; NULL: the effect of a call, compared between ranks only */
    size_t field;     /* offset in the object that has the setting */
    enum { SPARI_IS_REAL, SPARI_IS_WHOLE, SPARI_IS_WORD } kind; /* double, int, or int with words for 0 and 1 */
    int by;                                                     /* call that sets it */
    double least, most;
    const char *range, *words[2]; /* allowed values, in words */
    double initial;
    int flags; /* SPARI_AGREED, ... */
} spari_setting;
enum {
    SPARI_AGREED = 1,      /* must agree across ranks: compared in collective calls */
    SPARI_OF_COUPLING = 2, /* the coupling depends on it: it is created anew after a change, and saved with it */
    SPARI_VARIED = 4       /* varied by trials and advice */
};

/* The row of a table with this key, of those set by this call (0 in tables of options alone); NULL: there is none. */
const spari_setting *spari_setting_find(const spari_setting *table, int count, int by, const char *key);
/* The keys of such rows, "a, b, c", written into text[size]; returns text. */
const char *spari_setting_keys(const spari_setting *table, int count, int by, char *text, size_t size);
/* Present value of a setting of an object, a session or a fluid; and stores one. */
double spari_setting_value(const void *object, const spari_setting *of);
void spari_setting_store(void *object, const spari_setting *of, double x);
int spari_setting_allows(const spari_setting *of, double x);
/* Whether the text is a value of the option. */
int spari_setting_read(const spari_setting *of, const char *text, double *x);
/* Writes the value x as a text that spari_setting_read takes, into text[capacity]: whole, or refused by `call`. */
int spari_setting_write(const spar_session *session, const char *call, const spari_setting *of, double x,
                        int64_t capacity, char *text);

#endif
