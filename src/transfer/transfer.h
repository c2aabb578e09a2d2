/* Fluid nodes tied to a line, and the kernels that move them and gather their loads. Knows no session and no member: it
   works on nodal arrays of `elements` elements with `per_element` GLL nodes each.

   Nodal fields are turned once per call into Chebyshev coefficients per element (spari_field_fill), so that a node
   stores its coordinate and its arm and nothing else; the sum over T_k is as well conditioned as the Lagrange sum, for
   any number of nodes (monomials are not). Loads go the other way through the transposed sums. A point or rigid body is
   one element of one node: there is no sum, and a node stores its arm. */
#ifndef SPARI_TRANSFER_H
#define SPARI_TRANSFER_H

#include "../math/basis.h"
#include "../math/bins.h"
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Nodes are handled in tiles whose buffers stay in the first-level cache; inside a tile they are stored element by
 * element. */
enum { SPARI_TILE = 256, SPARI_LANES_MAX = 16, /* two vectors of eight */ SPARI_ROW = SPARI_TILE + SPARI_LANES_MAX };

typedef struct spari_nodes {
    int64_t n;
    int elements, per_element;
    double *xi;      /* [n] coordinate within the element, in storage order; NULL with one node per element */
    double *con[3];  /* [n] each: from the reference foot to the node, global axes */
    int *element;    /* [n]; NULL when there is only one */
    uint16_t *place; /* [n] storage place -> node within its tile; NULL: as they come */
    uint8_t *flags;  /* [n] SPAR_MAP_*, by node */
    int lanes;       /* widest vectors to use; 0: what the processor has (tests try all) */
    struct spari_crew *const *crew; /* who works on them (base/crew.h); NULL: one thread */
} spari_nodes;

/* Nodes that one thread takes at a time where each is by itself, whole tiles; and at least so many where they are
   summed: the sums of more are sums over such slabs in their order, whoever has made them. */
enum { SPARI_SLAB = 16 * SPARI_TILE, SPARI_SUM_SLAB = 64 * SPARI_TILE };
/* So many are summed lane by lane before the lanes are added. */
enum { SPARI_HELD = 8 * SPARI_TILE };
static inline int64_t spari_slabs(int64_t n, int64_t slab) {
    return (n + slab - 1) / slab;
}

/* Coefficients of the nodal fields of one state, [element][mode][SPARI_FIELDS]. */
enum {
    SPARI_F_PLACE = 0,  /* reference place + displacement */
    SPARI_F_RATE = 3,   /* velocity */
    SPARI_F_QUAT = 6,   /* relative rotation, signs chained along the element */
    SPARI_F_SPIN = 10,  /* nodal: omega (3); consistent: omega q (4) */
    SPARI_F_ACCEL = 14, /* acceleration */
    SPARI_F_TWIST = 17, /* nodal: alpha (3); consistent: alpha q - |omega|^2 q / 2 (4) */
    SPARI_FIELDS = 21
};
/* What of the motion is wanted: places; velocities too; accelerations too, which come with the poses. Poses (rotations,
   and with velocities the angular ones) or-ed to it. */
enum { SPARI_UPTO_PLACE, SPARI_UPTO_RATE, SPARI_UPTO_ACCEL, SPARI_UPTO, SPARI_POSES };

/* What a kernel gives for a tile: rows of SPARI_ROW doubles. */
enum {
    SPARI_R_PLACE = 0,
    SPARI_R_RATE = 3,
    SPARI_R_QUAT = 6, /* not normalised */
    SPARI_R_OMEGA = 10,
    SPARI_R_ACCEL = 13,
    SPARI_R_ALPHA = 16,
    SPARI_ROWS = 19
};

/* Where the host keeps component i of node j: at number j * node + i * component of its array. */
typedef struct spari_layout {
    int64_t node, component;
} spari_layout;

/* Triples of the host: one of the two, or neither. */
typedef struct spari_source {
    const double *d;
    const float *f;
    const spari_layout *layout; /* NULL: [n][3] */
} spari_source;

/* One number of them; the host's array may lie anywhere. */
static inline double spari_source_at(spari_source x, int64_t node, int i) {
    ptrdiff_t at = (ptrdiff_t)(x.layout ? node * x.layout->node + i * x.layout->component : 3 * node + i);
    double d;
    float f;
    if (x.d) {
        memcpy(&d, x.d + at, sizeof d);
        return d;
    }
    memcpy(&f, x.f + at, sizeof f);
    return f;
}

/* Sums the loads leave behind for the audit: fluid-side totals. */
typedef struct spari_audit {
    double force[3], moment[3], power; /* moment about the origin, in the current configuration */
    double force_sum, moment_sum;      /* sums of |fx| + |fy| + |fz|, of the moments handed in likewise */
    double x_max, v_max, omega_max;    /* largest |x|, |v|, |omega| of the nodes */
} spari_audit;

