/* clip_truth: a rendered clip of data/video with the truth of its eyes: gaze, lids, head.
 */
#ifndef TESTS_CLIP_TRUTH_H
#define TESTS_CLIP_TRUTH_H
#include "base/err.h"
#include "track/eye/eye_track.h"

enum { CLIP_UPPER = 20, CLIP_LOWER = 24 };  // points of the true margins

struct clip_truth {
	int frames;
	double focal_px, center_px[2];
	double eye_center[SIDES][3], eye_radius;     // mm
	bool in_view[SIDES];
	double *head_R, *head_t;                     // [frames][3][3], [frames][3] cm
	double *gaze[SIDES];                         // [frames][3] degrees
	double *lid[SIDES][LIDS];                    // [frames][points][2] px
	double *lid_head[SIDES];                     // upper, [frames][points][3] cm
	double *openness[SIDES];                     // [frames]
};

bool clip_truth_load(struct clip_truth *truth, const char *dir, struct err *err);
void clip_truth_free(struct clip_truth *truth);

/* What a user would give: camera, eyeballs `off` mm from where they are, corners of the eyes in the first frame. */
struct eye_scene clip_truth_scene(const struct clip_truth *truth, const struct eye *eye, double off);

/* Decodes the clip in `dir` and pushes all of it. */
void clip_truth_push(struct eye_track *track, const struct clip_truth *truth, const char *dir);

struct clip_truth_error {
	double gaze[3], gaze95[3];  // degrees: median, 95 %, of h, v, torsion in frames at least 60 % open
	double lid[LIDS], lid95[LIDS];  // px from the true margins
	int missing, invented;      // open frames without gaze, shut ones with
};

struct clip_truth_error clip_truth_compare(const struct eye_clip *clip, const struct clip_truth *truth, int side);

#endif
