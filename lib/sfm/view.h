/* view: one picture for COLMAP: a photograph of views/ or photos/, or a frame of a video, upright and reduced.
 */
#ifndef SFM_VIEW_H
#define SFM_VIEW_H
#include <stdint.h>

#include "base/err.h"
#include "sfm/options.h"

enum { THUMB = 16 };

/* A photograph of views/ or photos/, or a frame of video/. */
struct view {
	char *file;               // "views/a.jpg"; owned
	long frame;               // of a video; -1: a photograph
	char picture[40];         // its name below work/calibrate/pictures
	int width, height;        // of the photograph, upright, px
	int picture_width, picture_height;
	double focal_px;          // of the photograph; NAN: unknown
	char maker[64];           // EXIF's camera model; of a frame the video's file; or ""
	double sharpness;         // mean squared Laplacian of the picture at a fixed size, grey levels squared
	uint8_t thumb[THUMB * THUMB];
	int camera;               // index into the cameras
	char reason[256];         // why it is left out; "": it is in use
	bool spare;               // left out because others show enough, not for a fault of its own
	uint32_t id;              // image_id of the database
	bool is_new;              // no model has been made with it yet
};

/* The name by which capture.conf's keys name it: the file without folder and ending; of a frame with its number: "clip_120".
 * free(). */
char *view_name(const struct view *view);

/* True when capture.conf's NAME names this view. */
bool view_is_named(const struct view *view, const char *name);

/* Of 8-bit pixels [height][width][channels], 1 or 3 channels. view_thumb: grey, reduced to THUMB x THUMB. view_sharpness: the
 * mean squared Laplacian at a fixed size, grey levels squared; it falls with blur (Pech-Pacheco et al. 2000 use its variance). */
void view_thumb(uint8_t thumb[THUMB * THUMB], const uint8_t *px, int width, int height, int channels);
double view_sharpness(const uint8_t *px, int width, int height, int channels);

/* Mean absolute difference of two thumbs, grey levels. */
double view_difference(const uint8_t *thumb, const uint8_t *other);

/* Reduces px (8 bits, [view->height][view->width][channels]) to at most picture_px, writes it to `path` as JPEG, and fills
 * picture_width, picture_height, sharpness and thumb. Returns false, err set, when the file cannot be written. */
bool view_picture(struct view *view, const char *path, const uint8_t *px, int channels, int picture_px, struct err *err);

/* The focal length of the photograph, px, as far as capture.conf, EXIF or the table of sensors give it; else NAN. */
double view_focal_known(const struct view *view, const struct calibrate_options *o);

#endif
