/* cloud: a dense cloud of oriented points by stereo matching of pairs of pictures with known cameras.
 * World: the COLMAP model's own frame and unit. Pictures: grey, of the size of the model's cameras or smaller.
 */
#ifndef SFM_CLOUD_CLOUD_H
#define SFM_CLOUD_CLOUD_H
#include <stddef.h>
#include <stdint.h>

#include "bridge/cv_stereo.h"
#include "sfm/colmap/colmap.h"
#include "sfm/head/sfm_frame.h"

/* Two images that see the same surface from directions far enough apart to measure depth. */
struct cloud_pair {
	int a, b;      // indices into the model's images, a < b
	double score;
};

struct cloud_conf {
	int neighbours;            // pairs of an image, at most
	double best_angle;         // radians between the two views: at smaller angles depth is less certain, at larger ones matching fails
	int size_px;               // the subject's diameter in the rectified pictures
	int max_range;             // disparities that are tried, at most
	double voxel;              // edge of a cell in which points are averaged, of the subject's radius
	int min_pairs;             // pairs that have to agree on a cell, with its neighbours
	double max_slant;          // radians: steeper surfaces are left to other views
	struct cv_stereo_conf stereo;
};

/* Selects for each image its best partners, conf->neighbours at most. is_new: [n_images], only pairs with such an image count; null:
 * all. n: out, pairs. Returns them sorted by (a, b); free(). */
struct cloud_pair *cloud_pairs(int *n, const struct colmap_model *model, const bool *is_new, const struct cloud_conf *conf);

struct cloud_picture {
	uint8_t *grey;       // owned by whoever made it
	int width, height;   // px
};

struct cloud_points {
	long n, room;
	float (*xyz)[3], (*normal)[3];  // world; unit, towards the camera
	float *weight;                  // 1 / variance of the depth, 1 / world unit²
};

/* Rectifies the pair (lens distortion included), matches it by semi-global matching, and appends the points inside the subject's
 * ball. Returns false, err set, for a lens that is not supported. cloud_points_free in any case. */
bool cloud_stereo(struct cloud_points *points, const struct colmap_model *model, const struct cloud_pair *pair,
                  const struct cloud_picture *a, const struct cloud_picture *b, const struct sfm_subject *subject,
                  const struct cloud_conf *conf, struct err *err);
void cloud_points_free(struct cloud_points *points);

/* A voxel grid in the subject's ball, each cell the weighted mean of the points in it: the same within rounding in whatever order
 * pairs are added, the same to the bit in the same order. */
struct cloud_grid;
struct cloud_grid *cloud_grid_new(const struct sfm_subject *subject, const struct cloud_conf *conf);
void cloud_grid_free(struct cloud_grid *grid);

/* Adds one pair's points. */
void cloud_grid_add(struct cloud_grid *grid, const struct cloud_points *points);

/* One point for each cell that min_pairs pairs, its neighbours' included, agree on; in a fixed order. cloud_points_free. */
void cloud_grid_points(struct cloud_points *out, const struct cloud_grid *grid, const struct cloud_conf *conf);

/* The grid as a file, kept between runs. tag: the caller's own words for what it was made from. cloud_grid_load returns false
 * without an error when the file is missing or not one of these; else tag: out, free(). */
bool cloud_grid_save(const struct cloud_grid *grid, const char *path, const char *tag, struct err *err);
bool cloud_grid_load(struct cloud_grid **grid, char **tag, const char *path);

/* The ball for which it was made. */
void cloud_grid_subject(struct sfm_subject *out, const struct cloud_grid *grid, const struct cloud_conf *conf);

/* Writes a PLY with normals, as COLMAP's meshers read it. Returns false, err set, when it cannot. */
bool cloud_save(const struct cloud_points *points, const char *path, struct err *err);

#endif
