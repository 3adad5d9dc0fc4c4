/* eyes: finds a target's eyeballs and derives landmarks of the lids from them.
 * Axes: x to the character's left, y up, z out of the face. */
#ifndef REGISTER_EYES_H
#define REGISTER_EYES_H
#include "mesh/mesh_part.h"
#include "register/nricp/align.h"

/* Finds the eyeballs among a target's connected pieces: the largest two round pieces of one size beside each other, in any direction.
 * center  out: of both, of larger x first, in the mesh's unit
 * radius  out: their mean radius, in the mesh's unit
 * Returns false when there is no such pair. */
bool eyes_of_target(double center[2][3], double *radius, const struct mesh *target);

/* Pairs vertices at the lids' middles and corners, round both eyes of a target and of the subject.
 * out          overwritten; out->moving is the caller's, free((void *)out->moving)
 * part         of the target, without its eyeballs
 * target_eye   centres and target_radius: of eyes_of_target
 * swapped      whether the second of them is taken as the left one: of the two, one has the character upside down
 * subject      mm, in the head's axes; subject_eye: its eyeballs' centres, left and right
 * Returns false when the skin round both eyeballs does not lie to one side of them, in front. */
bool eyes_landmarks(struct nricp_landmarks *out, const struct mesh_part *part, const double target_eye[2][3], double target_radius,
                    bool swapped, const struct mesh *subject, const double subject_eye[2][3]);

/* Share of the part's area that lies below the eyes, where they are taken in that order: more than half of a head with its neck, of a bust or a
 * body that stands upright. NAN where eyes_landmarks returns false. */
double eyes_below(const struct mesh_part *part, const double target_eye[2][3], double target_radius, bool swapped);

/* Of the two orders, the one that has more than the share `least` of the character below its eyes and whose shape fits at least `nearly` as well as the
 * other's: 0, 1; -1: that does not tell. below: eyes_below of both; fine: shares of the face found close under both. */
int eyes_upright(const double below[2], const double fine[2], double least, double nearly);

#endif
