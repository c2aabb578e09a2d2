/* Fluid nodes mapped to a line, and the kernels that move them and sum their loads. Independent of session and
   member: works on nodal arrays of `elements` elements with `per_element` GLL nodes each.
   Nodal fields are converted once per call to Chebyshev coefficients per element (spari_field_fill). So a fluid node
     stores only its coordinate and lever arm. The sum over T_k is as well conditioned as the Lagrange sum for any
     number of nodes; monomials are not. Loads use the transposed sums. A point or rigid body is one element of one
     node: there is no sum, and a node stores its lever arm. */
#ifndef SPARI_TRANSFER_H
#define SPARI_TRANSFER_H

#include "../math/basis.h"
#include "../math/bins.h"
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Nodes are processed in tiles whose buffers fit in the first-level cache. Inside a tile they are stored element by
   element. */
enum { SPARI_TILE = 256, SPARI_LANES_MAX = 16, /* two vectors of eight */ SPARI_ROW = SPARI_TILE + SPARI_LANES_MAX };

typedef struct spari_nodes {
    int64_t n;
    int elements, per_element;
    double *xi;      /* [n] coordinate within the element, in storage order; NULL with one node per element */
    double *con[3];  /* [n] each: lever arm from the reference nearest point to the node, global axes */
    int *element;    /* [n]; NULL if there is only one */
    uint16_t *place; /* [n] storage position -> node within its tile; NULL: in order */
    uint8_t *flags;  /* [n] SPAR_MAP_*, by node */
    int lanes;       /* maximum vector width; 0: as the processor has (tests try all) */
    struct spari_thread_pool *const *pool; /* threads (base/thread_pool.h); NULL: one thread */
} spari_nodes;

/* SPARI_SLAB: nodes per item if nodes are independent, whole tiles. SPARI_SUM_SLAB: minimum if they are summed. More
   nodes are summed in such slabs, in their order, with any number of threads. */
enum { SPARI_SLAB = 16 * SPARI_TILE, SPARI_SUM_SLAB = 64 * SPARI_TILE };
/* Nodes that are summed per lane before the lanes are added. */
enum { SPARI_HELD = 8 * SPARI_TILE };
static inline int64_t spari_slabs(int64_t n, int64_t slab) {
    return (n + slab - 1) / slab;
}

/* Coefficients of the nodal fields of one state, [element][mode][SPARI_FIELDS]. */
enum {
    SPARI_F_POSITION = 0, /* reference position + displacement */
    SPARI_F_RATE = 3,     /* velocity */
    SPARI_F_QUAT = 6,     /* relative rotation, signs chained along the element */
    SPARI_F_SPIN = 10,    /* nodal: omega (3); consistent: omega q (4) */
    SPARI_F_ACCEL = 14,   /* acceleration */
    SPARI_F_TWIST = 17,   /* nodal: alpha (3); consistent: alpha q - |omega|^2 q / 2 (4) */
    SPARI_FIELDS = 21
};
/* Requested motion: positions; also velocities; also accelerations, which need the poses. SPARI_POSES (rotations,
   and with velocities the angular velocities) is or-ed to it. */
enum { SPARI_UPTO_POSITION, SPARI_UPTO_RATE, SPARI_UPTO_ACCEL, SPARI_UPTO, SPARI_POSES };

/* Rows that a kernel computes for a tile, each of SPARI_ROW doubles. */
enum {
    SPARI_R_POSITION = 0,
    SPARI_R_RATE = 3,
    SPARI_R_QUAT = 6, /* not normalised */
    SPARI_R_OMEGA = 10,
    SPARI_R_ACCEL = 13,
    SPARI_R_ALPHA = 16,
    SPARI_ROWS = 19
};

/* Layout of the host's array: component i of node j is number j * node + i * component. */
typedef struct spari_layout {
    int64_t node, component;
} spari_layout;

/* The host's triples: one of the two, or neither. */
typedef struct spari_source {
    const double *d;
    const float *f;
    const spari_layout *layout; /* NULL: [n][3] */
} spari_source;

/* One number of a source; the host's array may have any alignment. */
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

/* Fluid-side totals of the loads for the audit. */
typedef struct spari_audit {
    double force[3], moment[3], power; /* moment about the origin, in the current configuration */
    double force_sum, moment_sum;      /* sums of |fx| + |fy| + |fz|, and of the pushed moments likewise */
    double x_max, v_max, omega_max;    /* largest |x|, |v|, |omega| of the nodes */
} spari_audit;

/* Allocates n nodes, to be filled by spari_nodes_put. NULL: no memory. */
spari_nodes *spari_nodes_create(int64_t n, int elements, int per_element);
void spari_nodes_free(spari_nodes *nodes);
/* The same nodes with lever arms of their own, factor [n] by node times those of `from`, which must live on. NULL: no
   memory. Free them with spari_nodes_free_shortened. */
