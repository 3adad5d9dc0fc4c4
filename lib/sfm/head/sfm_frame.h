/* sfm_frame: the head's position, size and axes in a reconstruction.
 * World: the model's own frame and unit. Head: mm, x to the person's left, y up, z out of the face.
 */
#ifndef SFM_HEAD_SFM_FRAME_H
#define SFM_HEAD_SFM_FRAME_H
#include "sfm/colmap/colmap.h"
#include "optics/camera_rig.h"

/* The ball's radius over the distance at which most of the subject's points lie. */
#define SFM_SUBJECT_REACH 1.5

/* The subject: a ball round the point at which all cameras look. */
struct sfm_subject {
	double center[3], radius;  // world
};

/* The centre is the point nearest to all optical axes (least squares); the radius SFM_SUBJECT_REACH times the median distance of
 * the points round it, background left out. Returns false, err set, when the axes are parallel or fewer than 10 points remain. */
bool sfm_subject(struct sfm_subject *out, const struct colmap_model *model, struct err *err);

/* A point of space seen in a picture. */
struct sfm_sight {
	int image;     // index into the model's images
	double px[2];  // of the picture
};

/* Triangulates a point by Gauss-Newton on its reprojection errors, begun at the midpoint of the rays.
 * sigma     out: 1 sd of its position, world, from the residuals' variance, at least floor_px squared
 * n         sights, 2 or more
 * Returns false, err set, where the rays are parallel or the point lies behind a camera. */
bool sfm_triangulate(double xyz[3], double *sigma, const struct colmap_model *model, int n, const struct sfm_sight sights[],
                     double floor_px, struct err *err);

/* A length in world units and the same in mm; sigma: of the quotient, relative. */
struct sfm_length {
	double world, mm, sigma;
};

/* Returns the scale, mm a world unit: the mean of the logarithms of all quotients, weighted by 1 / sigma². sigma: out, relative, from
 * the weights or from the scatter (chi-squared), whichever is more. n >= 1. */
double sfm_scale(double *sigma, int n, const struct sfm_length lengths[]);

struct sfm_frame {
	double scale;                // mm of a world unit
	double R[3][3], t[3];        // p_head = scale R p_world + t, mm
};

/* The frame from the cameras alone: y is the mean up of the pictures, z points to the mean of the cameras; origin at the subject's
 * centre. */
void sfm_frame_cameras(struct sfm_frame *frame, const struct colmap_model *model, const struct sfm_subject *subject,
                       double scale);

/* The frame from the eyes' centres and the middle of the mouth (null: not known), world. The origin lies between the eyes. */
void sfm_frame_eyes(struct sfm_frame *frame, const struct colmap_model *model, const double left[3],
                    const double right[3], const double *mouth, double scale);

/* Transforms a point from world to head, mm. */
void sfm_to_head(double head[3], const struct sfm_frame *frame, const double world[3]);

/* The pose cam_from_head of an image, mm. */
void sfm_cam_from_head(double m[4][4], const struct sfm_frame *frame, const struct colmap_image *image);

#endif
