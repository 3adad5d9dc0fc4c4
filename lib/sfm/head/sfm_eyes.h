/* sfm_eyes: where a head's eyes are in a reconstruction, from faces found in its pictures one by one. Some of those are no
 * faces: what counts is where several pictures agree.
 */
#ifndef SFM_HEAD_SFM_EYES_H
#define SFM_HEAD_SFM_EYES_H
#include "sfm/head/sfm_frame.h"

/* A face in a picture, px of it: the left and the right eye, the mouth. */
struct sfm_face {
	int image;  // index into the model's images
	double eye[2][2], mouth[2];
	bool mouth_found;  // else mouth is where it is to be expected
};

struct sfm_eyes {
	double eye[2][3], mouth[3];  // world
	double sigma;                // 1 sd of an eye's place, of the eyes' distance
	int n;                       // pictures that agree
	int mouths;                  // of them those with a mouth that agrees; 0: it is only where it is to be expected
};

/* The pair of points that most pictures agree on, each eye within a share `near` of the eyes' distance in the picture; from
 * at least `least` pictures (3 or more: two agree by chance). agrees[n]: whether each face does. False: there is none. */
bool sfm_eyes(struct sfm_eyes *out, bool *agrees, const struct colmap_model *model, int n, const struct sfm_face faces[],
              int least, double near);

/* Where a picture shows a point of the world, px; *focal: its scale there, px a world unit. False: behind the camera. */
bool sfm_project(double px[2], double *focal, const struct colmap_model *model, int image, const double xyz[3]);

#endif
