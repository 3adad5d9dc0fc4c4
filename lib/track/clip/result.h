/* result: everything measured in a clip, frame by frame. Arrays are owned; frames are those that were followed. */
#ifndef TRACK_CLIP_RESULT_H
#define TRACK_CLIP_RESULT_H
#include "track/eye/eye_track.h"

struct track_result {
	long n;                // frames
	int n_points;
	double *time;          // [n] s
	bool *lost_at;         // [n] the face is not the reference's: nothing is measured
	bool *unsure_at;       // [n] of a head that turns: its skin stirs too much to tell the pose, which goes on between the frames about it; null: none
	double (*pose)[4][4];  // [n] cam_from_head
	float (*skin)[2];      // [n][n_points] px
	float (*skin_model)[2];  // [n][n_points] px of the modelling camera
	float *confidence;     // [n][n_points] 0..1, 0 not seen
	struct eye_clip eyes;
	struct film *film;     // null where the clip is only looked at
	struct folds *folds;   // likewise, and null where there are no expressions or no points
	bool has_eyes;
	double *misfit;        // [n] px, median residual of the skin, lids excepted, against the rigid head; null without points
	bool rests;            // the head is on a rest: every pose is the reference's
	float (*lids)[2], (*lids_model)[2];  // [n][4][lid_points] px; px of the modelling camera
	int lid_points;
	double *g;             // [n][10 + n_au], gaze.csv's units
	double (*aperture_sigma)[SIDES][LIDS];  // [n] px, standard deviations of g4, g5, g9, g10; NAN where those are; null without eyes
	int n_au;
	long still, lost, unsure, cut;  // frames that stand still; frames lost; frames unsure; the first frame after a cut, or -1
};

void track_result_free(struct track_result *result);

#endif
