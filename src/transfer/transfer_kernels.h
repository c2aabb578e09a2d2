/* The kernels between lines and nodes (transfer_lanes.c): one table for each width of vectors, and what they share with
   their callers. */
#ifndef SPARI_TRANSFER_KERNELS_H
#define SPARI_TRANSFER_KERNELS_H

#include "../math/lanes.h"
#include "../math/rotation.h"
#include "transfer.h"

/* s[0] + s[1] += x, the rounding error kept (Knuth's two-sum): the sum over tiles loses nothing that matters. */
static inline void spari_add(double *s, double x) {
    double a = s[0], t = a + x, b = t - a;
    s[0] = t;
    s[1] += (a - (t - b)) + (x - b);
}

/* How the one node of a point or rigid body moves what is tied to it: place + R arm. */
typedef struct carrier {
    double place[3], rate[3], q[4], rotation[9], omega[3], accel[3], alpha[3];
    double square; /* |q|^2 */
} carrier;

carrier spari_carrier_of(const double *c); /* from the coefficients of its element */

/* The loads of a tile's nodes, as rows, of which a run of one element begins at `at`. next: the host's forces of the
   tile's nodes after it, numbers of `size` bytes; NULL: of no use, or not triples. held: the sums of the runs of one
   element, lane by lane, which have their lanes added once for several tiles: they begin with this run, end with it. */
typedef struct tile_loads {
    double (*row)[SPARI_ROW];
    int at, size;
    const char *next;
    double *held;
    int begin, end, nodes; /* nodes: in the sums so far */
} tile_loads;

typedef struct spari_transfer_kernels {
    double (*motion)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent, int what,
                     double (*buf)[SPARI_ROW], int at);
    double (*loads)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent, int has_moment,
                    const tile_loads *f, int audited, double (*rows)[SPARI_ROW], double *modal, double *sums,
                    double *tops);
    int (*bins)(const spari_nodes *s, int64_t first, int count, const double *modal, const double *q, int consistent,
                int has_moment, double (*f)[SPARI_ROW], int at, double (*rows)[SPARI_ROW], double *least,
                spari_bin_cut *cut, spari_bins *load);
    void (*carry)(const spari_nodes *s, const carrier *m, double *x, double *v);
    double (*move_to)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent, int single,
                      void *x, void *v, int past);
    void (*give)(double (*row)[SPARI_ROW], int count, double *out, int past);
    void (*give_singles)(double (*row)[SPARI_ROW], int count, float *out, int past);
    void (*load)(const double *in, int count, double (*row)[SPARI_ROW]);
    void (*load_singles)(const float *in, int count, double (*row)[SPARI_ROW]);
} spari_transfer_kernels;

SPARI_KERNEL_TABLES(spari_transfer_kernels)

#endif
