/* clip: the video as it lies before its frames are followed: the camera, the reference frame and where the head is in it, the points of
 * skin. */
#ifndef TRACK_CLIP_CLIP_H
#define TRACK_CLIP_CLIP_H
#include "track/clip/subject.h"

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
	bool begins_shut;      // no open eyes where the clip begins: how they look is learnt from the reference
	double cam_from_head[4][4];      // at the reference
	bool eye_seen[SIDES];
	uint8_t *luma, *rgb;             // of the reference [height][width]; owned
	double pose_px;        // rms of what the pose was found from
	bool pose_given;       // from track.landmark_*, or known
	struct track_known *known;       // by rig.json, of this video and of its own mesh; owned
	int n_known;
	struct cv_face_finder *faces;  // null: not opened yet, or not installed
};

/* As many frames as make the time of n at 60 a second; of slower clips n. */
long track_frames_of(const struct track_clip *clip, long n);

/* Points of skin: rows of the mesh and where they are at the reference. */
struct track_points {
	int n;
	int32_t *vertex;
	double (*head)[3];     // mm
	struct skin_points points;
	uint8_t *mask;         // [height][width] 0 where the picture shows no skin
};

/* The first file of video/; false, err set, when there is none. */
bool track_video(char file[320], int *others, struct stage *stage, struct err *err);

/* file is set. */
bool track_clip_open(struct track_clip *clip, struct stage *stage, const struct track_subject *subject,
                     const struct track_conf *conf, struct err *err);
void track_clip_free(struct track_clip *clip);

/* Keeps another frame as the reference; where the head is in it is for track_look to find. False, err set or not, where there is none. */
bool track_clip_take(struct track_clip *clip, long frame, struct stage *stage, const struct track_conf *conf, struct err *err);

/* The head in the kept frame, one way up or as its eyes say. A failure leaves the pose as it was. */
enum track_way { WAY_EITHER, WAY_UP, WAY_OVER };
bool track_look(struct track_clip *clip, enum track_way way, const struct track_subject *subject, const struct track_conf *conf);

/* A frame of known pose, if open eyes are seen where they then are. */
bool track_look_known(struct track_clip *clip, long frame, const struct track_subject *subject, const struct track_conf *conf);

/* Improves the pose by the centres that the eyes turn about in the first frames. */
void track_settle(struct track_clip *clip, struct stage *stage, const struct track_subject *subject, const struct track_conf *conf);

bool track_points_choose(struct track_points *points, const struct track_clip *clip, const struct track_subject *subject,
                         const struct track_conf *conf, struct err *err);
void track_points_free(struct track_points *points);

#endif
