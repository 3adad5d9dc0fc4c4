/* faces: faces detected in each picture by itself (OpenCV's Haar cascades). Detections are cached in work/calibrate/faces.json by
 * the picture's name, which is a hash of its content, and by the way up that was tried.
 */
#ifndef SFM_HEAD_FACES_H
#define SFM_HEAD_FACES_H
#include "sfm/head/sfm_eyes.h"
#include "sfm/views.h"

struct faces {
	struct sfm_face *f;  // [n], owned; sorted by image, then by the left eye's x
	int n, images;       // images: pictures with one face or more
};

/* Searches the model's pictures as they are; then turned by one, two, three quarters, as long as fewer than `least` pictures show a
 * face. Where the cascades are not installed it finds none and records that as skipped.
 * Returns false, err set, when a picture cannot be read or the cache not be written. faces_free in any case. */
bool faces_find(struct faces *faces, const struct colmap_model *model, int least, struct stage *stage,
                const struct calibrate_options *o, struct err *err);
void faces_free(struct faces *faces);

#endif
