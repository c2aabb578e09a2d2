/* Joints of rebuilt members: moved to the nodes at the same positions, keeping their motion and loads. Copies hold
   the old state; handles stay valid. */
#ifndef SPARI_RETIE_H
#define SPARI_RETIE_H

#include "../assembly/assembly.h"

typedef struct spari_ties {
    spar_joint *joints; /* [joint_count] old state; NULL: nothing to restore */
    spari_assembly *assemblies;
    int stale;
} spari_ties;

/* Copies joints and assemblies; the session then has no assemblies. A status and a message. Local, as all below. */
int spari_ties_lay_aside(spar_session *session, spari_ties *ties);
/* Moves the joints of a rebuilt member to its new nodes; `old`: the member before. Refused if a joint's node does
   not exist in the new mesh. The assemblies must then be created. */
int spari_ties_follow(const spar_member *member, const spar_member *old);
/* Restores the copies, after the members have been restored; or keeps the present state. */
void spari_ties_restore(spar_session *session, spari_ties *ties);
void spari_ties_adopt(spar_session *session, spari_ties *ties);
/* Node of a mesh that coincides with a node of the member, as the end of an element in both; -1: none. */
int64_t spari_ties_end(const spar_member *member, int64_t node, spari_mesh mesh);
/* Whether a joint is at a node inside an element, or would be with this many elements. */
int spari_ties_hold_within(const spar_member *member, int elements);

#endif
