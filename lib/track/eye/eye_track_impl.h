/* eye_track_impl: one eye of eye_track, between the frames. */
#ifndef TRACK_EYE_EYE_TRACK_IMPL_H
#define TRACK_EYE_EYE_TRACK_IMPL_H
#include "track/eye/eye_track.h"
#include "track/gaze/edge.h"
#include "track/gaze/torsion.h"
#include "track/lid/fine.h"
#include "track/lid/lid_track.h"

enum { EYE_STILL_SIDE = 24 };

/* What the fit over the whole clip needs of a frame. */
struct eye_record {
	double cam_from_head[3][4];
	double fick[2];
	float mm;                  // px
	struct lid_found found;
	long first_edge;           // in struct eye_side
	int edges;                 // 0: no gaze
	bool measured, open;       // lids were looked for; there was an opening
	bool still;
};

struct eye_side {
	bool absent, started;
	const struct eye_scene *scene;
	const struct eye_track_conf *conf;
	struct gaze_globe globe, first_globe;
	double center_sigma[3], rms;
	double center_guess;       // mm: how far the centre may be off what was given
	double canthus[2][3];      // head frame
	bool corners_guessed;      // until lids are found
	double fick[2];            // last gaze
	bool have;                 // it is of the last frame but for a blink
	double lost_s;             // seconds without gaze
	double contrast;           // grey levels from iris to sclera
	struct lid_track lids;
	struct gaze_torsion torsion;
	uint8_t still[EYE_STILL_SIDE * EYE_STILL_SIDE];
	struct eye_state last;
	long frames, space;
	struct eye_state *state;   // [frames]
	struct eye_record *record; // [frames]
	struct lid_kept *kept;     // [frames]
	struct lid_fine *fine;     // [frames] the upper margin
	long edges, edge_space;
	struct gaze_edge *edge;
};

struct eye_track {
	struct eye_scene scene;
	struct eye_track_conf conf;
	struct eye_side side[SIDES];
};

/* Camera of a frame; an unknown focal length is that of a camera one metre away. */
void eye_view(struct gaze_view *view, const struct eye_scene *scene, const double cam_from_head[3][4]);

/* px of a millimetre at the eyeball's front. NAN behind the camera. */
double eye_scale(const struct gaze_globe *globe, const struct gaze_view *view);

/* Roughly where it looks, into eye->fick: near where it last did, else anywhere. Returns the score of gaze_seek(); from
 * EYE_FOUND on it is an eye. */
double eye_seek(struct eye_side *eye, const struct luma *luma, const struct gaze_view *view, bool anywhere);
static const double EYE_FOUND = 0.35;

/* Gaze and torsion between the lids found in this frame; nothing where they cannot be measured. */
void eye_measure(struct eye_state *state, struct eye_record *record, struct eye_side *eye, const struct luma *luma,
                 const struct gaze_view *view);

/* One frame of one eye; the result is appended. */
void eye_side_push(struct eye_side *eye, const struct eye_frame *frame);

/* The looks of a frame that is not one of the clip's. */
void eye_side_learn(struct eye_side *eye, const struct eye_frame *frame);

/* Lids of a frame into its state, as found. */
void eye_fill_lids(struct eye_state *state, const struct lid_found *found, int points);

/* All frames once more with what the whole clip tells: eyeball, gaze, torsion, lids. */
void eye_side_settle(struct eye_side *eye);

/* All margins once more. */
void eye_settle_lids(struct eye_side *eye);

/* The eyeball as the clip has it. */
void eye_side_globe(struct eye_globe *globe, const struct eye_side *eye);

/* After both have settled: what is not level by no more than the eyeballs' centres are unsure of is shared between them. */
void eye_pair_level(struct eye_side *left, struct eye_side *right);

/* Openness and blinks of one eye, and its saccades; events are appended to clip. */
void eye_side_events(struct eye_clip *clip, struct eye_side *eye, int side);

/* Then: both eyes blink together. What one of them alone did, by less than a wink and while the other was open, was no blink. */
void eye_pair_blinks(struct eye_clip *clip, struct eye_side side[SIDES]);

#endif
