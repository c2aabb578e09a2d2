/* Warns of the damping ratios that modes get which a choice of damping by ratios did not name: other modes of the
   member, and those of its assembly. */
#include "plausible_damping.h"

#include "../assembly/assembly.h"
#include "../base/session.h"
#include "../member/body.h"
#include "modes.h"

#include <math.h>
#include <stdlib.h>

static const double two_pi = 6.283185307179586;

/* Factors on the ratios chosen beyond which a ratio is told. A stiffness-proportional ratio grows with the frequency,
   so above the modes chosen the upper one does too. */
static const double few = 3, half = 0.5;
/* A mode of the assembly is this member's if the member has this part of the strain energy, as a blade of several. */
static const double own_part = 0.1;
/* Part of the lowest frequency chosen below which a mode is a motion of rigid bodies. */
static const double rigid = 1e-3;

/* Modes of unit modal mass, about the present state. */
typedef struct found_modes {
    int64_t n;
    double *frequency, *shapes, *x, *workspace;
} found_modes;

/* What the member's body adds to x^T S x, S its tangent with the factors `stiffness` of its load and cv of its damping
 */
static void quadratic_forms(const spari_body *b, const double *q, const double *x, double *S, double *stiff,
                            double *damping) {
    int P = b->per_element, n = 6 * P;
    *stiff = *damping = 0;
    for (int e = 0; e < b->elements; e++) {
        const double *xe = x + 6 * (int64_t)e * (P - 1);
        for (int damped = 0; damped < 2; damped++) {
            double sum = 0;
            spari_body_tangent(b, e, q, NULL, NULL, 1, 0, damped, NULL, S);
            for (int i = 0; i < n; i++) {
                for (int j = 0; j < n; j++) {
                    sum += xe[i] * S[n * i + j] * xe[j];
                }
            }
            *stiff += damped ? 0 : sum;
            *damping += damped ? sum : -sum;
        }
    }
}

/* Fewer modes if there are not so many; 1: none, which is no failure: the choice has been made. */
static int find_modes(const spar_member *m, int connected, int64_t n, found_modes *f) {
    char message[SPARI_MESSAGE_SIZE], *before = spari_messages_redirect(message);
    int64_t u = m->body->unique, P = m->mesh.per_element;
    int status = connected ? spari_joints_place(m->session) : SPAR_OK;
    *f = (found_modes){.n = n, .frequency = spari_zalloc(n * (1 + 6 * m->nodes) + 13 * u + 36 * P * P, sizeof(double))};
    if (f->frequency && status == SPAR_OK) {
        f->shapes = f->frequency + n, f->x = f->shapes + 6 * m->nodes * n, f->workspace = f->x + 13 * u;
        while (f->n > 0 && spari_modes(m, connected, f->n, f->frequency, f->shapes) != SPAR_OK) {
            f->n /= 2;
        }
    }
    (void)spari_messages_redirect(before);
    return !f->frequency || status != SPAR_OK || f->n == 0;
}

static void warn_of_other(const spar_member *m, int connected, int64_t mode, double frequency, double ratio,
                          const spari_damping_asked *asked) {
    if (connected) {
        spari_warn(m->session,
                   "member '%s': mode %lld of its assembly (%.4g Hz) gets the damping ratio %.3g from this member; the "
                   "ratios chosen, %.3g to %.3g, are those of the member without joints; give a top mass by "
                   "spar_beam_set_masses, or set mu by spar_beam_set_damping, and look at "
                   "spar_member_solve_eigenvalues",
                   m->name, (long long)mode, frequency, ratio, asked->least, asked->most);
        return;
    }
    spari_warn(m->session,
               "member '%s': mode %lld (%.4g Hz) gets the damping ratio %.3g, although the largest ratio chosen is "
               "%.3g; choose a ratio for this mode too in spar_beam_fit_damping, or bring the ratios of similar modes "
               "closer together",
               m->name, (long long)mode, frequency, ratio, asked->most);
}

static void tell_modes(const spar_member *m, int connected, const spari_damping_asked *asked) {
    found_modes f;
    const spari_body *b = m->body;
    if (find_modes(m, connected, asked->modes, &f) == 0) {
        double *q = f.x + 6 * (int64_t)b->unique;
        spari_member_to_unique(m, 7, m->after.q, q);
        for (int64_t k = 0; k < f.n; k++) {
            double omega = two_pi * f.frequency[k], stiff, damping;
            if (!isfinite(omega) || !(omega > rigid * asked->lowest)) {
                continue;
            }
            spari_member_to_unique(m, 6, f.shapes + 6 * m->nodes * k, f.x);
            quadratic_forms(b, q, f.x, f.workspace, &stiff, &damping);
            double part = connected ? stiff / (omega * omega) : 1, ratio = damping / (2 * omega * part);
            if (part > own_part && (ratio > few * asked->most * fmax(1, omega / asked->highest) ||
                                    (connected && ratio < half * asked->least))) {
                warn_of_other(m, connected, k, f.frequency[k], ratio * part, asked);
                break;
            }
        }
    }
    free(f.frequency);
}

void spari_damping_tell_plausible(const spar_member *m, const spari_damping_asked *asked) {
    tell_modes(m, 0, asked);
    if (m->joint_count > 0) {
        tell_modes(m, 1, asked);
    }
}
