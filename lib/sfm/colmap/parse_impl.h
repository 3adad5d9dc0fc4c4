/* parse_impl: private to the readers of COLMAP's files. */
#ifndef SFM_COLMAP_PARSE_IMPL_H
#define SFM_COLMAP_PARSE_IMPL_H
#include <string.h>

#include "sfm/colmap/colmap.h"

/* References by ids, as the files have them; colmap_link turns them into indices. */
struct colmap_raw {
	uint64_t *seen_point;                 // of every observation of every image, in order; UINT64_MAX: none
	uint32_t *image_camera;               // of every image
	struct { uint32_t image, seen; } *track;  // of every point, in order
	long n_seen, n_track;
};

/* Read the three files into model and raw. Return false, err set (file, and the line of a text), at the first fault. */
bool colmap_parse_binary(struct colmap_model *model, struct colmap_raw *raw, const char *const data[3],
                         const size_t size[3], const char *const where[3], struct err *err);
bool colmap_parse_text(struct colmap_model *model, struct colmap_raw *raw, const char *const data[3],
                       const size_t size[3], const char *const where[3], struct err *err);

/* Checks the ranges of what has been read, sorts it by id, and turns ids into indices. */
bool colmap_link(struct colmap_model *model, const struct colmap_raw *raw, const char *const where[3], struct err *err);

#endif
