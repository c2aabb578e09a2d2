/* A beam that is linear in the frame of its root. If the root is fixed or driven, the motion of the root is exact
   and the deformation relative to it is of first order. If the root is free or pinned, the frame stays at the
   reference, and the whole motion is of first order. In the axes of the frame, with x = (w, theta) of the nodes,

      M x'' + (D + G(omega)) x' + (K + N(omega, omega) + E(alpha) + P(a - g)) x
          = loads - M (rigid acceleration - weight) - f(omega, omega)

   G has the Coriolis and gyroscopic terms, E those of the root's angular acceleration. N is the stiffness that the
   rotation omega adds: centrifugal softening, the rotated inertia of the sections, and the geometric stiffness S of the
   axial forces that balance the centrifugal ones. P belongs to the acceleration a of the root less gravity g, in axes
   of the root: a blade on a hub is stretched by Omega^2 times the hub's radius, a mast is softened by its weight. Like
   N and E, P has the geometric stiffness S of the axial forces that balance its inertia forces, here M times a constant
   acceleration, and their moments on the rotated sections. All matrices come from the tangents of the exact member at
   the reference, so the response is that of the exact member in the limit of small deformation. N, E and P are those of
   rotation vectors, so N and P are symmetric. A free root has no P: its frame stays at the reference, and weight causes
   no axial force in a beam that falls freely. Neglected are terms of second order in x: the geometric stiffness of
   transverse forces, and of applied and fluid loads, axial ones included (spar_beam_set_pretension gives a beam that of
   steady axial forces).

   No joint connects such a beam: with an unknown motion of the frame a step would save little or nothing against the
   exact beam. The time integration and the equilibrium are those of a component without joints (time/component.h).

   The modal member has the same equations in modes of M and K. Its unknowns are the amplitudes of the six rigid motions
   about the root, some of which the root condition sets to zero, and the amplitudes of modes. These are the lowest
   modes of the beam that is clamped at its root if all six are constrained. Otherwise they are those of the beam that
   is free or pinned there. */
#ifndef SPARI_FRAME_H
#define SPARI_FRAME_H

#include "../algebra/linear.h"
#include "../member/body.h"
#include "../member/structure.h"
#include "../time/scheme.h"
#include "../time/tangent_snapshot.h"

struct spari_pencil;

/* The fields of acceleration of a frame, relative to their rates: those of the products omega_i omega_j, of the three
   angular accelerations, of the three translations of the root. */
enum { SPARI_SPIN_PRODUCTS = 6, SPARI_TRANSLATIONS = 9, SPARI_FIELDS = 12 };

/* Rates of the root in its own axes: angular velocity and acceleration, acceleration less gravity. */
enum { SPARI_FRAME_RATES = 9 };

/* Deformation at one time, [n] each: amplitudes, rates, true and algorithmic accelerations. And the root. */
typedef struct spari_frame_state {
    double *y, *v, *a, *b;
    spari_pose root;
} spari_frame_state;

/* The tangent in use, in doubles as it is saved. */
typedef struct spari_frame_tangent_state {
    double factored, cm, cv; /* factored: 0 or 1 */
    double left;             /* estimated remaining correction of the last solution, relative to the length, rad */
    double rates[SPARI_FRAME_RATES];
} spari_frame_tangent_state;

typedef struct spari_frame {
    int nodes;                    /* unique nodes */
    int constrained;              /* so many of the root's six unknowns, the first ones, are zero */
    int elements, block, overlap; /* of the matrices */
    int n;                        /* unknowns, the root's six first */
    int64_t size;                 /* doubles of one matrix: elements * block * block */
    double
        *gram; /* modal: [n][n] products of the basis' columns, factored, once spari_frame_effective_load was called */
    double *basis;     /* modal: [6 nodes][n]; NULL: the unknowns are those of the nodes */
    double *K, *M, *D; /* [elements][block][block]; M, D NULL: none */
    double *A;         /* the fluid's added mass, likewise */
    double *dense_A;   /* if it is learned: [block][block + n] of the nodes' blocks */
    double *N[SPARI_SPIN_PRODUCTS], *G[3],
        *f[SPARI_SPIN_PRODUCTS]; /* NULL if the frame cannot rotate or there is no inertia */
    double *E[3];                /* of the root's angular acceleration, if there is N */
    double *P[3];                /* of the root's acceleration less gravity; NULL: there was none yet, or no effect */
    double *pull;                /* forces of pretension at the reference, likewise; NULL: none */
    double *rigid[6];            /* M times the rigid accelerations of the frame; NULL: none */
    double rates[SPARI_FRAME_RATES]; /* that the three sums below were formed for */
    int combined;
    double *sumK, *sumC, *sumf;
    spari_linear *linear;
    spari_frame_tangent_state tangent;
    spari_frame_tangent_state begun; /* the same at the beginning of the step, */
    spari_snapshot before;           /* and the factors */
    spari_frame_state begin, from, to;
    spari_steps steps;
    double *r, *dx, *increment;       /* [max(n, 6 nodes)]; so are the loads of the steps */
    double *stage_v;                  /* [n] velocities at the end of a trapezoidal stage */
    double *nodal, *global, *element; /* [18 nodes], [19 nodes], one matrix of an element */
    double *positions;                /* [n] saved unknowns of an equilibrium */
    double *loads, *elastic;          /* [6 nodes] loads and [n] internal forces of the latest iterate */
    int resting;                      /* an equilibrium is sought, not a step */
    int64_t factors, solves;
} spari_frame;

