/* sfm_frame: where the head is in a reconstruction, how large it is in millimetres, and which way it looks.
 * World: the model's own frame and unit. Head: mm, x to the person's left, y up, z out of the face.
 */
#ifndef SFM_HEAD_SFM_FRAME_H
#define SFM_HEAD_SFM_FRAME_H
#include "sfm/colmap/colmap.h"
#include "optics/camera_rig.h"

/* The ball's radius over the distance at which most of the subject's points lie. */
#define SFM_SUBJECT_REACH 1.5

/* The subject: a ball round what all cameras look at. */
struct sfm_subject {
	double center[3], radius;  // world
};

/* The point nearest to all optical axes; the radius from the points round it. False, err set, when the axes are parallel:
 * all from one place. */
bool sfm_subject(struct sfm_subject *out, const struct colmap_model *model, struct err *err);

/* A point of space seen in a picture. */
struct sfm_sight {
	int image;     // index into the model's images
	double px[2];  // of the picture
};

/* Least squares of the distances in the pictures from at least two sights. sigma: 1 sd of its position, world, from what
 * they disagree by, at least floor_px. False, err set, where they do not meet. */
bool sfm_triangulate(double xyz[3], double *sigma, const struct colmap_model *model, int n, const struct sfm_sight sights[],
                     double floor_px, struct err *err);

/* A length in world units for a known one in mm, with the relative sigma of the quotient. */
struct sfm_length {
	double world, mm, sigma;
};

/* mm of a world unit: the weighted mean; *sigma relative, from the weights or from how much they scatter, whichever is
 * more. n >= 1. */
double sfm_scale(double *sigma, int n, const struct sfm_length lengths[]);

struct sfm_frame {
	double scale;                // mm of a world unit
	double R[3][3], t[3];        // p_head = scale R p_world + t, mm
};

/* From the cameras alone: y is up as most pictures have it, z towards the cameras' middle; origin at the subject's
 * centre. */
void sfm_frame_cameras(struct sfm_frame *frame, const struct colmap_model *model, const struct sfm_subject *subject,
                       double scale);

/* From the eyes' centres and, where it is known, the middle of the mouth (null: not), world. The origin lies between the
 * eyes. */
void sfm_frame_eyes(struct sfm_frame *frame, const struct colmap_model *model, const double left[3],
                    const double right[3], const double *mouth, double scale);

void sfm_to_head(double head[3], const struct sfm_frame *frame, const double world[3]);

/* cam_from_head of an image, mm. */
void sfm_cam_from_head(double m[4][4], const struct sfm_frame *frame, const struct colmap_image *image);

#endif
