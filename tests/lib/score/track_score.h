/* track_score: errors of the artifacts of `track` against a rendered clip's truth. */
#ifndef TESTS_TRACK_SCORE_H
#define TESTS_TRACK_SCORE_H
#include "base/err.h"

struct spread {
	double median, p90, p95;
	long n;
};

/* Sorts x. */
struct spread spread_of(long n, double *x);

struct track_score {
	long frames;
	int points;
	struct spread skin;          // px, of what moved since the reference: of points seen that are in sight
	struct spread skin_first, skin_last;  // the same in the first and last tenth
	struct spread skin_place;    // px, where the mesh's vertices are said to be
	double skin_seen;            // share of the points in sight that are seen
	struct spread gaze[3];       // degrees, horizontal, vertical, torsion; open eyes
	double gaze_share;           // of the frames with open eyes that have gaze
	struct spread lid;           // px, of the margins' true points off the margins found
	double lid_share;            // of the frames that have margins
	struct spread aperture;      // px: g4 + g5 against the truth's
	int blinks, found, wrong;    // true ones, found, found where there is none
	double head_deg;             // median of the head's turn since the reference, degrees
	struct spread head_off;      // degrees, of the head's pose against the truth's; frames that are not lost
	struct spread head_at;       // mm, of the point between the eyes
	struct spread about[2];      // degrees: gaze about its offset, horizontal and vertical
	double offset[2][2];         // degrees: median of gaze less the truth's, of the left and the right eye, horizontal and vertical
	struct spread seen[2];       // degrees: gaze against the camera's axes, horizontal and vertical
	struct spread ratio[2];      // errors of gaze against the head, horizontal and vertical, over their own standard deviations
	double yaw, pitch;           // degrees: the head's largest turn in the truth
};

/* dir: the capture; truth: folder of truth.npz and truth.json. False, err set, where a file is missing. */
bool track_score(struct track_score *score, const char *dir, const char *truth, struct err *err);

/* The same where the video begins at frame `first` of the truth's. */
bool track_score_from(struct track_score *score, const char *dir, const char *truth, long first, struct err *err);

#endif
