/* What a beam's host says of it, and how that becomes nodes and a body. */
#ifndef SPARI_BEAM_H
#define SPARI_BEAM_H

#include "../math/basis.h"
#include "body.h"
#include "structure.h"

struct spari_beam {
    int64_t axis_count, section_count;
    double *eta, *xyz, *twist; /* axis points */
    double *node_x, *node_q;   /* nodes given instead */
    double *section_eta, *stiffness, *mass;
    int64_t lump_count; /* bodies that sit on it: eta and 6x6 mass of each */
    double *lump_eta, *lump;
    int64_t
        spring_count; /* stations of springs to the ground: eta and stiffness along the section's axes [3] of each */
    double *spring_eta, *spring;
    int64_t pre_count; /* stations of pretension: eta and section forces, local axes [6] of each */
    double *pre_eta, *pre;
    int rule, points; /* rule -1: chosen by what the sections are */
    double mu[6];
    int damped;
    double drag; /* 1/s, damping by mass */
};

/* Fills member->xr, qr (placed) from the axis or the nodes given. */
int spari_beam_place_nodes(spar_member *member);
/* Tells the log where the elements have too few nodes for the stiffness of their sections. */
void spari_beam_tell_locking(const spar_member *member);
/* Builds the body; the description has been checked. massive: with mass, whatever effects are in force; mu: of its
   damping, NULL: none. */
int spari_beam_build(const spar_member *member, int massive, const double mu[6], spari_body **body);
/* Gives a damped body the beam's damping by mass, if there is any. */
int spari_beam_drag(const spar_member *member, spari_body *body);
void spari_beam_free(spari_beam *beam);
/* Body k of those that sit on a beam: its element, and where on it. */
int spari_lump_element(const spar_member *member, int64_t k, double *xi);
/* How many of them sit on element e. */
int spari_lumps_of(const spar_member *member, int e);
/* Their weight in the sums over its body's points: 1, or 0 to leave them out of these. */
void spari_lumps_weigh(const spar_member *member, double weight);
/* Whether a beam can have those it has been given; at commit. */
int spari_lumps_check(const spar_member *member);
enum { SPARI_LUMPS = 10000 }; /* at most */
/* The section forces [6] of the reference at eta, local axes; there are some. */
void spari_pretension_at(const spari_beam *beam, double eta, double out[6]);
/* The quadrature rule in force. */
int spari_beam_rule(const spari_beam *beam);
/* How many quadrature points it has in other elements; points: of its rule, 0: as described. */
int64_t spari_beam_points(const spar_member *member, int elements, int per_element, int points);

/* 0 if the stiffness is symmetric (1e-6 of the diagonal) and positive definite, else a text that says what is wrong. */
const char *spari_stiffness_fault(const double C[36]);

/* A place of a beam's reference line. The caller gives element and xi. */
typedef struct spari_station {
    int element;
    double xi, jacobian;                                /* ds/dxi */
    double phi[SPARI_MAX_NODES], dphi[SPARI_MAX_NODES]; /* dphi per arc length */
    double x[3], t[3], R[9];                            /* place, unit tangent, section axes (columns), global */
} spari_station;

int spari_beam_stations(const spar_member *member, int64_t n, spari_station *s);
/* A table [n][width], local axes, at eta: out [width], linear between stations, constant beyond the first and last. */
void spari_beam_table_at(int64_t n, const double *stations, const double *table, int width, double eta, double *out);
/* T C T^T with T = diag(R, R) */
void spari_beam_turn_section(const double R[9], const double *C, double *out);
/* The section's table of 36 (beam->stiffness or beam->mass) at eta, local axes. */
void spari_beam_section_at(const spari_beam *beam, const double *table, double eta, double out[36]);

/* A rigid body of 6x6 mass (about its node, in its own axes) as a body of one node. */
int spari_rigid_build(spar_member *member, spari_body **body);

/* m, c, J of a 6x6 mass matrix in the order (axial, shear y, shear z, torsion, bending y, bending z); 0 if it has that
   form, else a text that says what is wrong. */
const char *spari_mass_split(const double M[36], double *m, double c[3], double J[6]);
/* The same turned by R (row-major, local to global) into a row of spari_body.mass. */
void spari_mass_place(const double R[9], const double M[36], double out[10]);

#endif
