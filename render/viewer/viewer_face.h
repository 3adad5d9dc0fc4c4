/* viewer_face: a driven character for the interactive page. */
#ifndef RENDER_VIEWER_VIEWER_FACE_H
#define RENDER_VIEWER_VIEWER_FACE_H
#include <jansson.h>

#include "render/face/skin.h"

/* Everything the page needs of a character besides its eyes: its mesh and rig, the model's expressions and their wrinkles. Leaves the
 * portrait in another pose. gain: exposure. Null: err is set. json_decref. */
json_t *viewer_face(const char *name, struct portrait *portrait, const struct skin_model *model, double gain,
                    const struct scene *const eyes[2], struct err *err);

/* What a video or a script has the eyes do, for the page to play. json_decref. */
json_t *viewer_clip(const char *name, const struct drive *drive);

#endif
