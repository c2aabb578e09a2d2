/* Lagrange basis on Gauss-Lobatto-Legendre nodes, and quadrature on [-1, 1]. */
#ifndef SPARI_BASIS_H
#define SPARI_BASIS_H

enum { SPARI_MAX_NODES = 24 }; /* maximum number of nodes per element */

/* GLL nodes, weights and barycentric weights of n >= 2 points; any output may be NULL. n = 1: node 0, weight 2. */
void spari_gll(int n, double *x, double *w, double *bary);
/* Gauss-Legendre points and weights, n >= 1. */
void spari_gauss(int n, double *x, double *w);
/* phi[n] and d phi / d xi [n] (NULL: not wanted) at xi, by the barycentric formula; exact at a node. */
void spari_lagrange(int n, const double *x, const double *bary, double xi, double *phi, double *dphi);
/* share[n]: for each node, the fraction of a distributed load that acts beyond xi, if the load is given as
   consistent nodal loads. Exact for loads that are polynomials of degree n - 1. */
void spari_share_beyond(int n, const double *x, double xi, double *share);

#endif