spari_nodes *spari_nodes_shorten(const spari_nodes *from, const double *factor);
void spari_nodes_free_shortened(spari_nodes *nodes);
/* Stores the nearest points, by node: element [n], local xi [n], con [n][3]. */
void spari_nodes_put(spari_nodes *nodes, const int *element, const double *xi, const double *con, const uint8_t *flags);
/* Numbers of nodes. SPARI_FAR: more than fit in the second-level cache, so later ones are prefetched. SPARI_PAST:
   more than fit in any cache, so results are written with non-temporal stores. SPARI_ASK: prefetch distance. */
enum { SPARI_FAR = 1 << 16, SPARI_PAST = 1 << 19, SPARI_ASK = 64 };
/* Node at a storage position, and its element. */
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

/* Fills c [elements][P][SPARI_FIELDS] from reference positions xr [nodes][3], motion q [nodes][7], v, a [nodes][6]. */
void spari_field_fill(int elements, int per_element, const double *modal, int consistent, int upto, const double *xr,
                      const double *q, const double *v, const double *a, double *c);

/* Motion of one tile, beginning at node `first`: the rows of buf requested by `what` (SPARI_UPTO_*, SPARI_POSES), in
   storage order. c must be filled as far. Returns the smallest |Q|^2 (0: a rotation cannot be interpolated). */
double spari_tile_motion(const spari_nodes *nodes, int64_t first, const double *c, int consistent, int what,
                         double (*buf)[SPARI_ROW]);

/* Positions and velocities of all nodes of a point or rigid body, as the host's triples; either may be NULL. Returns
   |q|^2. */
double spari_carry(const spari_nodes *nodes, const double *c, double *x, double *v);

/* Positions and velocities of `count` nodes of a beam from `first` on, stored directly in the host's triples of all
   nodes; either may be NULL. single: floats. Only if spari_can_move_to is true; otherwise use tiles, with the same
   bits. Returns the smallest |Q|^2. */
int spari_can_move_to(const spari_nodes *nodes, int single);
double spari_move_to(const spari_nodes *nodes, int64_t first, int64_t count, const double *c, int consistent,
                     int single, void *x, void *v);

/* Stores three rows of a tile, in storage order, in the host's triples x [n][3]. */
void spari_tile_store(const spari_nodes *nodes, int64_t first, double (*row)[SPARI_ROW], double *x);
void spari_tile_store_f32(const spari_nodes *nodes, int64_t first, double (*row)[SPARI_ROW], float *x);
/* Call this before other threads read the results of spari_tile_store. */
void spari_tiles_end(void);
/* The same through a layout, for double or float. */
void spari_tile_store_at(const spari_nodes *nodes, int64_t first, double (*row)[SPARI_ROW], const spari_layout *layout,
                         double *d, float *f);

/* Workspace of the sum of loads for a number of elements, in doubles: rows of a tile (loads, polynomials or shape
   functions, intermediate results), sums per lane, then sums, one block per thread and one for the call. */
static inline int64_t spari_gather_held(int per_element) {
    return (int64_t)(20 + per_element) * SPARI_ROW;
}
static inline int64_t spari_gather_rows(int per_element) {
    return spari_gather_held(per_element) + (7 * (per_element + 3) + 12) * 8;
}
static inline int64_t spari_gather_share(int64_t nodes) {
    return nodes * 7 * 2 + 22;
}
static inline int64_t spari_gather_workspace_size(int elements, int per_element) {
    return spari_gather_rows(per_element) + 2 * spari_gather_share((int64_t)elements * per_element);
}
/* Sums loads of all nodes: force, moment (may be absent) [n][3] -> load [nodes][6].
   q: nodal quaternions [nodes][7], needed by the consistent kind
   work: spari_gather_workspace_size doubles, aligned to a cache line; the other threads have the same in the pool
   audit: NULL if not wanted
   Returns the smallest |Q|^2. */
double spari_gather_loads(const spari_nodes *nodes, const double *modal, const double *c, int consistent,
                          const double *q, spari_source force, spari_source moment, double *work, double *load,
                          spari_audit *audit);

/* The same loads as reproducible sums, load [nodes][6], independent of the order of nodes and of the vector width.
   Rounded to double they differ from the sums above by rounding. *finite 0: a share is not finite or too large, and
   the sums are invalid. work: as above, the rows alone. */
double spari_bin_loads(const spari_nodes *nodes, const double *modal, int consistent, const double *q,
                       spari_source force, spari_source moment, double *work, spari_bins *load, int *finite);

#endif
