/* calibrate: cameras and the person's mesh from overlapping photographs, through the COLMAP program.
 * What is kept between runs stands in work/calibrate/: pictures/ (what COLMAP looks at), pictures.json, faces.json,
 * database.db, model/ (sealed), colmap.log. A photograph added is compared with the others, nothing else is done again.
 */
#ifndef SFM_CALIBRATE_H
#define SFM_CALIBRATE_H
#include "anatomy/eye.h"
#include "anatomy/keys.h"
#include "base/stage.h"
#include "image/video/video.h"
#include "sfm/colmap/colmap.h"
#include "sfm/cloud/cloud.h"
#include "sfm/match/match.h"
#include "register/transfer.h"

#define CALIBRATE_DIR "work/calibrate"

struct calibrate_options {
	struct video_conf video;
	int video_frames, video_frames_beside;
	int picture_px, features, first_octave, max_views, min_matches, lens;
	double same_level, blur_warning, limit_mpx, regrow;
	struct sfm_overlap_conf overlap;
	int sequence_neighbours;
	double filter_px, tri_deg;
	int ba_rounds;
	struct camera_keys camera;
	double head_radius_mm, eyes_apart_mm, ruler_mm, marker_mm, limbus_radius_mm;
	bool find_eyes;
	struct opt_each_list left_eye, right_eye, mouth, ruler, distance;
	struct cloud_conf cloud;
	double best_angle_deg, max_slant_deg;
	int mesh_depth, mesh_faces, mesh_min_points;
	double mesh_trim;
	const char *template;         // relative to the capture; null: none
	double template_cells;
	struct transfer_conf transfer;
};

enum { THUMB = 16 };

/* A photograph of views/ or photos/, or a frame of video/. */
struct view {
	char *file;               // "views/a.jpg"; owned
	long frame;               // of a video; -1: a photograph
	char picture[40];         // its name below work/calibrate/pictures
	int width, height;        // of the photograph, upright, px
	int picture_width, picture_height;
	double focal_px;          // of the photograph; NAN: unknown
	char maker[64];           // EXIF's camera model, or ""
	double sharpness;         // mean squared Laplacian of the picture at a fixed size, grey levels squared
	uint8_t thumb[THUMB * THUMB];
	int camera;               // index into the cameras
	char reason[256];         // why it is left out; "": it is not
	uint32_t id;              // image_id of the database
	bool is_new;              // not there when the stage ran last
};

struct views {
	struct view *v;
	int n;                    // those not left out come first
	int n_used;
	struct colmap_camera *cameras;  // of the pictures
	bool *has_focal;
	int n_cameras;
};

/* Photographs of views/ and photos/ and frames of video/ as pictures for COLMAP: upright, at most picture_px long; near-duplicates and what
 * cannot be decoded left out with a reason. views_free. */
bool views_gather(struct views *views, struct stage *stage, const struct calibrate_options *o, struct err *err);
void views_free(struct views *views);

/* What capture.conf calls it: the file without folder and ending, of a frame with its number: "clip_120". free(). */
char *view_name(const struct view *view);

/* True where nothing of views/ is in use: frames of a video have to do. */
bool views_are_video(const struct views *views);

/* Of 8-bit pixels [height][width][channels]. */
void view_thumb(uint8_t thumb[THUMB * THUMB], const uint8_t *px, int width, int height, int channels);
double view_sharpness(const uint8_t *px, int width, int height, int channels);
double view_difference(const uint8_t *thumb, const uint8_t *other);  // mean, grey levels

/* Writes the picture of a view of that size, at most picture_px long, and fills what is known from its pixels. */
bool view_picture(struct view *view, const char *path, const uint8_t *px, int channels, int picture_px, struct err *err);

/* The camera of a picture before anything is known but EXIF, capture.conf and the table of sensors. */
double view_focal_known(const struct view *view, const struct calibrate_options *o);

/* Runs `colmap TASK --key value ...`; its output goes to work/calibrate/colmap.log, its progress is shown as `what`.
 * args: null-terminated. */
bool colmap_run(struct stage *stage, const char *task, const char *const args[], int total, const char *what,
                struct err *err);

/* The same in work/calibrate as its current folder, to which paths among the arguments are relative: for tasks that keep files
 * of their own in the current folder, which need not be one to be written to. */
bool colmap_run_inside(struct stage *stage, const char *task, const char *const args[], const char *what, struct err *err);

/* Several at a time, as many as the stage has threads. */
bool colmap_run_parts(struct stage *stage, const char *task, int n, const char *const *const args[], const char *what,
                      struct err *err);

/* Database and features. *grows: all that was there is as it was, only pictures were added. Sorts the views by id. */
bool features_make(bool *grows, struct views *views, struct stage *stage, const struct calibrate_options *o,
                   struct err *err);

/* Chooses pairs, compares and checks them. */
bool pairs_match(struct views *views, struct stage *stage, const struct calibrate_options *o, struct err *err);

/* Cameras and points: work/calibrate/model, sealed; in colmap's own frame and unit, pixels of the pictures. */
bool model_make(struct colmap_model *model, const struct views *views, bool grows, struct stage *stage,
                const struct calibrate_options *o, struct err *err);

#endif
