/* face: a driven character for the interactive page. */
#ifndef DRAW_WEB_FACE_H
#define DRAW_WEB_FACE_H
#include <jansson.h>

#include "draw/face/portrait.h"
#include "model/model.h"
#include "rig/drive.h"

/* Everything the page needs of a character besides its eyes: mesh and rig, light on a grid of gazes and apertures, expressions and
 * their wrinkles. Lengths mm, in the head's axes about the middle of both eyes.
 * portrait  left in the pose at rest
 * gain      exposure
 * eyes      left, right
 * json_decref. Null, err set, when a map cannot be encoded. */
json_t *web_face(const char *name, struct portrait *portrait, const struct skin_model *model, double gain,
                 const struct scene *const eyes[2], struct err *err);

/* The controls of a recorded or scripted clip, at most 60 rows a second, for the page to play. json_decref. */
json_t *web_clip(const char *name, const struct drive *drive);

#endif
