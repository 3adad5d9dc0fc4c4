/* eyes: the face's eyes and mouth in the views, found where capture.conf names none.
 */
#ifndef SFM_HEAD_EYES_H
#define SFM_HEAD_EYES_H
#include "sfm/head/places.h"

/* In the form of capture.conf's keys, px of the photographs: each eye with the radius that an iris of mean size has there. */
struct eyes {
	struct opt_each_list side[2], mouth;  // owned
	double apart;                         // distance of the eyes, world; 0: not found
	double sigma;                         // of apart, relative, 1 sd
	bool mouth_found;                     // false: mouth is an estimate, at the mean place below the eyes
};

/* Finds faces in the pictures (faces.h) and the pair of eyes that most of them agree on (sfm_eyes.h). That none is found is recorded
 * as skipped, with the reason. Returns false, err set, only when a picture cannot be read. eyes_free in any case. */
bool eyes_find(struct eyes *eyes, const struct head *head, const struct views *views, struct stage *stage,
               const struct calibrate_options *o, struct err *err);
void eyes_free(struct eyes *eyes);

#endif
