/* track: what the files of the stage share: a video and the head in it, followed frame by frame. */
#ifndef TRACK_H
#define TRACK_H
#include "base/stage.h"
#include "image/video.h"
#include "mesh/mesh.h"
#include "skin/eye_track.h"
#include "skin/head_find.h"
#include "skin/skin_track.h"
#include "skin/wrinkle.h"

struct track_conf {
	struct video_conf video;
	struct eye eye;
	struct eye_track_conf eyes;
	struct skin_track_conf skin;
	struct head_find_conf head;
	struct wrinkle_conf wrinkle;
	double focal_px, focal_mm, sensor_mm, center_px[2], distortion[5];
	double unit_mm, eye_radius;                  // subject.*: NAN where not given
	struct opt_each_list landmark, eye_center;   // subject.landmark.*, subject.eye_center.*
	struct opt_each_list landmark_px, expression;
	double distance_mm;    // of the face from a camera of which nothing is known
	int reference;         // frame that the mesh is laid on; -1: the first in which eyes are found
	int search;            // frames looked through for it
	int settle;            // frames in which the eyeballs' centres are looked for before the head's pose is settled
	double settle_sigma, center_sigma;  // mm: eyeballs' centres meanwhile; how well the mesh knows them
	int points;            // of skin
	long limit;            // frames followed; 0: all
	double meniscus_mm;    // that the edge of a lid's margin stands off the eye in the corners
	double reach_mm;       // round an eyeball's centre
	double gap_px;         // points are no closer
	double cut;            // share of the points that must be seen again, or there was a cut
	double still_pose_px;  // robust scale of a point off the head's motion
};

enum { MARK_INNER, MARK_OUTER, MARK_UPPER, MARK_LOWER, MARKS };

/* The person's mesh, in mm, and where its eyes are. */
struct track_subject {
	struct mesh mesh;      // n_vertices 0: there is none
	const char *file;      // relative to the capture; owned by the stage
	double unit_mm;
	int mark[SIDES][MARKS];          // rows; -1: not known
	double center[SIDES][3], radius; // of the eyeballs; NAN where not known
	struct eye_opening opening[SIDES];
	struct eye_opening margin[SIDES];  // where the lids stand clear of the eye and its tears: the inner edge of their margins
	bool assumed;          // there is no mesh: openings of a usual face, to find eyes with
};

/* A frame in which calibrate has found the head. */
struct track_known {
	long frame;
	double cam_from_head[4][4], residual_px;
};

/* The clip as it lies before the first frame is followed. */
struct track_clip {
	char file[320];        // relative to the capture
	struct video_info info;
	struct camera camera;
	bool focal_assumed;
	long reference;
	double cam_from_head[4][4];      // at the reference
	bool eye_seen[SIDES];
	uint8_t *luma, *rgb;             // of the reference [height][width]; owned
	double pose_px;        // rms of what the pose was found from
	bool pose_given;       // from track.landmark_*, or known
	struct track_known *known;       // by rig.json, of this video and of its own mesh; owned
	int n_known;
};

/* Points of skin: rows of the mesh and where they are at the reference. */
struct track_points {
	int n;
	int32_t *vertex;
	double (*head)[3];     // mm
	struct skin_points points;
	uint8_t *mask;         // [height][width] 0 where the picture shows no skin
};

/* Everything found, frame by frame. */
struct track_result {
	long n;
	int n_points;
	double *time;          // [n]
	bool *lost_at;         // [n]
	double (*pose)[4][4];  // [n]
	float (*skin)[2];      // [n][n_points] px
	float (*skin_model)[2];
	float *confidence;     // [n][n_points]
	struct eye_clip eyes;
	struct film *film;     // null where the clip is only looked at
	struct folds *folds;   // null, too, where there are no expressions or no points
	bool has_eyes;
	bool rests;            // the head, on a rest: every pose is the reference's
	float (*lids)[2], (*lids_model)[2];  // [n][4][lid_points]
	int lid_points;
	double *g;             // [n][10 + n_au], gaze.csv's units
	int n_au;
	long still, lost, cut; // frames; the first frame after a cut, or -1
	double seconds_decode;
};

bool track_subject_load(struct track_subject *subject, struct stage *stage, const struct track_conf *conf, struct err *err);
void track_subject_free(struct track_subject *subject);

/* The first file of video/; false, err set, when there is none. */
bool track_video(char file[320], int *others, struct stage *stage, struct err *err);

/* file is set. */
bool track_clip_open(struct track_clip *clip, struct stage *stage, const struct track_subject *subject,
                     const struct track_conf *conf, struct err *err);
void track_clip_free(struct track_clip *clip);

/* Improves the pose by the centres that the eyes turn about in the first frames. */
void track_settle(struct track_clip *clip, struct stage *stage, const struct track_subject *subject, const struct track_conf *conf);

bool track_points_choose(struct track_points *points, const struct track_clip *clip, const struct track_subject *subject,
                         const struct track_conf *conf, struct err *err);
void track_points_free(struct track_points *points);

bool track_follow(struct track_result *result, struct stage *stage, const struct track_clip *clip,
                  const struct track_subject *subject, const struct track_points *points, const struct track_conf *conf,
                  struct err *err);

/* After the last frame: whether the head rests, and else its path. */
void track_steady(struct track_result *result, const struct track_points *points, const struct track_subject *subject,
                  const struct track_clip *clip);

/* Whether a point of the skin moves with the eyelids. */
bool track_on_lid(const double head[3], const struct track_subject *subject);

struct track_eyes;
struct track_eyes *track_eyes_new(const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf);
void track_eyes_push(struct track_eyes *eyes, const struct video_frame *frame, const double cam_from_head[4][4]);
bool track_eyes_finish(struct track_result *result, struct track_eyes *eyes, struct err *err);
void track_eyes_free(struct track_eyes *eyes);

/* Files of the stage, relative to the capture. */
enum { TRACK_FILES = 10 };
extern const char *const track_files[TRACK_FILES];

/* Ends of the margins by the mesh and the skin beside them. */
void track_corners(struct track_result *result, const struct track_clip *clip, const struct track_subject *subject,
                   const struct track_points *points);

/* g4, g5, g9, g10 and the lids in the modelling camera. */
void track_apertures(struct track_result *result, const struct track_clip *clip, const struct track_subject *subject);

/* A pixel of frame f in the modelling camera: the point of the head that it shows, as far away as `head` (mm), moves with the
 * head to where that was at the reference. */
void track_to_model(float out[2], const double px[2], const double head[3], const double pose[4][4], const struct track_clip *clip);

/* Strengths of capture.conf's expressions. */
bool track_expressions(struct track_result *result, struct stage *stage, const struct track_conf *conf, struct err *err);

void track_result_free(struct track_result *result);

bool track_save(struct stage *stage, const struct track_result *result, const struct track_clip *clip,
                const struct track_points *points, int n, const char *const in[], struct err *err);
bool track_stage(struct stage *stage, const struct track_conf *conf, struct err *err);

#endif
