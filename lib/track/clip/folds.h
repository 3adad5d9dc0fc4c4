/* folds: wrinkle lines of capture.conf's expressions: keeps the frames that show them while the clip is followed, then finds
 * them. */
#ifndef TRACK_CLIP_FOLDS_H
#define TRACK_CLIP_FOLDS_H
#include "track/clip/points.h"
#include "track/clip/result.h"

struct folds;

/* Null where there are no expressions or no points. */
struct folds *folds_new(const struct track_clip *clip, const struct track_points *points, const struct track_conf *conf);

/* Keeps the green channel of a frame between an expression's neutral and peak frame; folds may be null. */
void folds_add(struct folds *folds, const struct video_frame *frame);

/* The pictures of frames from `first` on (base/pack.h); folds may be null. Read into folds of the same clip and settings. */
void folds_pack(struct pack *pack, struct folds *folds, long first);
void folds_free(struct folds *folds);

/* The lines found, and what they were found in. */
struct folds_found {
	struct wrinkles wrinkles;
	struct wrinkle_ground ground;
	struct wrinkle_frame *neutral, *peak;  // [expressions]; owned; their pictures and points are borrowed of folds and result
	uint8_t *mask;             // borrowed by ground; owned, as are the next two
	float (*normals)[3];
	struct ray_scene *rays;
};

/* Finds the lines of every expression; those of an expression whose frames are lost are none, which stage is told.
 * found: overwritten; folds_found_free in any case. folds, result, clip, subject and points must outlive it.
 * Returns false, err set, as wrinkle_find does. */
bool folds_find(struct folds_found *found, const struct folds *folds, struct stage *stage, const struct track_result *result,
                const struct track_clip *clip, const struct track_subject *subject, const struct track_points *points,
                const struct track_conf *conf, struct err *err);
void folds_found_free(struct folds_found *found);

#endif
