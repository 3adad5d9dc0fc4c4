/* clip: a video before its frames are followed: camera, reference frame, head pose in that frame.
 * The modelling camera is this camera with the head fixed where the reference frame shows it.
 * Image  px, x right, y down, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_CLIP_CLIP_H
#define TRACK_CLIP_CLIP_H
#include "image/patch/patch.h"
#include "track/clip/subject.h"
#include "track/head/lens.h"

/* A frame whose head pose is known: calibrate has estimated it, or the skin's motion tells it. */
struct track_known {
	long frame;
	double cam_from_head[4][4], residual_px;
};

/* How the skin moves over the clip, seen quickly (moves.h). */
struct track_moves {
	int n;                 // points; 0: not known
	long frames;           // in order; [0] is one of the clip's first
	long reference;        // which of them is the reference
	long every, first_frame;   // of the clip: frames from one to the next, that of [0]
	double (*at)[2];       // [n] px in the reference
	double (*head)[3];     // [n] where the reference's pose said it is on the mesh, mm
	float (*px)[2];        // [frames][n]
	float *seen;           // [frames][n] confidence
	struct patch_warp *first;  // [n] at the clip's first frame
	int n_known;           // frames whose pose it tells
	struct track_known *known;
	double turned;         // radians: the head's largest turn between two of those; 0: not known
	double apart, sigma;   // radians: between the poses that two halves of the skin tell; standard deviation of the turn
	double off_mm;         // rms of the skin about the rigid head
	bool torn;             // so far that the mesh does not move as the skin does
	bool halves;           // nothing but those two poses says so
};

struct track_clip {
	char file[320];        // relative to the capture
	struct video_info info;
	struct camera camera;
	const char *made_by;   // what the result will be made from and with (stage_made_by): what was followed of it before stands only under the same
	bool focal_assumed;    // focal length from distance_mm
	long reference;        // frame that all others are compared with
	bool begins_shut;      // no open eyes where the clip begins: their looks are learnt from the reference frame
	double cam_from_head[4][4];      // at the reference
	bool eye_seen[SIDES];
	uint8_t *luma, *rgb;             // of the reference [height][width], [height][3 width]; owned
	double turn_sigma[2];  // radians: of the pose's pitch and yaw; 0: not known
	struct head_lens lens; // what the eyeballs and lids of several frames tell of it; sigma 0: nothing
	double pose_px;        // rms residual of the pose
	double shade_off, shade_patches; // ln: the face's brightness off that of the mesh there (head_form's); of so many patches of skin, 0: not known
	double skin_mm;        // skin off the rigid head in the frames that it was judged by (trust_skin_mm); NAN: not known
	bool pose_refined;     // by eyeballs and lids of several frames (refine.h); else pose_px is that of the outlines in the reference alone
	bool pose_given;       // from track.landmark_*, or known: not refined
	struct track_moves moves;        // owned
	struct track_known *known;       // from rig.json, of this video and calibrate's own mesh; owned
	int n_known;
	struct cv_face_finder *faces;  // null: not opened yet, or not installed; owned
};

/* n frames at 60 frames/s or less; of a faster clip as many as take the same time. */
long track_frames_of(const struct track_clip *clip, long n);

/* Takes the first file of video/ by name. file: its path relative to the capture; others: how many more there are.
 * Returns false, err set, when there is none. */
bool track_video(char file[320], int *others, struct stage *stage, struct err *err);

/* Reads camera and reference frame and finds the head there. clip->file must be set; track_clip_free in any case.
 * Returns false, err set, when the video cannot be read, the landmarks given fit no pose, or no face is found. */
bool track_clip_open(struct track_clip *clip, struct stage *stage, const struct track_subject *subject,
                     const struct track_conf *conf, struct err *err);
void track_clip_free(struct track_clip *clip);

/* Decodes another frame into luma, rgb and reference; the pose is left as it was: track_look finds it.
 * Returns false when the clip has no such frame; err is set only when it cannot be decoded. */
bool track_clip_take(struct track_clip *clip, long frame, struct stage *stage, const struct track_conf *conf, struct err *err);

/* Carries a pixel of a frame into the modelling camera: the point of the head that it shows, assumed at the depth of `head`
 * (mm), is moved with the head to its place at the reference. pose: cam_from_head of that frame. out: px; NAN where it cannot
 * be projected. */
void track_to_model(float out[2], const double px[2], const double head[3], const double pose[4][4], const struct track_clip *clip);

#endif
