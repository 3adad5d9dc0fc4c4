/* light: environment maps that keys name: latitude-longitude EXR files of the capture folder, in the camera's frame
 * (image/envmap/envmap.h). */
#ifndef ANATOMY_LIGHT_H
#define ANATOMY_LIGHT_H
#include "base/stage.h"
#include "image/envmap/envmap.h"

/* Row `light.environment`, into a const char *: the photographs' own light. Its scale does not matter: photographs tell it. */
#define LIGHT_ENVIRONMENT_OPT(path) OPT_STR("light.environment", path, "latitude-longitude EXR in the capture folder: the photographs' own light")

/* Loads one, in its own scale.
 * env    overwritten; envmap_free
 * level  out: of envmap_level; null: not wanted
 * what   the key, for errors; rel: its value
 * False, err set, for a path that leads out of the folder, a file that is no environment, or a map that leaves a plane that faces
 * the camera in the dark. */
bool light_load(struct envmap *env, double *level, struct stage *stage, const char *what, const char *rel, struct err *err);

#endif
