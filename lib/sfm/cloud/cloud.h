/* cloud: a dense cloud of oriented points from pairs of pictures with known cameras.
 * World: the model's own frame and unit. Pictures: grey, the size the model's cameras speak of or smaller.
 */
#ifndef SFM_CLOUD_CLOUD_H
#define SFM_CLOUD_CLOUD_H
#include <stddef.h>
#include <stdint.h>

#include "bridge/cv_stereo.h"
#include "sfm/colmap/colmap.h"
#include "sfm/head/sfm_frame.h"

/* Two images that see the same surface under an angle that tells depth. */
struct cloud_pair {
	int a, b;      // indices into the model's images, a < b
	double score;
};

struct cloud_conf {
	int neighbours;            // pairs of an image, at most
	double best_angle;         // radians between the two views: smaller ones tell less, larger ones match less
	int size_px;               // the subject's diameter in the rectified pictures
	int max_range;             // disparities that are tried, at most
	double voxel;              // edge of a cell in which points are averaged, of the subject's radius
	int min_pairs;             // pairs that have to agree on a cell, with its neighbours
	double max_slant;          // radians: steeper surfaces are left to other views
	struct cv_stereo_conf stereo;
};

/* Pairs with one image at least for which is_new (null: all), best first for each image; sorted by (a, b). *n of them;
 * free(). */
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

/* Rectifies, matches, and appends what lies in the subject's ball. Lens distortion is taken out on the way. */
bool cloud_stereo(struct cloud_points *points, const struct colmap_model *model, const struct cloud_pair *pair,
                  const struct cloud_picture *a, const struct cloud_picture *b, const struct sfm_subject *subject,
                  const struct cloud_conf *conf, struct err *err);
void cloud_points_free(struct cloud_points *points);

/* Cells of the subject's ball that averages are kept in; the same whatever the order of the pairs' points within rounding,
 * and the same to the bit for the same order. */
struct cloud_grid;
struct cloud_grid *cloud_grid_new(const struct sfm_subject *subject, const struct cloud_conf *conf);
void cloud_grid_free(struct cloud_grid *grid);

/* One pair's points. */
void cloud_grid_add(struct cloud_grid *grid, const struct cloud_points *points);

/* One point a cell that enough pairs agree on, in a fixed order. cloud_points_free. */
void cloud_grid_points(struct cloud_points *out, const struct cloud_grid *grid, const struct cloud_conf *conf);

/* Kept between runs. tag: what it was made from, the caller's own words; free(). load: false without an error when the file
 * is missing or not one of these. */
bool cloud_grid_save(const struct cloud_grid *grid, const char *path, const char *tag, struct err *err);
bool cloud_grid_load(struct cloud_grid **grid, char **tag, const char *path);

/* The ball it was made for. */
void cloud_grid_subject(struct sfm_subject *out, const struct cloud_grid *grid, const struct cloud_conf *conf);

/* PLY with normals, as COLMAP's meshers read it. */
bool cloud_save(const struct cloud_points *points, const char *path, struct err *err);

#endif
