/* Description of a beam by its host, and its conversion to nodes and a body. */
#ifndef SPARI_BEAM_H
#define SPARI_BEAM_H

#include "../math/basis.h"
#include "body.h"
#include "structure.h"

struct spari_beam {
    int64_t axis_count, section_count;
    double *eta, *xyz, *twist; /* axis points */
    double *node_x, *node_q;   /* nodes, if given instead */
    double *section_eta, *stiffness, *mass;
    spari_line_table point_masses; /* 6x6 mass of each */
    spari_line_table springs;      /* to the ground: stiffness along the section's axes [3] */
    spari_line_table pretension;   /* section forces, local axes [6] */
    int rule, points;              /* rule -1: chosen from the sections */
    double mu[6];
    int damped;
    int damped_by_ratios; /* of its modes, and no joint has been created since */
    double mass_damping;  /* 1/s, mass-proportional damping */
    int planar;           /* held in a plane, with this unit normal */
    double normal[3];
};

/* The line through the axis points, smooth between its corners (axis.c). */
/* Smooth pieces of the line: piece k runs from axis point first[k] to axis point first[k + 1]. */
typedef struct spari_pieces {
    int64_t count, *first; /* [count + 1], the caller frees it */
} spari_pieces;

/* Finds the corners, which are axis points on element boundaries. Refuses a corner inside an element. */
int spari_axis_pieces(const spar_member *member, spari_pieces *pieces);
/* x [nodes][3]: nodes on the line, before placement. gll, bary: of an element's nodes (spari_gll). */
int spari_axis_fit(const spar_member *member, const spari_pieces *pieces, const double *gll, const double *bary,
                   double *x);
/* Unit tangent at axis point i of piece k. */
void spari_axis_tangent(const spari_beam *beam, const spari_pieces *pieces, int64_t k, int64_t i, double t[3]);

/* Computes member->xr, qr (placed) from the axis or the given nodes. */
int spari_beam_place_nodes(spar_member *member);
/* Logs a warning if elements have too few nodes for the stiffness of their sections. */
void spari_beam_tell_locking(const spar_member *member);
/* Of a placed beam: finds the bending of an element from which it locks in a motion. After a step: warns once of such
   an element. */
void spari_beam_find_locking(spar_member *member);
void spari_beam_check_locking(spar_member *member);
/* Warns if its line swings between the axis points. */
void spari_beam_tell_line(const spar_member *member);
/* Warns if its twist, sections or estimated first frequency are implausible; logs mass, length and this
   frequency. */
void spari_beam_tell_plausible(const spar_member *member);
/* Builds the body of a checked description. massive: with mass, whatever effects are in force. mu: damping
   coefficients; NULL: none. */
int spari_beam_build(const spar_member *member, int massive, const double mu[6], spari_body **body);
/* Adds mass-proportional damping, if any, to a damped body. */
int spari_beam_mass_damping(const spar_member *member, spari_body *body);
void spari_beam_free(spari_beam *beam);
/* Element of attached mass k, and its local coordinate. */
int spari_point_mass_element(const spar_member *member, int64_t k, double *xi);
/* Number of attached masses on element e. */
int spari_point_masses_of(const spar_member *member, int e);
/* Sets their weight in sums over the body's points: 1, or 0 to exclude them. */
void spari_point_masses_weight(const spar_member *member, double weight);
/* Checks the attached masses at commit. */
int spari_point_masses_check(const spar_member *member);
enum { SPARI_MOST_STATIONS = 10000 }; /* of attached masses, foundation and pretension */
/* Section forces [6] of the reference at eta, local axes; the beam must have pretension. */
void spari_pretension_at(const spari_beam *beam, double eta, double out[6]);
/* Quadrature rule in force. */
int spari_beam_rule(const spari_beam *beam);

/* NULL if the stiffness is symmetric (1e-6 of the diagonal) and positive definite, otherwise a text that describes
   the error. */
const char *spari_stiffness_fault(const double C[36]);
/* Whether a section's stiffness looks as if it were in the order of BeamDyn. */
int spari_section_is_other_order(const double K[36]);

/* A point of a beam's reference line. The caller sets element and xi. */
typedef struct spari_station {
    int element;
    double xi, jacobian;                                /* ds/dxi */
    double phi[SPARI_MAX_NODES], dphi[SPARI_MAX_NODES]; /* dphi with respect to arc length */
    double x[3], t[3], R[9];                            /* position, unit tangent, section axes (columns), global */
} spari_station;

int spari_beam_stations(const spar_member *member, int64_t n, spari_station *s);
/* out [width]: table [n][width], local axes, at eta. Linear between stations, constant beyond the first and last. */
void spari_beam_table_at(int64_t n, const double *stations, const double *table, int width, double eta, double *out);
/* T C T^T with T = diag(R, R) */
void spari_beam_rotate_section(const double R[9], const double *C, double *out);
/* The section's table of 36 (beam->stiffness or beam->mass) at eta, local axes. */
void spari_beam_section_at(const spari_beam *beam, const double *table, double eta, double out[36]);

/* Builds a rigid body of 6x6 mass (about its node, in its own axes) as a body of one node. */
int spari_rigid_build(spar_member *member, spari_body **body);

/* Splits a 6x6 mass matrix in the order (axial, shear y, shear z, torsion, bending y, bending z) into m, c, J.
   Returns NULL, or a text that describes the error. */
const char *spari_mass_split(const double M[36], double *m, double c[3], double J[6]);
/* Whether no body has such an inertia: the largest principal moment [2] exceeds the sum of the others [0], [1]. moment:
   out, about the centre of mass, ascending. */
int spari_inertia_is_impossible(const double M[36], double moment[3]);
/* The same, rotated by R (row-major, local to global), as a row of spari_body.mass. */
void spari_mass_rotate(const double R[9], const double M[36], double out[10]);

#endif
