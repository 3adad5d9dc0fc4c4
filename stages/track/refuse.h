/* refuse: the picture of a clip that is refused. */
#ifndef STAGES_TRACK_REFUSE_H
#define STAGES_TRACK_REFUSE_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

#define REFUSED_PICTURE "work/skin/refused.png"

/* Writes REFUSED_PICTURE: the reference frame, the outlines of the mesh's openings (orange) and its eyeballs (blue) as the pose lays them,
 * and, with a result, the lid margins that were found there (green). A picture that cannot be written is no further error. */
void refuse_picture(struct stage *stage, const struct track_clip *clip, const struct track_subject *subject,
                    const struct track_result *result);

#endif
