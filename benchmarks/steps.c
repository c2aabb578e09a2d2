/* Steps of random length: how fast an undamped oscillator x'' + x = 0 grows or fades, by scheme; CSV on standard
   output.

   steps       rho_inf, factor, omega dt, then of each scheme the growth of the amplitude a step, as exponent: the
               largest of ten sequences. Between omega dt / factor and omega dt times factor steps are random (four
               sequences), random and kept for one to four steps (four), or alternate (two)

   kept        generalised-alpha (Chung & Hulbert, J. Appl. Mech. 60 (1993)), its algorithmic acceleration carried over
   restarted   the same, which begins each step with the true acceleration
   tr_bdf2     TR-BDF2 (Bank et al. 1985), as Hosea & Shampine (Appl. Numer. Math. 20 (1996)) write it
   spar        the library: a rigid body on a spring

   A sequence has 200 steps, or ends where the amplitude is 1e-4 or 1e100 of what it was. */
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { KEPT, RESTARTED, TR_BDF2, SPAR, SCHEMES, STEPS = 200, SEQUENCES = 10 };

/* x, v, the true acceleration and the algorithmic one */
typedef struct oscillator {
    double x, v, q, a;
} oscillator;

/* Balance at the end: -x1 (1 - alpha_f) - x alpha_f = (1 - alpha_m) a1 + alpha_m a */
static void step_alpha(oscillator *o, double h, double rho) {
    const double am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1), gamma = 0.5 - am + af,
                 beta = 0.25 * (1 - am + af) * (1 - am + af);
    const double c = (af * o->q - am * o->a) / (1 - am), d = (1 - af) / (1 - am);
    const double x = (o->x + h * o->v + h * h * ((0.5 - beta) * o->a + beta * c)) / (1 + h * h * beta * d),
                 a = c - d * x;
    o->v += h * ((1 - gamma) * o->a + gamma * a);
    o->x = x, o->q = -x, o->a = a;
}

/* y1 = (1 - e A)^-1 b with A = [0 1; -1 0] */
static void solve(double e, const double b[2], double y[2]) {
    y[0] = (b[0] + e * b[1]) / (1 + e * e);
    y[1] = (b[1] - e * b[0]) / (1 + e * e);
}

static void step_tr_bdf2(oscillator *o, double h) {
    const double g = 2 - sqrt(2), y[2] = {o->x, o->v}, half = 0.5 * g * h,
                 first[2] = {y[0] + half * y[1], y[1] - half * y[0]};
    double middle[2], second[2], end[2];
    solve(half, first, middle);
    for (int i = 0; i < 2; i++) {
        second[i] = (middle[i] - (1 - g) * (1 - g) * y[i]) / (g * (2 - g));
    }
    solve((1 - g) / (2 - g) * h, second, end);
    *o = (oscillator){end[0], end[1], -end[0], -end[0]};
}

/* ---- the library ---- */

static void must(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "steps: %s\n", s ? spar_session_message(s) : spar_status_text(status));
        exit(1);
    }
}

static spar_session *make(double rho, spar_member **body) {
    const double x[3] = {0}, upright[4] = {1, 0, 0, 0}, one[36] = {[0] = 1}, v[3] = {1, 0, 0},
                 mass[36] = {[0] = 1, [7] = 1, [14] = 1, [21] = 1, [28] = 1, [35] = 1};
    spar_session *s = NULL;
    must(NULL, spar_session_create(&s));
    must(s, spar_session_set_integrator(s, rho, 1));
    must(s, spar_session_set_newton(s, 1e-15, 1e-12, 50));
    must(s, spar_rigid_create(s, "body", x, upright, mass, body));
    must(s, spar_member_commit(*body));
    must(s, spar_spring_create(s, "spring", *body, 0, SPAR_FREE_X, one, NULL, NULL, NULL));
    must(s, spar_member_set_initial_velocity(*body, x, v, NULL));
    return s;
}

static void step_spar(spar_session *s, const spar_member *body, oscillator *o, double h) {
    double q[7], v[6];
    must(s, spar_step(s, h, NULL, NULL, NULL));
    must(s, spar_member_get_motion(body, q, v, NULL));
    o->x = q[0], o->v = v[0];
}

/* ---- sequences ---- */

static uint64_t seed;

static double uniform(double from, double to) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return from + (to - from) * (double)(seed >> 11) / 9007199254740992.0;
}

static void draw(int sequence, double mean, double factor, double *h) {
    int left = 0;
    seed = 12345u + (uint64_t)sequence;
    for (int i = 0; i < STEPS; i++) {
        if (sequence >= 8) { /* alternating, by the factor and by its square */
            h[i] = mean * pow(factor, (i % 2 ? 0.5 : -0.5) * (sequence - 7));
        } else if (sequence < 4 || left-- == 0 || i == 0) {
            h[i] = mean * pow(factor, uniform(-1, 1));
            left = (int)uniform(0, 4);
        } else {
            h[i] = h[i - 1];
        }
    }
}

/* Exponent a step */
static double growth(int scheme, double rho, const double *h) {
    oscillator o = {0, 1, 0, 0};
    spar_member *body = NULL;
    spar_session *s = scheme == SPAR ? make(rho, &body) : NULL;
    double size = 1;
    int n = 0;
    while (n < STEPS && size > 1e-4 && size < 1e100) {
        if (scheme == SPAR) {
            step_spar(s, body, &o, h[n]);
        } else if (scheme == TR_BDF2) {
            step_tr_bdf2(&o, h[n]);
        } else {
            o.a = scheme == RESTARTED ? o.q : o.a;
            step_alpha(&o, h[n], rho);
        }
        size = hypot(o.x, o.v);
        n++;
    }
    spar_session_destroy(&s);
    return log(size) / n;
}

int main(void) {
    static const double rho[] = {0.9, 0}, factor[] = {1.1, 3, 1e3};
    printf("rho_inf,factor,omega_dt,kept,restarted,tr_bdf2,spar\n");
    for (int i = 0; i < 6; i++) {
        printf("%s", i ? "\n\n" : "");
        for (int k = 0; k <= 36; k++) {
            const double mean = pow(10, -2 + k / 6.0);
            double worst[SCHEMES] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, h[STEPS];
            for (int q = 0; q < SEQUENCES; q++) {
                draw(q, mean, factor[i % 3], h);
                for (int scheme = 0; scheme < SCHEMES; scheme++) {
                    worst[scheme] = fmax(worst[scheme], growth(scheme, rho[i / 3], h));
                }
            }
            printf("%g,%g,%.4g,%.4g,%.4g,%.4g,%.4g\n", rho[i / 3], factor[i % 3], mean, worst[KEPT], worst[RESTARTED],
                   worst[TR_BDF2], worst[SPAR]);
        }
    }
    return 0;
}
