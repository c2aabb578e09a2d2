/* Sections that are very much stiffer in one strain than in another: stretch beside bending of a thin strip. A
   stiffness matrix of the nodes has both in the same numbers, so that rounding of the stiff strains hides the soft
   ones. In slow motions the stiff strains are constraints, whatever their stiffness. With at most `ratio` times the
   softest strain's stiffness in any, these motions stay and their digits are kept. */
#ifndef SPARI_CAPPED_H
#define SPARI_CAPPED_H

#include "body.h"

/* A copy of a body with such sections, and with the section forces of the body in the state q [unique][7]. Of
   curvatures the member's length makes strains. ratio 0: the body itself. Returns 0 or SPAR_ERR_MEMORY; uncap frees it.
 */
int spari_body_cap(const spari_body *body, const double *q, double ratio, spari_body *capped);
void spari_body_uncap(const spari_body *body, spari_body *capped);

#endif
