/* eye_track_impl: the state of one eye of eye_track, and what its files share. */
#ifndef TRACK_EYE_EYE_TRACK_IMPL_H
#define TRACK_EYE_EYE_TRACK_IMPL_H
#include "track/eye/eye_track.h"
#include "track/gaze/edge.h"
#include "track/gaze/torsion.h"
#include "track/lid/fine.h"
#include "track/lid/lid_track.h"

enum { EYE_STILL_SIDE = 24 };

/* What the fit over the whole clip keeps of a frame. */
struct eye_record {
	double cam_from_head[3][4];
	double fick[2];
	float mm;                  // px in a millimetre
	struct lid_found found;
	long first_edge;           // index into eye_side.edge
	int edges;                 // 0: no gaze
	bool measured, open;       // lids were searched; an opening was found
	bool still;
};

struct eye_side {
	int side;
	bool absent, started;
	const struct eye_scene *scene;
	const struct eye_track_conf *conf;
	struct gaze_globe globe, first_globe;
	double center_sigma[3], rms;
	double center_guess;       // mm: standard deviation of the centre given
	bool average;              // its radius is an average eye's
	double radius_sigma;       // mm: of first_globe's radius
	double view_sigma[2];      // radians: of the line of sight from the camera to the eye
	double place_sigma, turn_sigma[2];  // mm, radians: error of the head's place in each frame, and of its turn aside and up and down
	double canthus[2][3];      // head frame
	bool corners_guessed;      // until lids are found
	double fick[2];            // last gaze
	bool have;                 // fick is valid: measured less than a second ago
	double lost_s;             // seconds since gaze was measured
	double denied_s;           // seconds since when lids seem shut though evidence shows an open eye
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
	long edges, edge_space, edges_packed;
	struct gaze_edge *edge;
};

struct eye_track {
	struct eye_scene scene;
	struct eye_track_conf conf;
	struct eye_side side[SIDES];
};

/* Camera of a frame; an unknown focal length is that of a camera one metre away. */
void eye_view(struct gaze_view *view, const struct eye_scene *scene, const double cam_from_head[3][4]);

/* px in a millimetre at the eyeball's front; NAN behind the camera. */
double eye_scale(const struct gaze_globe *globe, const struct gaze_view *view);

/* Rough gaze into eye->fick by gaze_seek(): near the last gaze, else (or where `anywhere`) in a range of 36 degrees. Returns
 * its score; from EYE_FOUND on an eye is there. */
double eye_seek(struct eye_side *eye, const struct luma *luma, const struct gaze_view *view, const struct evidence *evidence, bool anywhere);
static const double EYE_FOUND = 0.35;

/* Gaze and torsion from what is visible between the lids of this frame; state is left as it was where they cannot be measured. */
void eye_measure(struct eye_state *state, struct eye_record *record, struct eye_side *eye, const struct luma *luma,
                 const struct gaze_view *view, const struct evidence *evidence);

/* Measures one frame of one eye and appends the result. */
void eye_side_push(struct eye_side *eye, const struct eye_frame *frame);

/* Makes room for so many frames, so many edges in all. */
void eye_side_room(struct eye_side *eye, long frames, long edges);

/* eye_track_pack() of one eye. Edges of the frames before first are there already, those since are new. pack.c */
void eye_side_pack(struct pack *pack, struct eye_side *eye, long first);

/* Learns the appearance of the eye from a frame without appending it. */
void eye_side_learn(struct eye_side *eye, const struct eye_frame *frame);

/* Copies the lids found in a frame into its state. */
void eye_fill_lids(struct eye_state *state, const struct lid_found *found, int points);

/* What the clip alone tells of the eyeball's radius, without its prior: value and standard deviation, mm. Returns false where it tells nothing. */
bool eye_side_radius(double *radius, double *sigma, const struct eye_side *eye);

/* Before average eyes settle: what the clip tells of the other eyeball's radius joins the prior of each, as a person's two differ by alike (mm, one
 * standard deviation). */
void eye_pair_alike(struct eye_side *left, struct eye_side *right, double alike);

/* Estimates eyeball, gaze, torsion and lids of all frames again from the whole clip. */
void eye_side_settle(struct eye_side *eye);

/* Estimates all margins again with the colours of the whole clip. */
void eye_settle_lids(struct eye_side *eye);

/* The eyeball that was fitted. */
void eye_side_globe(struct eye_globe *globe, const struct eye_side *eye);

/* After both have settled: removes a constant vertical disparity between the eyes by shifting their centres in proportion to
 * their variances. A disparity beyond three sigma is strabismus and is left. */
void eye_pair_level(struct eye_side *left, struct eye_side *right);

/* Forgets gaze where the two eyes look further apart than they mostly do by more than most_deg (horizontally: vergence; vertically: none but what
 * is measured): of the eye whose confidence is the lower for that eye, and of either with less than the share `poor` of its usual one. pair.c */
void eye_pair_doubt(struct eye_side *left, struct eye_side *right, const double most_deg[2], double poor);

/* Sets openness and blink of one eye's states; appends its blinks and saccades to clip. */
void eye_side_events(struct eye_clip *clip, struct eye_side *eye, int side);

/* After both: removes blinks that one eye made alone, shut by less than half while the other was open. */
void eye_pair_blinks(struct eye_clip *clip, struct eye_side side[SIDES]);

#endif
