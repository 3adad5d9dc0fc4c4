/* pictures: the cache work/calibrate/pictures.json: size, focal length, sharpness and thumb of every picture, so that no photograph
 * is decoded twice; and the cameras in their order, so that a camera keeps its number.
 */
#ifndef SFM_PICTURES_H
#define SFM_PICTURES_H
#include <jansson.h>

#include "sfm/views.h"

struct pictures {
	json_t *all;      // picture -> {width, height, ...}
	json_t *cameras;  // keys, in the order they came
};

/* Loads the cache; empty where the file is missing or cannot be read. pictures_free. */
void pictures_load(struct pictures *known, const char *path);

/* Writes the pictures of these views and the cameras. Returns false, err set, when the file cannot be written. */
bool pictures_save(const struct views *views, struct pictures *known, const char *path, struct err *err);

void pictures_free(struct pictures *known);

/* Fills the views whose pictures are in the cache. */
void pictures_recall(struct views *views, const struct pictures *known);

/* Groups the views in use by camera (EXIF's model, size, focal length): fills cameras, has_focal and each view's camera. A camera
 * that is not in `known` is added behind the others. */
void pictures_cameras(struct views *views, struct pictures *known, const struct calibrate_options *o);

#endif
