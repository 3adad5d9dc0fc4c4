/* skin_points: runs skin_track, or OpenCV's optical flow, on a rendered clip, every point begun at its true place in the first
 * frame. */
#ifndef TESTS_SKIN_POINTS_H
#define TESTS_SKIN_POINTS_H
#include "bridge/cv_flow.h"
#include "track/points/skin_track.h"
#include "tests/lib/score/track_score.h"

/* The defaults of config/track.conf. */
static const struct skin_track_conf skin_track_review = {
	.radius = 10, .every = 1, .levels = 4, .iterations = 12, .stop = 0.02, .noise = 2, .misfit = 8, .min_ncc = 0.55, .smooth = 0.5, .agree = 0.1,
	.outlier = 4, .sweeps = 2, .still = 0.05,
};
static const struct skin_track_conf skin_track_draft = {
	.radius = 8, .every = 2, .levels = 4, .iterations = 8, .stop = 0.05, .noise = 2, .misfit = 8, .min_ncc = 0.55, .smooth = 0.5, .agree = 0.6,
	.outlier = 4, .sweeps = 1, .still = 0.05, .quiet = 0.3,
};

struct skin_points_score {
	int points;
	struct spread all, first, last;  // px: points in sight that are seen; in the first and last tenth of the clip
	struct spread again;             // in the first tenth, shown a second time after the last: what is worse than the first time is drift
	double first_alike;              // px, median of the first tenth, as if its points had moved as far since the reference as the last's
	double seen;                     // share of those in sight
	double seconds;                  // a frame, without decoding
};

/* How they are followed: by skin_track, or by motion from each frame to the next (chained) or from the first to each. */
struct skin_points_way {
	const struct skin_track_conf *conf;  // null: the motion
	enum cv_flow_method flow;
	bool chained;
	long frames;                         // at most; 0: all
};

/* dir: folder of video.mp4 and truth.npz. At most `most` points, spread evenly. `again` of skin_track on the whole clip alone.
 * False, err set, where a file is missing. */
bool skin_points_follow(struct skin_points_score *score, const char *dir, int most, const struct skin_points_way *way, struct err *err);

#endif
