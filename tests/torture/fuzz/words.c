/* Random words and what becomes of them: arguments, good and odd. */
#include "fuzz.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* splitmix64 */
uint64_t fuzz_next(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

uint64_t fuzz_mix(uint64_t a, uint64_t b) {
    uint64_t state = a * UINT64_C(0xd1342543de82ef95) + b;
    return fuzz_next(&state);
}

uint64_t word(call *c) {
    return fuzz_next(&c->random);
}

int below(call *c, int n) {
    return (int)(word(c) % (uint64_t)n);
}

int chance(call *c, int percent) {
    return below(c, 100) < percent;
}

double uniform(call *c, double lo, double hi) {
    return lo + (hi - lo) * (double)(word(c) >> 11) * 0x1p-53;
}

int odd(call *c) {
    return below(c, 256) < c->odds;
}

void text(call *c, const char *format, ...) {
    if (!c->w->verbose || c->used >= sizeof c->text) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    int n = vsnprintf(c->text + c->used, sizeof c->text - c->used, format, arguments);
    va_end(arguments);
    c->used += n > 0 ? (size_t)n : 0;
}

static const char *comma(const call *c) {
    return c->used > 0 && c->used < sizeof c->text && c->text[c->used - 1] != '(' ? ", " : "";
}

/* ---- memory of the host, exactly as long as it has to be ---- */

static void *hold(call *c, int64_t bytes) {
    if (c->held >= CALL_HOLDS) {
        fuzz_finding("fuzzer", "too many arrays in one call");
    }
    void *p = malloc(bytes > 0 ? (size_t)bytes : 1);
    if (!p) {
        fuzz_finding("fuzzer", "no memory for %lld bytes", (long long)bytes);
    }
    c->hold[c->held++] = p;
    return p;
}

void *arg_out(call *c, int64_t bytes, int may_be_null) {
    if (may_be_null ? chance(c, 20) : odd(c)) {
        text(c, "%sNULL", comma(c));
        return NULL;
    }
    void *p = hold(c, bytes);
    memset(p, 0xff, bytes > 0 ? (size_t)bytes : 1);
    text(c, "%sout[%lld]", comma(c), (long long)bytes / 8);
    return p;
}

/* ---- numbers ---- */

static double odd_real(call *c) {
    static const double list[] = {NAN,     INFINITY, -INFINITY, -1,    0,     -0.0,  5e-324, 1e-308, 1e-200,
                                  1e200,   -1e200,   1e308,     -1e-9, 1e16,  1e100, -1e100, 2,      1.5,
                                  DBL_MAX, -DBL_MAX, 1e-15,     1e8,   3e200, 1e-30, 1e150,  -1e60};
    c->wild = 1;
    return list[below(c, (int)(sizeof list / sizeof *list))];
}

static int odd_int(call *c, int lo, int hi) {
    const int list[] = {-1, 0, INT_MIN, INT_MAX, lo > INT_MIN ? lo - 1 : lo, hi < INT_MAX ? hi + 1 : hi, 1 << 20, -7};
    c->wild = 1;
    return list[below(c, (int)(sizeof list / sizeof *list))];
}

int arg_int(call *c, int lo, int hi) {
    int x = odd(c) ? odd_int(c, lo, hi) : lo + below(c, hi - lo + 1);
    text(c, "%s%d", comma(c), x);
    return x;
}

int arg_limit(call *c, int lo, int hi) {
    static const int list[] = {0, -1, INT_MIN, -1000};
    int x = odd(c) ? list[below(c, 4)] : lo + below(c, hi - lo + 1);
    text(c, "%s%d", comma(c), x);
    return x;
}

int arg_flags(call *c, int all) {
    int x = odd(c) ? odd_int(c, 0, all) : chance(c, 40) ? all : (int)(word(c) & (uint64_t)all);
    text(c, "%s%d", comma(c), x);
    return x;
}

int64_t arg_count(call *c, int64_t lo, int64_t hi) {
    static const int64_t list[] = {0,
                                   -1,
                                   INT64_MIN,
                                   -1000000007,
                                   INT64_MIN + 1,
                                   INT64_MIN / 3,
                                   INT64_MAX,
                                   INT64_MAX / 3 + 1,
                                   INT64_C(1) << 61,
                                   INT64_C(1) << 62};
    int64_t n = odd(c) ? list[below(c, 10)] : lo + below(c, (int)(hi - lo + 1));
    text(c, "%s%lld", comma(c), (long long)n);
    return n;
}

/* Of an array of so many things; of more than there can be, a few. */
int64_t length(int64_t n) {
    return n < 0 ? 0 : n > 1000 ? 4 : n;
}

double arg_real(call *c, double lo, double hi) {
    double x = odd(c) ? odd_real(c) : uniform(c, lo, hi);
    text(c, "%s%.17g", comma(c), x);
    return x;
}

double arg_dt(call *c) {
    static const double list[] = {1e-3, 1e-3, 1e-3, 1e-3, 2e-3, 5e-4, 1e-2};
    double x = odd(c) ? odd_real(c) : list[below(c, 7)];
    text(c, "%s%.17g", comma(c), x);
    return x;
}

static void tell(call *c, const double *x, int64_t n) {
    if (!c->w->verbose) {
        return;
    }
    text(c, "%s{", comma(c));
    for (int64_t i = 0; i < n && i < 40; i++) {
        text(c, "%s%.17g", i > 0 ? "," : "", x[i]);
    }
    text(c, n > 40 ? " ... %lld}" : "}", (long long)n);
}

/* Perhaps NULL, perhaps one odd entry. */
static double *finish(call *c, double *x, int64_t n) {
    if (odd(c)) {
        if (chance(c, 30)) {
            text(c, "%sNULL", comma(c));
            return NULL;
        }
        int times = 1 + (chance(c, 30) ? below(c, 4) : 0);
        for (int k = 0; k < times && n > 0; k++) {
            x[word(c) % (uint64_t)n] = odd_real(c);
        }
    }
    tell(c, x, n);
    return x;
}

double *arg_given(call *c, const double *x, int64_t n) {
    double *copy = hold(c, n * (int64_t)sizeof *copy);
    if (n > 0) {
        memcpy(copy, x, (size_t)n * sizeof *copy);
    }
    return finish(c, copy, n);
}

double *arg_reals(call *c, int64_t n, double lo, double hi) {
    double *x = hold(c, n * (int64_t)sizeof *x);
    for (int64_t i = 0; i < n; i++) {
        x[i] = uniform(c, lo, hi);
    }
    return finish(c, x, n);
}

double *arg_reals_or_null(call *c, int64_t n, double lo, double hi) {
    if (chance(c, 40)) {
        text(c, "%sNULL", comma(c));
        return NULL;
    }
    return arg_reals(c, n, lo, hi);
}

float *arg_floats(call *c, int64_t n, double lo, double hi, int may_be_null) {
    if (may_be_null && chance(c, 50)) {
        text(c, "%sNULL", comma(c));
        return NULL;
    }
    double *x = arg_reals(c, n, lo, hi);
    float *f = x ? hold(c, n * (int64_t)sizeof *f) : NULL;
    for (int64_t i = 0; f && i < n; i++) {
        f[i] = fabs(x[i]) <= (double)FLT_MAX ? (float)x[i] : x[i] > 0 ? INFINITY : x[i] < 0 ? -INFINITY : NAN;
    }
    return f;
}

double *arg_rising(call *c, int64_t n, double lo, double hi) {
    double *x = hold(c, n * (int64_t)sizeof *x);
    for (int64_t i = 0; i < n; i++) {
        x[i] = n == 1 ? lo : lo + (hi - lo) * (double)i / (double)(n - 1);
    }
    return finish(c, x, n);
}

static void random_quaternion(call *c, double q[4], double size) {
    double square = 1;
    for (int i = 1; i < 4; i++) {
        q[i] = uniform(c, -size, size);
        square += q[i] * q[i];
    }
    double factor = (chance(c, 20) ? -1 : 1) / sqrt(square);
    q[0] = factor;
    for (int i = 1; i < 4; i++) {
        q[i] *= factor;
    }
}

double *arg_quaternions(call *c, int64_t n, int may_be_null) {
    if (may_be_null && chance(c, 50)) {
        text(c, "%sNULL", comma(c));
        return NULL;
    }
    double *q = hold(c, 4 * n * (int64_t)sizeof *q);
    for (int64_t i = 0; i < n; i++) {
        random_quaternion(c, q + 4 * i, chance(c, 50) ? 0.3 : 3);
    }
    return finish(c, q, 4 * n);
}

double *arg_motions(call *c, int64_t n) {
    double *q = hold(c, 7 * n * (int64_t)sizeof *q);
    double size = chance(c, 80) ? 1e-4 : 0.5;
    c->wild |= size > 0.1;
    for (int64_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            q[7 * i + k] = uniform(c, -size, size);
        }
        random_quaternion(c, q + 7 * i + 3, size);
    }
    return finish(c, q, 7 * n);
}

