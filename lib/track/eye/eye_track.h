/* eye_track: gaze with torsion, both lid margins, blinks and saccades of both eyes of a video, frame by frame.
 * Model: the limbus is a circle on a sphere (the globe) that rotates about its centre; the centre moves with the head.
 * Head frame: the subject mesh's axes (x to the person's left, y up, z out of the face), mm. Without a mesh: the
 * camera's at the first frame with y and z negated, cam_from_head = diag(1, -1, -1, 1).
 * Image: px, x right, y down, centre of the first pixel (0.5, 0.5).
 *
 *     struct eye_track *track = eye_track_new(&scene, &conf);
 *     eye_track_learn(track, eye, &open) for each eye, where the clip may not begin with open eyes
 *     for each frame: for each eye: eye_track_push(track, eye, &frame);
 *     eye_track_finish(&clip, track); ... eye_clip_free(&clip); eye_track_free(track);
 */
#ifndef TRACK_EYE_EYE_TRACK_H
#define TRACK_EYE_EYE_TRACK_H
#include <stdint.h>

#include "anatomy/eye.h"
#include "base/bulk.h"
#include "base/pack.h"
#include "track/eye/eye_track_opts.h"

enum { SIDE_LEFT, SIDE_RIGHT, SIDES };  // the person's
enum { LID_UPPER, LID_LOWER, LIDS };
enum { LID_POINTS_MAX = 22 };

/* Prior knowledge of one eye; NAN where there is none. */
struct eye_prior {
	bool absent;                // known not to be in the video
	double center_in_head[3];   // eyeball
	double center_sigma;        // mm, standard deviation each way; 0: conf's
	double radius;              // of the sphere that the limbus lies on, mm
	double limbus;              // its radius, mm; 0: scene's eye's
	bool average;               // an average eye's, not the person's: conf's free_radius and edge_sigma
	double view_sigma[2];       // radians: error of the line of sight from the camera to the eye, h and v; as an unknown focal length makes
	double canthus_in_head[2][3];  // inner, outer corner of the opening
	double limbus_px[3];        // centre and radius of the limbus in the first frame, where there is no mesh
};

struct eye_scene {
	int width, height;          // px
	double fps;
	struct camera camera;       // focal_px NAN: as if the eye were one metre away
	struct eye eye;             // cornea, limbus and iris of an average eye; scaled to the limbus found
	bool head_known;            // cam_from_head is a pose in mm from a mesh; else motion of the image alone
	struct eye_prior prior[SIDES];
	double head_sigma[2];       // radians: common error of the head's poses, yaw and pitch; gaze is against the head
	struct bulk *bulk;          // where what is kept of every frame lies; null: in memory. It outlives the track and its eye_clip
};

struct eye_frame {
	const uint8_t *luma;        // [height][luma_stride]
	const uint8_t *rgb;         // [height][rgb_stride], three bytes a pixel
	int luma_stride, rgb_stride;
	double time;                // seconds, of the middle of the exposure
	double cam_from_head[4][4];
	const struct evidence *evidence[SIDES];  // of the pixels round each eye (limbus/evidence.h); null: none
};

enum blink_state { BLINK_OPEN, BLINK_CLOSING, BLINK_CLOSED, BLINK_OPENING };

struct eye_state {
	double time;
	double gaze[3], sigma[3];   // Fick h, v, torsion, radians; NAN where not measured
	double confidence;          // of gaze, 0..1; 0: not measured
	double openness;            // 0 closed, 1 the usual opening at this gaze; NAN where not measured
	enum blink_state blink;
	double limbus[5];           // centre x, y, semi-axes, angle of its ellipse, px; NAN
	int lid_points;
	double lid[LIDS][LID_POINTS_MAX][2];  // control points on the margin, inner canthus first; NAN
	double lid_confidence[LIDS];
};

struct eye_event {              // a blink or a saccade of one eye
	enum { EVENT_BLINK, EVENT_SACCADE } kind;
	int side, first, last, peak;  // frames; peak: most closed, or fastest
	double amplitude;           // blink: share of the opening that was shut; saccade: radians
	double peak_speed;          // saccade: radians/s
};

struct eye_globe {              // one eyeball, from the whole clip
	bool seen;
	double center_in_head[3], center_sigma[3], radius, limbus_radius;  // mm
	double told_sigma;          // mm: of the centre told before, which that is drawn to
	double rms_px;              // residual of the limbus edges
	int frames;                 // with gaze
};

struct eye_clip {
	int frames, events;
	struct eye_state (*state)[SIDES];  // [frames]; owned
	struct eye_event *event;    // in order of their first frame; owned
	struct eye_globe globe[SIDES];
	struct bulk *bulk;          // of the scene: state lies there
};

struct eye_track;

/* Copies scene and conf; eye_track_free. An eye whose prior lies outside the picture is absent. Never fails. */
struct eye_track *eye_track_new(const struct eye_scene *scene, const struct eye_track_conf *conf);

/* Measures one eye in the next frame. Frames come in order, the same ones for both eyes; the two eyes may be pushed from two
 * threads at once. The frame is not kept. Returns the first estimate, valid until the next push of this eye. */
const struct eye_state *eye_track_push(struct eye_track *track, int side, const struct eye_frame *frame);

/* Learns the appearance of the opening, its corners and the iris from a frame in which the eye is open, instead of from the
 * first frames of the clip. Before the first push of that eye. The frame is not part of the result. */
void eye_track_learn(struct eye_track *track, int side, const struct eye_frame *frame);

/* Its state after a push (base/pack.h), and what it keeps of the frames from `first` on. Read into a track made of the same scene, settings and learnt frame, which has
 * the frames before. */
void eye_track_pack(struct pack *pack, struct eye_track *track, long first);

/* Replaces the head's pose in a frame already pushed, for the fit of eye_track_finish. */
void eye_track_head_was(struct eye_track *track, long frame, const double cam_from_head[4][4]);

/* Eyes that hold the head (clip/hold.h), for the same: their centres lie between their corners to center_mm, the head's place in the picture is known in each frame to place_mm, and
 * how it is turned, aside and up and down, to `turn` radians, one standard deviation each. */
void eye_track_held(struct eye_track *track, double center_mm, double place_mm, const double turn[2]);

/* Fits the eyeballs to the whole clip (gaze/bundle.h), then estimates gaze, lids and openness again and finds blinks and
 * saccades.
 * clip: overwritten; eye_clip_free in any case. Returns false, err set, when no eye was found in any frame. */
bool eye_track_finish(struct eye_clip *clip, struct eye_track *track, struct err *err);

void eye_clip_free(struct eye_clip *clip);
void eye_track_free(struct eye_track *track);

#endif
