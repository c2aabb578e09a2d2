/* What a beam's nodes have done beyond the motion of its root, in the root's axes. */
#ifndef DEFORMED_H
#define DEFORMED_H

#include "check.h"

#include "math/rotation.h"

/* u[n][3]: out, m, of no more than `most` nodes. Answers n. */
static inline int64_t deformed(spar_session *s, spar_member *m, int64_t most, double *u) {
    enum { MOST_DEFORMED = 64 };
    double q[7 * MOST_DEFORMED], place[3 * MOST_DEFORMED];
    int64_t n;
    OK(s, spar_member_get_count(m, &n));
    assert_true(n <= most && n <= MOST_DEFORMED);
    OK(s, spar_member_get_motion(m, q, NULL, NULL));
    OK(s, spar_member_get_reference(m, place, NULL));
    for (int64_t j = 0; j < n; j++) {
        double arm[3], turned[3];
        for (int c = 0; c < 3; c++) {
            arm[c] = place[3 * j + c] - place[c];
        }
        spari_rotate(q + 3, arm, turned);
        for (int c = 0; c < 3; c++) {
            u[3 * j + c] = q[7 * j + c] - q[c] - turned[c] + arm[c];
        }
        spari_rotate_back(q + 3, u + 3 * j, u + 3 * j);
    }
    return n;
}

#endif
