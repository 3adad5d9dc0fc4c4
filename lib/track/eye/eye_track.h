/* eye_track: what happens inside the opening of the eyes of a video, frame by frame: gaze with torsion, both lid
 * margins, blinks, saccades.
 * Gaze is that of a circle, the limbus, on a sphere that turns about its centre; the centre moves with the head.
 * Head frame: the subject mesh's axes (x to the person's left, y up, z out of the face), mm. Without a mesh: the
 * camera's at the first frame with y and z turned round, cam_from_head = diag(1, -1, -1, 1).
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
#include "track/eye/eye_track_opts.h"

enum { SIDE_LEFT, SIDE_RIGHT, SIDES };  // the person's
enum { LID_UPPER, LID_LOWER, LIDS };
enum { LID_POINTS_MAX = 22 };

/* What is known of one eye beforehand; NAN where it is not. */
struct eye_prior {
	bool absent;                // known not to be in the video
	double center_in_head[3];   // eyeball
	double center_sigma;        // mm: how far off that may be, each way; 0: as far as conf says
	double radius;              // of the sphere that the limbus lies on, mm
	double canthus_in_head[2][3];  // inner, outer corner of the opening
	double limbus_px[3];        // centre and radius of the limbus in the first frame: where no mesh tells
};

struct eye_scene {
	int width, height;          // px
	double fps;
	struct camera camera;       // focal_px NAN: one metre away
	struct eye eye;             // cornea, limbus and iris as if for a usual eye; scaled with the limbus found
	bool head_known;            // cam_from_head is a pose in mm from a mesh; else only the image's own motion
	struct eye_prior prior[SIDES];
};

struct eye_frame {
	const uint8_t *luma;        // [height][luma_stride]
	const uint8_t *rgb;         // [height][rgb_stride], three bytes a pixel
	int luma_stride, rgb_stride;
	double time;                // seconds, of the middle of the exposure
	double cam_from_head[4][4];
};

enum blink_state { BLINK_OPEN, BLINK_CLOSING, BLINK_CLOSED, BLINK_OPENING };

struct eye_state {
	double time;
	double gaze[3], sigma[3];   // Fick h, v, torsion, radians; NAN where not measured
	double confidence;          // of gaze, 0..1; 0: not measured
	double openness;            // 0 closed, 1 as wide as is usual at this gaze; NAN where not measured
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
	double rms_px;              // limbus edges against the model
	int frames;                 // that have gaze
};

struct eye_clip {
	int frames, events;
	struct eye_state (*state)[SIDES];  // [frames]; owned
	struct eye_event *event;    // in order of their first frame; owned
	struct eye_globe globe[SIDES];
};

struct eye_track;

/* Never fails; an eye whose prior lies outside the picture is absent. */
struct eye_track *eye_track_new(const struct eye_scene *scene, const struct eye_track_conf *conf);

/* The next frame of one eye; frames in order, the same for both eyes. The two eyes may be pushed from two threads
 * at once. The frame is not kept. Returns what was found so far, valid until the next push of this eye. */
const struct eye_state *eye_track_push(struct eye_track *track, int side, const struct eye_frame *frame);

/* Before the first push of an eye: the looks of the opening, of its corners and of the iris are learnt from this frame, in which it is open, and not from
 * whatever the clip begins with. Nothing is kept of it otherwise. */
void eye_track_learn(struct eye_track *track, int side, const struct eye_frame *frame);

/* The head turns out to have been there in a frame pushed before. Before eye_track_finish. */
void eye_track_head_was(struct eye_track *track, long frame, const double cam_from_head[4][4]);

/* Clip-wide fit of the eyeballs, then gaze, openness, blinks, saccades anew. False, err set, where no eye was found
 * in any frame. clip is overwritten; eye_clip_free. */
bool eye_track_finish(struct eye_clip *clip, struct eye_track *track, struct err *err);
void eye_clip_free(struct eye_clip *clip);
void eye_track_free(struct eye_track *track);

#endif
