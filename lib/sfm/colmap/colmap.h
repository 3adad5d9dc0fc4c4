/* colmap: COLMAP's model files in memory, reading and writing them.
 * Frame  a camera looks along +z, x right, y down; cam_from_world = rotation(q), then t; lengths in the model's own unit.
 * Image  px, x right, y down, centre of the first pixel at (0.5, 0.5).
 * Files  cameras, images and points3D, each .bin or .txt, as the program writes them (version 3.8).
 * Files are untrusted: counts are checked against the bytes behind them, every number has a range, every observation
 * has to name a point that names it back.
 */
#ifndef SFM_COLMAP_COLMAP_H
#define SFM_COLMAP_COLMAP_H
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "optics/camera.h"

enum colmap_kind {
	COLMAP_SIMPLE_PINHOLE, COLMAP_PINHOLE, COLMAP_SIMPLE_RADIAL, COLMAP_RADIAL, COLMAP_OPENCV, COLMAP_OPENCV_FISHEYE,
	COLMAP_FULL_OPENCV, COLMAP_FOV, COLMAP_SIMPLE_RADIAL_FISHEYE, COLMAP_RADIAL_FISHEYE, COLMAP_THIN_PRISM_FISHEYE,
	COLMAP_KINDS
};
enum { COLMAP_PARAMS = 12 };

struct colmap_camera {
	uint32_t id;
	enum colmap_kind kind;
	int width, height;             // px
	double params[COLMAP_PARAMS];  // in the order of the program's camera model
};

struct colmap_seen {
	double px[2];
	int point;  // index into points; -1: of none
};

struct colmap_image {
	uint32_t id;
	char *name;        // owned
	int camera;        // index into cameras
	double q[4], t[3]; // cam_from_world: quaternion w x y z of length 1; translation
	struct colmap_seen *seen;
	int n_seen;
};

struct colmap_track {
	int image, seen;  // indices into images, and into that image's seen
};

struct colmap_point {
	uint64_t id;
	double xyz[3];
	uint8_t rgb[3];
	double error;  // mean distance of its observations from its projections, px; negative: never computed
	struct colmap_track *track;
	int n_track;
};

struct colmap_model {
	struct colmap_camera *cameras;
	struct colmap_image *images;
	struct colmap_point *points;
	int n_cameras, n_images, n_points;
};

enum colmap_format { COLMAP_BINARY, COLMAP_TEXT };

/* Reads the model of a folder: binary where it holds cameras.bin, else text; and checks its seal where there is one. Cameras, images
 * and points come sorted by their ids. Returns false, err set ("path: rule broken"), model empty, when a rule is broken. colmap_free. */
bool colmap_load(struct colmap_model *model, const char *dir, struct err *err);

/* The same from bytes: data[3] and size[3] of cameras, images, points3D; `where` names them in errors. */
bool colmap_parse(struct colmap_model *model, enum colmap_format format, const char *const data[3], const size_t size[3],
                  const char *const where[3], struct err *err);

/* Writes the three files, the folder made. Returns false, err set, when one cannot be written. */
bool colmap_save(const struct colmap_model *model, const char *dir, enum colmap_format format, struct err *err);
void colmap_free(struct colmap_model *model);

/* Seals a folder: writes hashes of its three files beside them, which colmap_load checks from then on. */
bool colmap_seal(const char *dir, struct err *err);

/* COLMAP's name of a camera model, and how many parameters it has. */
const char *colmap_kind_name(enum colmap_kind kind);
int colmap_kind_params(enum colmap_kind kind);

/* The camera as a pinhole with OpenCV's distortion. focal: out, fx and fy, px; out->focal_px is their geometric mean. Returns false,
 * err set, for a camera model that this cannot express. */
bool colmap_to_camera(struct camera *out, double focal[2], const struct colmap_camera *camera, struct err *err);

/* The rotation matrix of a unit quaternion w x y z. */
void colmap_rotation(double R[3][3], const double q[4]);

/* World coordinates of an image's camera centre. */
void colmap_center(double center[3], const struct colmap_image *image);

/* Mean distance between observations and projections, px: of image i (NAN where it sees no point), or of all
 * with i = -1. A model whose lens colmap_to_camera refuses gives NAN. */
double colmap_residual(const struct colmap_model *model, int i);

/* Compares each point's stored error with its mean reprojection error. Returns false, err set, where they differ: files of two models
 * are mixed, or bytes have changed. Points without a stored error are not compared. where: names the model in errors. */
bool colmap_check_errors(const struct colmap_model *model, const char *where, struct err *err);

#endif
