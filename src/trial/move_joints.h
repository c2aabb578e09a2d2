/* Joints of rebuilt members: moved to the nodes at the same positions, keeping their motion and loads. Copies hold
   the old state; handles stay valid. */
#ifndef SPARI_MOVE_JOINTS_H
#define SPARI_MOVE_JOINTS_H

#include "../assembly/assembly.h"

typedef struct spari_joint_snapshot {
    spar_joint *joints; /* [joint_count] old state; NULL: nothing to restore */
    spari_assembly *assemblies;
    int stale;
} spari_joint_snapshot;

/* Copies joints and assemblies; the session then has no assemblies. A status and a message. Local, as all below. */
int spari_joints_save_snapshot(spar_session *session, spari_joint_snapshot *joint_snapshot);
/* Moves the joints of a rebuilt member to its new nodes; `old`: the member before. Refused if a joint's node does
   not exist in the new mesh. The assemblies must then be created. */
int spari_joints_follow_rebuild(const spar_member *member, const spar_member *old);
/* Restores the copies, after the members have been restored; or keeps the present state. */
void spari_joints_restore_snapshot(spar_session *session, spari_joint_snapshot *joint_snapshot);
void spari_joints_drop_snapshot(spar_session *session, spari_joint_snapshot *joint_snapshot);
/* Whether a joint is at a node inside an element, or would be with this many elements. */
int spari_joints_hold_within(const spar_member *member, int elements);

#endif