/* ---- matrices ---- */

double *arg_mass(call *c, int64_t n, int may_be_null) {
    if (may_be_null && chance(c, 20)) {
        text(c, "%sNULL", comma(c));
        return NULL;
    }
    double *all = hold(c, 36 * n * (int64_t)sizeof *all);
    for (int64_t i = 0; i < n; i++) {
        double *M = all + 36 * i, m = uniform(c, 0.1, 2), e[3] = {0, 0, 0}, J = uniform(c, 0.05, 0.2);
        memset(M, 0, 36 * sizeof *M);
        if (chance(c, 40)) {
            e[1] = 0.1;
            e[2] = -0.05;
        }
        double s[3][3] = {{0, -e[2], e[1]}, {e[2], 0, -e[0]}, {-e[1], e[0], 0}}, ee = e[1] * e[1] + e[2] * e[2];
        for (int a = 0; a < 3; a++) {
            M[7 * a] = m;
            M[7 * (3 + a)] = J;
            for (int b = 0; b < 3; b++) {
                M[6 * (3 + a) + b] = M[6 * b + 3 + a] = m * s[a][b];
                M[6 * (3 + a) + 3 + b] += m * ((a == b ? ee : 0) - e[a] * e[b]);
            }
        }
    }
    return finish(c, all, 36 * n);
}

