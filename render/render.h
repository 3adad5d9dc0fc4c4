/* render: pictures of a fitted eye, and the page that shows everything (DESIGN section 2, `render`). */
#ifndef RENDER_RENDER_H
#define RENDER_RENDER_H
#include "base/stage.h"
#include "anatomy/capture.h"
#include "draw/eye/render.h"
#include "draw/photo/photo.h"

struct render_conf {
	struct scene_conf scene;
	int lights, light_directions, passes, samples;     // of the environment; light drawn anew; rays across a pixel where there are edges
	int size_px, photo_px;           // of front and three-quarter; longest side of the photograph's own view
	int frames, frame_px;            // turntable
	double frame_deg;                // it goes from -frame_deg to +frame_deg
	double field_mm;                 // what front and three-quarter show
	double three_quarter_deg[2];     // yaw, pitch
	const char *environment;         // latitude-longitude EXR in the capture folder, or null: a studio
	bool freckles, exr, film, polarised;
	int sheet_px;                    // width of the contact sheet
	int page_px;                     // width of the page's pictures
	double limit_mpx;
};

/* One eye of the capture, on its way to pictures. */
struct job {
	struct stage *stage;
	const struct render_conf *conf;
	const struct eye *eye;
	const struct capture_eye *names;
	struct shot *shots;
	int n_shots, reference;          // the shot whose light and direction the colours are read in
	const char *in[9];               // inputs that all pictures have in common, relative to the folder
	int n_in;
	bool usable;                     // there is enough to show
	bool ready;                      // what follows has been made
	struct scene scene;
	struct envmap studio;            // of the beauty views
	double gain;                     // of the beauty views' exposure
	double worst;                    // largest mean difference from a photograph, CIEDE2000
	struct scene_count count;
	double error;                    // of the last converging picture
	double seconds;                  // spent tracing
};

/* Makes whatever pictures of this eye are not fresh. */
bool render_eye(struct job *job, struct err *err);

/* The eyes of a capture: what photographs there are of each, and whether there is enough of it to show. One scene serves
 * the pictures and the interactive page. jobs_close in any case. */
struct jobs {
	int n;
	struct job *job;
};
bool jobs_open(struct jobs *jobs, struct stage *stage, const struct capture *capture, const struct eye *eye,
               const struct render_conf *conf, struct err *err);
void jobs_close(struct jobs *jobs);

/* job_ready: loads the scene, once. job_studio: the light of the beauty views alone. */
bool job_ready(struct job *job, struct err *err);
bool job_studio(struct job *job, struct err *err);

/* shot.c: the photographs of an eye that have a fit, and the best of them as reference. shots_free.
 * shot_ready: decodes the photograph and reads its light, once; shot_done: forgets both. */
bool shots_load(struct job *job, const struct capture *capture, int eye_index, struct err *err);
bool shot_ready(struct job *job, struct shot *shot, struct err *err);
void shot_done(struct shot *shot);
void shots_free(struct job *job);

/* Rows of an environment's map: sharper than the pictures need it. */
int env_height(const struct render_conf *conf);

/* At most PICTURES_MAX pictures at once, from the same inputs: 3 channels become a PNG, 4 an EXR. rel: in the folder. */
enum { PICTURES_MAX = 4 };
struct picture_out {
	const char *rel;
	const struct image *image;
};
bool pictures_save(struct job *job, int n, const struct picture_out out[], int n_in, const char *const in[], struct err *err);

/* sheet.c: pictures side by side; the contact sheet, from the files of this eye. image_free. */
struct image sheet_strip(int n, const struct image frames[]);
bool sheet_contact(struct job *job, struct err *err);

/* turntable.c: the eye turned to and fro, MP4. */
bool turntable_film(struct job *job, const char *rel, struct err *err);

/* EXR of a picture in layers: what comes out of the eye (diffuse) and what the film mirrors (specular), which add up to it;
 * depth Z, mm; normal N in the camera's frame. diffuse: the picture without a mirror. */
bool layers_save(struct job *job, const char *rel, const struct image *full, const struct image *diffuse, const struct scene_view *view,
                 struct err *err);

#endif