/* ---- operations of the two rows (time/fidelity.h) ---- */

void spari_frame_remass(spar_member *member);
void spari_frame_restart(spar_member *member);
void spari_frame_begin(spar_member *member);
void spari_frame_accept(spar_member *member);
void spari_frame_reject(spar_member *member);
int spari_frame_effective_load(spar_member *member, double *load);
void spari_frame_publish(spar_member *member);
/* Strain energy x^T K x / 2 of the frame's equations, and the work of weight on the shortening of a bent line. If the
   frame is fixed, also their kinetic energy and potential. */
int spari_frame_energy(const spar_member *member, double energy[4]);
/* K + N + P of the motion of the root of member->after, and M. */
int spari_frame_problem(const spar_member *member, struct spari_pencil *to);
int spari_frame_linearise(const spar_member *member, const double w[3], struct spari_pencil *to);
void spari_frame_shape(const spar_member *member, const double *x, double *workspace, double *nodes);
int64_t spari_frame_state_size(const spar_member *member);
void spari_frame_save(const spar_member *member, double *state);
int spari_frame_is_state(const spar_member *member, const double *state, int64_t count);
void spari_frame_load(spar_member *member, const double *state);

/* Overwrites the workspace at the beginning of a solution (base/poison.h). */
void spari_frame_poison(spari_frame *frame);
/* Saves the factors before they are overwritten. */
void spari_frame_keep_factors(spari_frame *frame);

/* ---- shared by the frame_*.c files ---- */

/* The two components of omega in each of the SPARI_SPIN_PRODUCTS products. */
extern const int spari_frame_pair[SPARI_SPIN_PRODUCTS][2];

/* Forms the matrices of the nodes in the memory allocated for them. arm [nodes][3] from the root. Returns a status
   without a message. */
int spari_frame_form(spari_frame *f, const spari_body *body, const double *arm);
/* P of the nodes, before modes: likewise. */
int spari_frame_form_translations(const spari_body *body, const double *arm, double *const P[3]);
/* X[k] += geometric stiffness of the axial forces that balance the field from + k, for `count` fields. q [nodes]: the
   reference. Returns a status without a message. */
int spari_frame_add_stretch(const spari_body *body, const double *arm, const double *q, int from, int count,
                            double *const *X);
/* Lever arms [nodes][3] of the unknowns' nodes from the root; NULL: no memory. The caller frees them. */
double *spari_frame_arms(const spar_member *m);
/* Forms P, once, if the frame has such forces and any of `field` is not zero. Returns a status without a message. */
int spari_frame_weigh(spari_frame *f, const spar_member *m, const double field[3]);
/* rates := those of the root. still: without its accelerations. factor: of gravity. */
void spari_frame_rates(const spar_member *m, const spari_pose *root, int still, double factor,
                       double rates[SPARI_FRAME_RATES]);
/* One matrix of the sum N(omega, omega) + E(alpha) + P(a - g). */
typedef struct spari_frame_term {
    double factor;
    const double *X;
} spari_frame_term;
/* The terms whose factor is not zero. Returns their number. */
int spari_frame_terms(const spari_frame *f, const double rates[SPARI_FRAME_RATES], spari_frame_term term[SPARI_FIELDS]);
/* y [n] += factor * X x for a matrix of the frame */
void spari_frame_add_times(const spari_frame *f, const double *X, const double *x, double factor, double *y);

/* K + N + E + P, D + G and f of these rates. They are formed only if these have changed. Returns a status without a
   message. */
int spari_frame_combine(spari_frame *f, const spar_member *m, const double rates[SPARI_FRAME_RATES]);
/* The motion q, v, a [unique] of the nodes of a state. */
void spari_frame_to_nodes(spari_frame *f, const spar_member *m, const spari_frame_state *s, double *q, double *v,
                          double *a);
/* x [6 nodes] := deformation of the unknowns y. Returns x, or y if the unknowns are those of the nodes. */
const double *spari_frame_nodal(const spari_frame *f, const double *y, double *x);
/* out [n] := loads on the unknowns of the nodal loads x [6 nodes], in the frame's axes. */
void spari_frame_gather(const spari_frame *f, const double *x, double *out);
/* Begins a stage of a substep. A driven root is at `root` at the end of the stage; other roots stay. */
void spari_frame_stage(spari_frame *f, const spar_member *m, const spari_scheme *c, const spari_part *part,
                       const spari_pose *root);
double spari_frame_damped_power(spari_frame *f, const spari_frame_state *s);
/* Columns of the basis: the six rigid motions about the root, of which the first `constrained` are zero, then the
   lowest modes. The free columns are orthonormal in the norm of the mass. arm [nodes][3] from the root. */
int spari_frame_fill_basis(spari_frame *f, const double *arm, int cols);
/* Projects the matrices and vectors of the nodes onto the basis. 1: no memory. */
int spari_frame_project(spari_frame *f, const spar_member *m, int cols);
/* *X := basis^T X basis of a matrix of the nodes of `body`. 1: no memory. */
int spari_frame_project_matrix(const spari_frame *f, const spari_body *body, int cols, double **X);

/* Forces r [n] of the state s. still: without inertia. factor: of loads and gravity. Returns the scale to which their
   rounding is relative. Without memory for P the forces are NaN, and the solution is refused. */
double spari_frame_forces(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still, double factor,
                          double *r);
/* Forms and factors the tangent for the latest forces. cm, cv: rates of the unknowns per change. Returns 0, or 1 if it
   is singular. */
int spari_frame_tangent(spari_frame *f, double cm, double cv);

#endif