double *arg_stiffness(call *c, int64_t n) {
    double *all = hold(c, 36 * n * (int64_t)sizeof *all);
    static const double size[6] = {1e5, 3e4, 3e4, 1e3, 2e3, 3e3};
    for (int64_t i = 0; i < n; i++) {
        double *K = all + 36 * i;
        memset(K, 0, 36 * sizeof *K);
        for (int a = 0; a < 6; a++) {
            K[7 * a] = size[a] * uniform(c, 0.5, 2);
        }
        if (chance(c, 40)) {
            K[6 * 3 + 4] = K[6 * 4 + 3] = 200;
        }
    }
    return finish(c, all, 36 * n);
}

/* ---- words ---- */

const char *arg_name(call *c, const char *letter) {
    static const char *const list[] = {NULL,     "",        "%s%n%d%999999d", "\n", " ", "\xff\xfe\x01",
                                       "a/b\\c", "../../x", "<&\"']]>",       "m1", "f1"};
    enum { LONG = 3000 };
    char *name = hold(c, LONG + 1);
    if (!odd(c)) {
        snprintf(name, 32, "%s%lld", letter, (long long)(++c->w->clock % 100000));
    } else if (chance(c, 20)) {
        memset(name, 'x', LONG);
        name[LONG] = '\0';
    } else if (chance(c, 30)) {
        snprintf(name, 32, "%s%lld", letter, (long long)(c->w->clock % 100000)); /* that of the last */
    } else {
        const char *from = list[below(c, (int)(sizeof list / sizeof *list))];
        if (!from) {
            text(c, "%sNULL", comma(c));
            return NULL;
        }
        strcpy(name, from);
    }
    text(c, "%s\"%.40s\"", comma(c), name);
    return name;
}

const char *arg_path(call *c, const char *ending) {
    enum { LONG = 6000 };
    char *path = hold(c, LONG + 1);
    static const char *const list[] = {"", "/nowhere/at/all/x", "%s", ".", "..", "no/such/folder/x.vtu"};
    if (!odd(c)) {
        snprintf(path, LONG, "%s/f%d%s", c->w->folder, below(c, 3), ending);
    } else if (chance(c, 15)) {
        memset(path, 'p', LONG);
        path[0] = '/';
        path[LONG] = '\0';
    } else if (chance(c, 15)) {
        text(c, "%sNULL", comma(c));
        return NULL;
    } else if (chance(c, 30)) { /* one of another kind, or the folder itself */
        snprintf(path, LONG, "%s%s", c->w->folder, chance(c, 50) ? "" : "/f0.spar");
    } else {
        const char *from = list[below(c, 6)];
        snprintf(path, LONG, "%s", strcmp(from, "%s") == 0 || strcmp(from, ".") == 0 ? c->w->folder : from);
    }
    text(c, "%s\"%.60s\"", comma(c), path);
    return path;
}

/* ---- handles ---- */

static void whom(call *c, int session) {
    c->session = c->session >= 0 ? c->session : session;
    const spar_session *s = session >= 0 ? c->w->session[session].s : NULL;
    if (c->asked < 2) {
        c->where[c->asked++] = s;
    }
}

live_session *arg_session(call *c) {
    static live_session none;
    live_session *s = &none;
    if (!odd(c)) {
        int first = c->style & STYLE_RECENT ? 0 : below(c, SESSIONS);
        for (int k = 0; k < SESSIONS && !s->s; k++) {
            s = c->w->session + (first + k) % SESSIONS;
        }
    }
    whom(c, s->s ? (int)(s - c->w->session) : -1);
    text(c, s->s ? "%ss%d" : "%sNULL", comma(c), (int)(s - c->w->session));
    return s;
}

