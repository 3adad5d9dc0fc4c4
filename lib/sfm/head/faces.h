/* faces: faces seen in the pictures one by one. What was found in a picture, and which ways up were tried, is kept between runs
 * by the picture's name, which is its content's: work/calibrate/faces.json.
 */
#ifndef SFM_HEAD_FACES_H
#define SFM_HEAD_FACES_H
#include "sfm/head/sfm_eyes.h"
#include "sfm/views.h"

struct faces {
	struct sfm_face *f;  // owned; sorted by image
	int n, images;       // images: in which there is one
};

/* In the model's pictures as they are; turned by one, two, three quarters only while fewer than `least` pictures show a face.
 * What cannot be looked for at all is said, and nothing found. False, err set: a picture cannot be read, or the file not be
 * written. faces_free either way. */
bool faces_find(struct faces *faces, const struct colmap_model *model, int least, struct stage *stage,
                const struct calibrate_options *o, struct err *err);
void faces_free(struct faces *faces);

#endif
