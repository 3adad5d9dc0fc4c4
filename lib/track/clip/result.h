/* result: everything measured in a clip, frame by frame. Arrays are owned, those marked bulk by base/bulk.h; frames are those that were followed. */
#ifndef TRACK_CLIP_RESULT_H
#define TRACK_CLIP_RESULT_H
#include "track/eye/eye_track.h"

/* Evidence for a clip that was followed rightly: see trust.h. */
enum { TRUST_LAID, TRUST_SKIN, TRUST_LEVEL, TRUST_APART, TRUST_IRIS, TRUST_SCALE, TRUST_STRAIGHT, TRUST_TURNED, TRUST_UNLIKE, TRUST_EVIDENCES };
struct track_trust {
	double value[TRUST_EVIDENCES], log_odds[TRUST_EVIDENCES];  // NAN, 0 where the clip does not tell it
	double far;            // probability that gaze is off by more than wrong_deg, by its own standard deviations
	double lens;           // probability that the lens told is wrong
	double wrong;          // probability that the result is wrong: followed wrongly, or off by so much, or seen through another lens
};

/* Line of sight against the optical axis: see kappa.h. */
struct track_kappa {
	double angle[SIDES][2], sigma[SIDES][2];  // radians; towards the nose, up
	int frames[SIDES];     // that measured it; 0: the prior
};

struct track_result {
	struct bulk *bulk;     // where the arrays that are long lie (those marked bulk, and eyes'); owned; null: in memory
	long n;                // frames
	int n_points;
	double *time;          // [n] s
	bool *lost_at;         // [n] the face is not the reference's: nothing is measured
	bool *unsure_at;       // [n] of a head that turns: its skin stirs too much to tell the pose, which goes on between the frames about it; null: none
	double (*pose)[4][4];  // [n] cam_from_head
	float (*skin)[2];      // [n][n_points] px; bulk
	float (*skin_model)[2];  // [n][n_points] px of the modelling camera; bulk
	float *confidence;     // [n][n_points] 0..1, 0 not seen; bulk
	struct eye_clip eyes;
	struct film *film;     // null where the clip is only looked at
	struct folds *folds;   // likewise, and null where there are no expressions or no points
	bool has_eyes;
	double *misfit;        // [n] px, median residual of the skin, lids excepted, against the rigid head; null without points
	double place_mm;       // standard deviation of the head's place where the eyes hold it (hold.h); 0: they do not
	double unlike;         // radians, how unlike a face it is that holds the eyes (hold_unlike); NAN, 0: not looked at
	bool rests;            // the head is on a rest: every pose is the reference's
	float (*lids)[2], (*lids_model)[2];  // [n][4][lid_points] px; px of the modelling camera; bulk
	int lid_points;
	double *g;             // [n][10 + n_au], gaze.csv's units
	struct track_trust trust;
	struct track_kappa kappa;
	double (*aperture_sigma)[SIDES][LIDS];  // [n] px, standard deviations of g4, g5, g9, g10; NAN where those are; null without eyes
	double meeting_sigma[SIDES];            // px, of that the part that is in all of an eye's frames: where its lids meet
	int n_au;
	long still, lost, unsure, cut;  // frames that stand still; frames lost; frames unsure; the first frame after a cut, or -1
};

/* Makes room for so many frames in the arrays that are filled frame by frame. room: how many they have room for; kept by the caller. */
void track_result_room(struct track_result *result, long *room, long frames);
void track_result_free(struct track_result *result);

#endif