/* Memory for n nodes; the caller fills by spari_nodes_put. NULL: no memory. */
spari_nodes *spari_nodes_create(int64_t n, int elements, int per_element);
void spari_nodes_free(spari_nodes *nodes);
/* Stores the feet: element [n] and local xi [n] and con [n][3] by node. */
void spari_nodes_put(spari_nodes *nodes, const int *element, const double *xi, const double *con, const uint8_t *flags);
/* More than the second-level cache holds: those ahead are asked for; more than any: what is written goes past them. As
   long as memory takes to answer, so many are worked on. */
enum { SPARI_FAR = 1 << 16, SPARI_PAST = 1 << 19, SPARI_ASK = 64 };
/* The node at a storage place, and its element. */
static inline int64_t spari_nodes_node(const spari_nodes *s, int64_t p) {
    return s->place ? p - p % SPARI_TILE + s->place[p] : p;
}
/* Nodes of the tile that begins at `first`. */
static inline int spari_tile_count(const spari_nodes *s, int64_t first) {
    return s->n - first < SPARI_TILE ? (int)(s->n - first) : SPARI_TILE;
}
static inline int spari_nodes_element(const spari_nodes *s, int64_t p) {
    return s->element ? s->element[p] : 0;
}
static inline double spari_nodes_xi(const spari_nodes *s, int64_t p) {
    return s->xi ? s->xi[p] : 0;
}

/* c_k = sum_l m[k][l] f_l: nodal values at the GLL points to Chebyshev coefficients. */
void spari_modal_matrix(int n, double *m);

/* Fills c [elements][P][SPARI_FIELDS] from reference places xr [nodes][3], motion q [nodes][7], v, a [nodes][6]. */
void spari_field_fill(int elements, int per_element, const double *modal, int consistent, int upto, const double *xr,
                      const double *q, const double *v, const double *a, double *c);

/* One tile, beginning at node `first`: the rows of buf that `what` (SPARI_UPTO_*, SPARI_POSES) asks for; c must be
   filled as far. Returns the least |Q|^2 met (0: no rotation can be interpolated there). Rows are in storage order. */
double spari_tile_motion(const spari_nodes *nodes, int64_t first, const double *c, int consistent, int what,
                         double (*buf)[SPARI_ROW]);

/* Places and velocities of all nodes of a point or rigid body to the host's triples, either NULL: not wanted. Returns
   |q|^2. */
double spari_carry(const spari_nodes *nodes, const double *c, double *x, double *v);

/* Places and velocities of `count` nodes of a beam from `first` on straight to the host's triples, of all nodes, either
   NULL: not wanted. single: floats. Where spari_can_move_to says so; else by tiles. The bits are the same. Returns the
   least |Q|^2. */
int spari_can_move_to(const spari_nodes *nodes, int single);
double spari_move_to(const spari_nodes *nodes, int64_t first, int64_t count, const double *c, int consistent,
                     int single, void *x, void *v);

/* Three rows of a tile, in storage order, to the host's triples x [n][3]. */
void spari_tile_store(const spari_nodes *nodes, int64_t first, double (*row)[SPARI_ROW], double *x);
void spari_tile_store_f32(const spari_nodes *nodes, int64_t first, double (*row)[SPARI_ROW], float *x);
/* Before other threads read what spari_tile_store has stored. */
void spari_tiles_end(void);
/* The same to where a layout says, one of the two. */
void spari_tile_store_at(const spari_nodes *nodes, int64_t first, double (*row)[SPARI_ROW], const spari_layout *layout,
                         double *d, float *f);

/* Work space of the loads on a line of so many elements, in doubles: the rows of a tile (loads, polynomials or shape
   functions, what goes between) and sums lane by lane, then sums, one block for each thread and another for the call.
 */
static inline int64_t spari_gather_held(int per_element) {
    return (int64_t)(20 + per_element) * SPARI_ROW;
}
static inline int64_t spari_gather_rows(int per_element) {
    return spari_gather_held(per_element) + (7 * (per_element + 3) + 12) * 8;
}
static inline int64_t spari_gather_share(int64_t nodes) {
    return nodes * 7 * 2 + 22;
}
static inline int64_t spari_gather_room(int elements, int per_element) {
    return spari_gather_rows(per_element) + 2 * spari_gather_share((int64_t)elements * per_element);
}
/* Loads: force, moment (may be none) of all nodes [n][3] -> load [nodes][6]. work: spari_gather_room doubles, at
   the beginning of a cache line, which each thread but the first has of the crew too. nodal
   quaternions q [nodes][7] are needed by the consistent kind. Returns the least |Q|^2. audit NULL: not wanted. */
double spari_gather_loads(const spari_nodes *nodes, const double *modal, const double *c, int consistent,
                          const double *q, spari_source force, spari_source moment, double *work, double *load,
                          spari_audit *audit);

/* The same loads as sums that depend on no order of the nodes and no width of vectors, load [nodes][6]; rounded to
   doubles they differ from those above by rounding. *finite 0: one of the shares is not, or is too large for a double,
   and the sums are of no use. work: as above, its rows alone. */
double spari_bin_loads(const spari_nodes *nodes, const double *modal, int consistent, const double *q,
                       spari_source force, spari_source moment, double *work, spari_bins *load, int *finite);

#endif
