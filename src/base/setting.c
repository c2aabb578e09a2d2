/* Values of settings: stored in an object by the row of a table, read from and written as text. */
#include "setting.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const spari_setting *spari_setting_find(const spari_setting *table, int count, int by, const char *key) {
    for (int i = 0; i < count; i++) {
        if (table[i].by == by && table[i].key && strcmp(table[i].key, key) == 0) {
            return table + i;
        }
    }
    return NULL;
}

const char *spari_setting_keys(const spari_setting *table, int count, int by, char *text, size_t size) {
    size_t n = 0;
    text[0] = '\0';
    for (int i = 0; i < count; i++) {
        if (table[i].key && table[i].by == by && n < size) {
            n += (size_t)snprintf(text + n, size - n, "%s%s", n ? ", " : "", table[i].key);
        }
    }
    return text;
}

double spari_setting_value(const void *object, const spari_setting *of) {
    const void *field = (const char *)object + of->field;
    return of->kind == SPARI_IS_REAL ? *(const double *)field : *(const int *)field;
}

void spari_setting_store(void *object, const spari_setting *of, double x) {
    void *field = (char *)object + of->field;
    if (of->kind == SPARI_IS_REAL) {
        *(double *)field = x;
    } else {
        *(int *)field = (int)x;
    }
}

int spari_setting_allows(const spari_setting *of, double x) {
    return x >= of->least && x <= of->most && (of->kind == SPARI_IS_REAL || x == floor(x));
}

int spari_setting_read(const spari_setting *of, const char *text, double *x) {
    if (of->kind == SPARI_IS_WORD) {
        *x = strcmp(text, of->words[1]) == 0;
        return *x > 0 || strcmp(text, of->words[0]) == 0;
    }
    char *end;
    *x = strtod(text, &end);
    return end != text && *end == '\0' && spari_setting_allows(of, *x);
}

int spari_setting_write(const spar_session *session, const char *call, const spari_setting *of, double x,
                        int64_t capacity, char *text) {
    char value[40] = "";
    if (of->kind == SPARI_IS_WORD) {
        (void)snprintf(value, sizeof value, "%s", of->words[x > 0]);
    } else { /* the shortest text that is read as the same number */
        for (int digits = 15; digits <= 17 && (digits == 15 || strtod(value, NULL) != x); digits++) {
            (void)snprintf(value, sizeof value, "%.*g", digits, x);
        }
    }
    int64_t needed = (int64_t)strlen(value) + 1;
    SPARI_TRY(spari_need_capacity(session, call, capacity));
    SPARI_REQUIRE(session, capacity >= needed, SPAR_ERR_ARGUMENT,
                  "%s: the value of '%s' needs %lld characters; the buffer has %lld", call, of->key, (long long)needed,
                  (long long)capacity);
    memcpy(text, value, (size_t)needed);
    return SPAR_OK;
}