/* A member of the kind asked for, mostly. */
live_member *arg_member(call *c, int kind) {
    static live_member none;
    live_member *found = &none;
    int first = below(c, MEMBERS), any = kind < 0 || chance(c, c->style & STYLE_GOOD ? 0 : 10);
    for (int k = 0; k < MEMBERS; k++) {
        live_member *m = c->w->member + (first + k) % MEMBERS;
        if (m->m && (any || m->kind == kind) && (!found->m || ((c->style & STYLE_RECENT) && m->made > found->made))) {
            found = m;
        }
    }
    found = odd(c) ? &none : found;
    whom(c, found->m ? found->session : -1);
    text(c, found->m ? "%sm%d" : "%sNULL", comma(c), (int)(found - c->w->member));
    return found;
}

live_joint *arg_joint(call *c, int kind) {
    static live_joint none;
    live_joint *found = &none;
    int first = below(c, JOINTS);
    for (int k = 0; k < JOINTS; k++) {
        live_joint *j = c->w->joint + (first + k) % JOINTS;
        int fits = kind == JOINT_ANY || (kind == JOINT_LINE ? j->line : kind == JOINT_DRIVEN ? j->driven : !j->line);
        if (j->j && (fits || odd(c)) && (!found->j || ((c->style & STYLE_RECENT) && j->made > found->made))) {
            found = j;
        }
    }
    found = odd(c) ? &none : found;
    whom(c, found->j ? found->session : -1);
    text(c, found->j ? "%sj%d" : "%sNULL", comma(c), (int)(found - c->w->joint));
    return found;
}

live_fluid *arg_fluid(call *c) {
    static live_fluid none;
    live_fluid *found = &none;
    int first = below(c, FLUIDS);
    for (int k = 0; k < FLUIDS; k++) {
        live_fluid *f = c->w->fluid + (first + k) % FLUIDS;
        if (f->f && (!found->f || ((c->style & STYLE_RECENT) && f->made > found->made))) {
            found = f;
        }
    }
    found = odd(c) ? &none : found;
    whom(c, found->f ? found->session : -1);
    text(c, found->f ? "%sf%d" : "%sNULL", comma(c), (int)(found - c->w->fluid));
    return found;
}

live_aero *arg_aero(call *c) {
    static live_aero none;
    live_aero *found = &none;
    int first = below(c, AEROS);
    for (int k = 0; k < AEROS; k++) {
        live_aero *a = c->w->aero + (first + k) % AEROS;
        if (a->a && (!found->a || ((c->style & STYLE_RECENT) && a->made > found->made))) {
            found = a;
        }
    }
    found = odd(c) ? &none : found;
    whom(c, found->a ? found->session : -1);
    text(c, found->a ? "%sa%d" : "%sNULL", comma(c), (int)(found - c->w->aero));
    return found;
}

live_trial *arg_trial(call *c) {
    static live_trial none;
    live_trial *found = &none;
    int first = below(c, TRIALS);
    for (int k = 0; k < TRIALS; k++) {
        live_trial *t = c->w->trial + (first + k) % TRIALS;
        if (t->t && (!found->t || ((c->style & STYLE_RECENT) && t->made > found->made))) {
            found = t;
        }
    }
    found = odd(c) ? &none : found;
    whom(c, found->t ? found->session : -1);
    text(c, found->t ? "%st%d" : "%sNULL", comma(c), (int)(found - c->w->trial));
    return found;
}

spar_polar *arg_polar(call *c) {
    int k = below(c, POLARS);
    for (int i = 0; i < POLARS && !c->w->polar[k]; i++) {
        k = (k + 1) % POLARS;
    }
    spar_polar *p = odd(c) ? NULL : c->w->polar[k];
    text(c, p ? "%sp%d" : "%sNULL", comma(c), k);
    return p;
}

int64_t nodes_of(const live_member *m) {
    int64_t n = 0;
    return m->m && spar_member_get_count(m->m, &n) == SPAR_OK ? n : 0;
}

int64_t fluid_count(const live_fluid *f, int which) {
    int64_t n = 0;
    which = which == SPAR_NODES_FORCE ? SPAR_NODES_FORCE : SPAR_NODES_MOTION;
    return f->f && spar_fluid_get_count(f->f, which, &n) == SPAR_OK ? n : 0;
}

int64_t fluid_room(const live_fluid *f, int which) {
    int64_t n = fluid_count(f, which), node = 3, component = 1;
    which = which == SPAR_NODES_FORCE ? SPAR_NODES_FORCE : SPAR_NODES_MOTION;
    if (n > 0) {
        (void)spar_fluid_get_layout(f->f, which, &node, &component);
    }
    return n > 0 ? (n - 1) * node + 2 * component + 1 : 0;
}
