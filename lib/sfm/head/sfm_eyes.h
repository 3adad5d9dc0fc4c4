/* sfm_eyes: the two eyes and the mouth of a head in a reconstruction, by consensus of faces that were detected in its pictures one
 * by one, some of them falsely.
 */
#ifndef SFM_HEAD_SFM_EYES_H
#define SFM_HEAD_SFM_EYES_H
#include "sfm/head/sfm_frame.h"

/* A detected face, px of the picture. eye: the person's left, right. */
struct sfm_face {
	int image;  // index into the model's images
	double eye[2][2], mouth[2];
	bool mouth_found;  // false: mouth is an estimate, at the mean place below the eyes
};

struct sfm_eyes {
	double eye[2][3], mouth[3];  // world
	double sigma;                // 1 sd of an eye's position, as a share of the eyes' distance
	int n;                       // pictures that agree (inliers)
	int mouths;                  // of them those with a mouth that agrees; 0: mouth is an estimate from the eyes
};

/* Every two faces propose a pair of points (exhaustive consensus, as RANSAC without the draw); the pair with the most inliers is
 * refined by triangulation from all of them. A face is an inlier where each eye lies within the share `near` of the eyes' distance
 * in its picture.
 * agrees  out: [n], whether each face is an inlier
 * least   pictures that have to agree; 3 or more: two agree by chance
 * Returns false where there is no such pair. */
bool sfm_eyes(struct sfm_eyes *out, bool *agrees, const struct colmap_model *model, int n, const struct sfm_face faces[],
              int least, double near);

/* Projects a point of the world into a picture, px of it. focal: out, the scale there, px a world unit. Returns false for a point
 * behind the camera. */
bool sfm_project(double px[2], double *focal, const struct colmap_model *model, int image, const double xyz[3]);

#endif
