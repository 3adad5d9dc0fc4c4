/* viewer_face: a driven character for the interactive page. */
#ifndef RENDER_VIEWER_FACE_H
#define RENDER_VIEWER_FACE_H
#include <jansson.h>

#include "render/skin.h"

/* Everything the page needs of a character besides its eyes. Leaves the portrait in another pose. gain: exposure.
 * json_decref. */
json_t *viewer_face(const char *name, struct portrait *portrait, double gain, const struct scene *const eyes[2]);

/* What a video or a script has the eyes do, for the page to play. json_decref. */
json_t *viewer_clip(const char *name, const struct rig *rig, const struct drive *drive);

#endif
