/* eyes: the face's eyes and mouth in the views, where nobody has named them. */
#ifndef SFM_HEAD_EYES_H
#define SFM_HEAD_EYES_H
#include "sfm/head/places.h"

/* As a hand would name them, in the photographs' own px: with each eye the radius that an iris of mean size has there. */
struct eyes {
	struct opt_each_list side[2], mouth;  // owned
	double apart;                         // of the eyes, world; 0: not found
	double sigma;                         // of that, relative
	bool mouth_found;                     // else mouth is where it is to be expected below the eyes
};

/* Faces seen from the front, in pictures that agree on where its eyes are. What is not found, and why, is said; false, err
 * set, only where a picture cannot be read. eyes_free. */
bool eyes_find(struct eyes *eyes, const struct head *head, const struct views *views, struct stage *stage,
               const struct calibrate_options *o, struct err *err);
void eyes_free(struct eyes *eyes);

#endif
