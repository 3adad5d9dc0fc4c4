/* render: pictures of a fitted eye: work/render/. Paths are relative to the capture folder; pictures are linear Rec. 709.
 * Functions that return false set err.
 */
#ifndef RENDER_RENDER_H
#define RENDER_RENDER_H
#include "base/stage.h"
#include "anatomy/capture.h"
#include "draw/eye/render.h"
#include "draw/photo/photo.h"
#include "draw/studio.h"

struct render_conf {
	struct scene_conf scene;
	int lights, light_directions;    // beams that stand for an environment; directions in each
	int passes, samples;             // passes > 1: light drawn anew in each, and averaged; rays across a pixel at edges
	int size_px, photo_px;           // of front and three-quarter; longest side of the photograph's own view
	int frames, frame_px;            // turntable
	double frame_deg;                // it goes from -frame_deg to +frame_deg
	double field_mm;                 // what front and three-quarter show
	double three_quarter_deg[2];     // yaw, pitch
	const char *environment;         // latitude-longitude EXR in the capture folder, or null: a studio
	const char *light;               // the same of the photographs; null: estimated
	const char *shots;               // JSON in the capture folder: pictures asked for, or null
	bool freckles, exr, film, polarised;
	int sheet_px;                    // width of the contact sheet
	int page_px;                     // width of the page's pictures
	double page_glb_mib;             // largest character's .glb that the interactive page carries
	struct studio_finish finish;     // of the studio's pictures
	double socket_share;             // a fitted eye and a character's eyeball that differ by more are said to
	double limit_mpx;                // larger photographs are refused
};

/* One eye of the capture, and what its pictures are made from. */
struct job {
	struct stage *stage;
	const struct render_conf *conf;
	const struct eye *eye;
	const struct capture_eye *names;
	struct shot *shots;
	int n_shots, reference;          // the shot whose light and direction the colours are read in
	const char *in[10];              // inputs that all pictures have in common, relative to the folder
	int n_in;
	bool usable;                     // a photograph has a fit, and there is a texture
	bool ready;                      // what follows has been made (job_ready)
	struct scene scene;
	struct envmap studio;            // of the beauty views
	double gain;                     // of the beauty views' exposure
	double light_level;              // of the photographs' light in the scale of its file; 0: it was estimated
	double worst, worst_model;       // largest mean difference from a photograph, CIEDE2000: as shown, and of the fitted model alone
	struct scene_count count;
	double error;                    // of the last converging picture
	double seconds;                  // spent tracing
};

/* eye.c: makes the pictures of this eye that are not fresh; records as skipped what cannot be made. */
bool render_eye(struct job *job, struct err *err);

/* job.c: the eyes of a capture, with the photographs of each. One scene serves the pictures and the interactive page. jobs_close in any
 * case. */
struct jobs {
	int n;
	struct job *job;
};
bool jobs_open(struct jobs *jobs, struct stage *stage, const struct capture *capture, const struct eye *eye,
               const struct render_conf *conf, struct err *err);
void jobs_close(struct jobs *jobs);

/* job_ready: decodes the reference photograph and loads the scene, once. job_studio: the light of the beauty views alone. */
bool job_ready(struct job *job, struct err *err);
bool job_studio(struct job *job, struct err *err);

/* shot.c. shots_load: the photographs of an eye that have a fit, and the best of them as reference; shots_free.
 * shot_ready: decodes the photograph and estimates its light, once; shot_done: frees both. */
bool shots_load(struct job *job, const struct capture *capture, int eye_index, struct err *err);
bool shot_ready(struct job *job, struct shot *shot, struct err *err);
void shot_done(struct shot *shot);
void shots_free(struct job *job);

/* Pictures in the photograph's own colours: drawn with what the cornea mirrors over its white, and multiplied by that at last. envmap_free. */
struct envmap shot_mirrored(const struct envmap *mirror, const struct scene *scene);
void shot_colour(struct image *rgba, const struct scene *scene);

/* Rows of an environment's map: more than the pictures resolve. */
int env_height(const struct render_conf *conf);

/* asked.c: the pictures that render.shots asks for, RENDER/shot_NAME.exr. */
bool asked_pictures(struct job *job, struct err *err);

/* picture.c: writes at most PICTURES_MAX pictures from the same inputs, in parallel: 3 channels as PNG, 4 as EXR. */
enum { PICTURES_MAX = 4 };
struct picture_out {
	const char *rel;
	const struct image *image;
};
bool pictures_save(struct job *job, int n, const struct picture_out out[], int n_in, const char *const in[], struct err *err);

/* sheet.c. sheet_strip: pictures of one size side by side; image_free. sheet_contact: the contact sheet, from this eye's files. */
struct image sheet_strip(int n, const struct image frames[]);
bool sheet_contact(struct job *job, struct err *err);

/* turntable.c: the eye turned to and fro, as MP4. */
bool turntable_film(struct job *job, const char *rel, struct err *err);

/* turntable.c: an EXR of a picture in layers: diffuse (out of the eye) and specular (mirrored by the tear film), whose sum is the picture;
 * depth Z, mm; normal N in the camera's frame. diffuse: the picture rendered without a mirror. */
bool layers_save(struct job *job, const char *rel, const struct image *full, const struct image *diffuse, const struct scene_view *view,
                 struct err *err);

#endif
