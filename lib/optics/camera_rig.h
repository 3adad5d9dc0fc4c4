/* camera_rig: the cameras that `calibrate` found, work/rig.json. A stage that reads pictures takes its cameras from there:
 *
 *     struct camera_rig rig = { 0 };
 *     if (file_exists(path) && !camera_rig_load(&rig, path, err))       path: stage_path(stage, "work/rig.json"), an input
 *             return false;
 *     const struct rig_camera *c = camera_rig_find(&rig, "photos/left_a.jpg");
 *     if (c)                                                     null: not registered, or no rig at all
 *             camera = c->camera;                                source CAMERA_RIG, distortion included
 *     camera_rig_free(&rig);
 *
 * Lens distortion is in camera->distortion alone: camera_project applies it, camera_ray removes it.
 * Frame  head: the subject mesh's axes, x to the person's left, y up, z out of the face; mm.
 * Image  the picture's own size, upright (after its EXIF orientation), first pixel's centre at (0.5, 0.5).
 */
#ifndef OPTICS_CAMERA_RIG_H
#define OPTICS_CAMERA_RIG_H
#include "base/err.h"
#include "optics/camera.h"

struct rig_camera {
	char *name, *file;           // "left_a", "photos/left_a.jpg"; owned
	long frame;                  // of a video; -1: a photograph, or all of a video
	int width, height;           // px
	struct camera camera;        // focal_px: the geometric mean where fx and fy differ
	double focal[2];             // fx, fy, px
	bool has_pose;               // false: only the lens is known
	double cam_from_head[4][4];  // mm
	double residual_px;          // mean reprojection error; NAN where nothing was measured
	int points;                  // that it was measured on
};

struct camera_rig {
	struct rig_camera *cameras;  // owned
	int n;
	double scale_sigma;    // relative standard deviation of all lengths; NAN: the scale is an assumption
	char scale_source[32]; // "ruler", "marker", "distance", "limbus", "eyes" (how far they lie apart), "assumed"
	char frame_source[32]; // "eyes and mouth", "eyes", "cameras"
	bool has_eyes;
	double eye_center[2][3];  // of the left and the right eyeball, head, mm
};

/* Loads a rig. camera_rig_free. Returns false, err set and rig empty, when the file cannot be used. */
bool camera_rig_load(struct camera_rig *rig, const char *path, struct err *err);

/* Writes a rig. made_by: stage_made_by(). extra: text of a JSON object with further keys, or null. Returns false, err set, when it
 * cannot be written. */
bool camera_rig_save(const struct camera_rig *rig, const char *path, const char *made_by, const char *extra, struct err *err);

/* Finds the camera of a picture by its path in the capture ("views/a.jpg"). Of a video, whose frames share one camera but each
 * have a pose, the first frame's. Returns null when there is none; owned by the rig. */
const struct rig_camera *camera_rig_find(const struct camera_rig *rig, const char *file);

void camera_rig_free(struct camera_rig *rig);

#endif
