/* track: what the files of the stage share: a video and the head in it, followed frame by frame. */
#ifndef TRACK_CLIP_TRACK_H
#define TRACK_CLIP_TRACK_H
#include "track/clip/clip.h"

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
	double *misfit;        // [n] px that skin, but for the lids, is off where the head takes it, median; null without points
	bool rests;            // the head, on a rest: every pose is the reference's
	float (*lids)[2], (*lids_model)[2];  // [n][4][lid_points]
	int lid_points;
	double *g;             // [n][10 + n_au], gaze.csv's units
	int n_au;
	long still, lost, cut; // frames; the first frame after a cut, or -1
	double seconds_decode;
};

bool track_follow(struct track_result *result, struct stage *stage, const struct track_clip *clip,
                  const struct track_subject *subject, const struct track_points *points, const struct track_conf *conf,
                  struct err *err);

/* After the last frame: whether the head rests, and else its path. reference: which of the frames that were followed it is. */
void track_steady(struct track_result *result, long reference, const struct track_points *points, const struct track_subject *subject,
                  const struct track_clip *clip);

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
