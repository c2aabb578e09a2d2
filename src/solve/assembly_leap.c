/* A step much longer than the last, of members that joints tie: as of one alone (scheme.h), with S the tangent of all
   under the joints' holds. What the holds ask of the accelerations b carried along, and the turning of each member, is
   no motion that a step could fail to resolve: b less the latter is y + x, B y = 0 and S x = B^T f, and the filter sees
   y alone. It leaves B y = 0. */
#include "tied.h"

#include "../base/scene.h"

#include <string.h>

static void push_all(void *self) {
    spari_assembly *a = self;
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].row->push(a->limb + i);
    }
    for (int i = 0; i < a->links; i++) {
        memset(a->link[i].gap, 0, sizeof a->link[i].gap);
    }
}

static int respond_all(void *self) {
    spari_assembly *a = self;
    return spari_tied_solve(a, a->limb[0].scheme.cv);
}

static void take_all(void *self, double f) {
    spari_assembly *a = self;
    for (int i = 0; i < a->limbs; i++) {
        a->limb[i].row->take_off(a->limb + i, f);
    }
}

/* Takes x out of b. */
static int take_held(spari_assembly *a) {
    for (int i = 0; i < a->links; i++) {
        spari_link *l = a->link + i;
        double y[6];
        for (int side = 0; side < 2; side++) {
            memset(l->a + 6 * side, 0, l->limb[side] ? 0 : 6 * sizeof *l->a);
        }
        spari_link_times(l->B, l->a, y);
        for (int k = 0; k < 6; k++) {
            l->gap[k] = l->row[k] >= 0 ? y[k] : 0;
        }
    }
    if (spari_tied_close(a, a->limb[0].scheme.cv)) {
        return 1;
    }
    take_all(a, 1);
    return 0;
}

int spari_tied_leap(spari_assembly *a, double dt) {
    static const spari_filter how = {push_all, respond_all, take_all};
    int singular = 0;
    for (int i = 0; i < a->limbs && !singular; i++) {
        singular = a->limb[i].row->leap(a->limb + i);
    }
    for (int i = 0; i < a->links; i++) {
        a->link[i].begin = a->link[i].joint->after;
        spari_link_find(a->link + i, 0, dt, 1);
    }
    spari_tied_keep(a);
    singular = singular || take_held(a) || spari_scheme_filter(&a->limb[0].scheme, &how, a);
    for (int i = 0; i < a->limbs && !singular; i++) {
        a->limb[i].row->land(a->limb + i);
    }
    for (int i = 0; i < a->links; i++) {
        a->link[i].joint->after = a->link[i].begin;
    }
    a->factored = a->standing = 0; /* those tangents are of where the step begins */
    SPARI_REQUIRE(a->session, !singular, SPAR_ERR_NUMERIC,
                  "the members that joint '%s' ties together: found a singular tangent at t = %g, the beginning of a "
                  "longer step; take a smaller dt",
                  a->link[0].joint->name, a->session->time);
    return SPAR_OK;
}
