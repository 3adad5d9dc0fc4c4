/* skin_views: photographs round a person's head as what a character's skin is made of. The person keeps still in them while the camera goes round: the light stays with the head.
 */
#ifndef RENDER_FACE_SKIN_VIEWS_H
#define RENDER_FACE_SKIN_VIEWS_H
#include "draw/complexion/complexion.h"
#include "render/face/skin_tracked.h"

/* Looks for views whose cameras are known in the frame of the mesh that the character was laid onto, and puts them, cameras and mesh into its inputs:
 * target->views, how many, and ->subject. 0, why told: there are none. */
void skin_views_find(struct skin_target *target, struct stage *stage, struct err *why);

/* Adds them to a complexion of f's mesh: the most frontal first, which tells the white of the eyes. f: eyes and lids of the film, and the mesh. Returns false, err set, where none can be
 * read. */
bool skin_views_add(struct complexion *complexion, const struct tracked *f, struct skin_job *job, const struct skin_target *target, struct err *err);

#endif
