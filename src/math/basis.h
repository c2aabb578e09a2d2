/* Lagrange basis on Gauss-Lobatto-Legendre nodes, and quadrature on [-1,1]. */
#ifndef SPARI_BASIS_H
#define SPARI_BASIS_H

enum { SPARI_MAX_NODES = 24 }; /* nodes per element at most */

/* GLL nodes, weights and barycentric weights of n >= 2 points; any output may be NULL. n = 1: node 0, weight 2. */
void spari_gll(int n, double *x, double *w, double *bary);
/* Gauss-Legendre points and weights, n >= 1. */
void spari_gauss(int n, double *x, double *w);
/* phi[n] and d phi / d xi [n] (NULL: not wanted) at xi, by the barycentric formula; exact at a node. */
void spari_lagrange(int n, const double *x, const double *bary, double xi, double *phi, double *dphi);
/* share[n]: how much of a load that is spread along the element, and given as consistent nodal loads, acts beyond xi,
   for the load of each node. Exact for loads that are polynomials of degree n - 1. */
void spari_share_beyond(int n, const double *x, double xi, double *share);

#endif
