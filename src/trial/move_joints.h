/* Joints of members made anew: they tie the nodes that stand where those of before stood, and go on from the motion and
   the loads that they have. What they were waits in copies; the handles stay. */
#ifndef SPARI_RETIE_H
#define SPARI_RETIE_H

#include "../assembly/assembly.h"

typedef struct spari_ties {
    spar_joint *joints; /* [joint_count] as they were; NULL: there is nothing to go back to */
    spari_assembly *assemblies;
    int stale;
} spari_ties;

/* What the joints and assemblies are is put aside, and the session has assemblies no more. A status and a message.
   Local, as all below. */
int spari_ties_lay_aside(spar_session *session, spari_ties *ties);
/* After a member has been made anew, `old` being what it was: its joints' nodes. A joint at a node that the other
   elements or nodes have not is refused. The assemblies are then to be made. */
int spari_ties_follow(const spar_member *member, const spar_member *old);
/* As it was laid aside, after the members have been restored; or it stays as it is now. */
void spari_ties_restore(spar_session *session, spari_ties *ties);
void spari_ties_adopt(spar_session *session, spari_ties *ties);
/* The node of a line so divided that a node of the member is as the end of an element of both; -1: it is none. */
int64_t spari_ties_end(const spar_member *member, int64_t node, spari_mesh mesh);
/* Whether a joint holds a node of the member that lies within an element, or would if it had so many. */
int spari_ties_hold_within(const spar_member *member, int elements);

#endif
