/* pictures: what is known of every picture between runs, so that no photograph is decoded twice, and which cameras there
 * are, so that a camera keeps its number: work/calibrate/pictures.json. */
#ifndef SFM_PICTURES_H
#define SFM_PICTURES_H
#include <jansson.h>

#include "sfm/views.h"

struct pictures {
	json_t *all;      // picture -> {width, height, ...}
	json_t *cameras;  // keys, in the order they came
};

/* A file that is missing or cannot be read: nothing is known. */
void pictures_load(struct pictures *known, const char *path);
bool pictures_save(const struct views *views, struct pictures *known, const char *path, struct err *err);
void pictures_free(struct pictures *known);

/* Fills the views whose pictures are known. */
void pictures_recall(struct views *views, const struct pictures *known);

/* Groups the views in use by camera: what EXIF calls it, size, focal length. */
void pictures_cameras(struct views *views, struct pictures *known, const struct calibrate_options *o);

#endif
