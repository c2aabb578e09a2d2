/* The beam that benchmarks/peers has spar and its peers move: the composite box of Wang et al. (Wind Energy 20, 2017),
   clamped, a force at the tip from rest. In C and in C++. */
#ifndef PEER_PHYSICS_H
#define PEER_PHYSICS_H

/* One element; Gauss quadrature with as many points as it has nodes, spectral damping 0. */
static const double peer_length = 10, peer_end = 0.4; /* m, s */
static const double peer_force = 150;                 /* N, along z; the beam lies along x */

/* Axial, shear y, shear z, torsion, bending y, bending z */
static const double peer_stiffness[6][6] = {{1368.17e3, 0, 0, 0, 0, 0},
                                            {0, 88.56e3, 0, 0, 0, 0},
                                            {0, 0, 38.78e3, 0, 0, 0},
                                            {0, 0, 0, 16.96e3, 17.61e3, -0.351e3},
                                            {0, 0, 0, 17.61e3, 59.12e3, -0.370e3},
                                            {0, 0, 0, -0.351e3, -0.370e3, 141.47e3}};
static const double peer_mass[6] = {8.538e-2, 8.538e-2, 8.538e-2, 1.4433e-2, 0.4097e-2, 1.0336e-2};

#endif
