/* keys: the configuration keys that several programs read. Each is declared here once, or in eye.h (`eye.*`): one name, one
 * type, one range, one unit, one meaning. Defaults stand in config/capture.conf. A program puts the rows that it reads into its
 * option table; tests/layers.sh holds that no such key is declared anywhere else.
 */
#ifndef ANATOMY_KEYS_H
#define ANATOMY_KEYS_H
#include "base/opt.h"
#include "optics/camera.h"

/* The lens and sensor as capture.conf states them; NAN where it does not. */
struct camera_keys {
	double focal_px;          // of the picture as stored
	double focal_mm;          // with sensor_mm
	double sensor_mm;         // longer side of the sensor, whichever way the camera was held
	double center_px[2];      // principal point; NAN: the middle of the picture
	double distortion[5];     // k1 k2 p1 p2 k3, OpenCV's order
};

/* Rows `camera.*`, into a struct camera_keys. */
#define CAMERA_FOCAL_OPTS(k) \
	OPT_REAL_UNSET("camera.focal_px", &(k)->focal_px, 10, 1e7, "px", "focal length; unset: of focal_mm and sensor_mm, else EXIF"), \
	OPT_REAL_UNSET("camera.focal_mm", &(k)->focal_mm, 0.5, 3000, "mm", "focal length, with camera.sensor_mm"), \
	OPT_REAL_UNSET("camera.sensor_mm", &(k)->sensor_mm, 1, 200, "mm", "longer side of the sensor")
#define CAMERA_LENS_OPTS(k) \
	OPT_REALS_UNSET("camera.center_px", (k)->center_px, 2, -1e6, 1e6, "px", "principal point; unset: the middle"), \
	OPT_REALS("camera.distortion", (k)->distortion, 5, -100, 100, "", "k1 k2 p1 p2 k3, OpenCV's order")

/* Row `light.polarised`, into a bool. */
#define LIGHT_POLARISED_OPT(polarised) OPT_BOOL("light.polarised", polarised, "no corneal reflection in the photographs")

/* Rows `subject.*`: into doubles (NAN: unset) and struct opt_each_list. */
#define SUBJECT_UNIT_OPT(unit_mm) OPT_REAL_UNSET("subject.unit_mm", unit_mm, 1e-6, 1e6, "mm", "one unit of the subject's mesh")
#define SUBJECT_LANDMARK_OPT(landmark) OPT_EACH("subject.landmark.*", landmark, 1, 0, 1e9, "", "row of the subject's mesh")
#define SUBJECT_EYE_OPTS(radius, center) \
	OPT_REAL_UNSET("subject.eye_radius", radius, 1e-6, 1e6, "unit", "of an eyeball, in the mesh's unit"), \
	OPT_EACH("subject.eye_center.*", center, 3, -1e6, 1e6, "unit", "centre of an eyeball, in the mesh's unit and axes")

/* Row `expression.NAME`, into a struct opt_each_list of two frames each. */
#define EXPRESSION_OPT(expressions) OPT_EACH("expression.*", expressions, 2, 0, 1e7, "", "neutral and peak frame of an expression")

/* Row `limit.photo_mpx`, into a double. Those of videos stand in image/video/video.h. */
#define LIMIT_PHOTO_OPT(mpx) OPT_REAL("limit.photo_mpx", mpx, 0.01, 1000, "Mpx", "larger photographs are refused")

/* Focal length in px of a picture of width x height px: focal_px as it stands, else focal_mm over the longer side of the
 * sensor, which the longer side of the picture spans. NAN where the keys do not tell. */
double camera_keys_focal(const struct camera_keys *keys, int width, int height);

/* Checks that focal_px, where it is given beside focal_mm and sensor_mm, is what they make of it, to 5 %: it may have been meant for the
 * picture before it was cut or made smaller. False, err set (both keys), where it is not. */
bool camera_keys_agree(const struct camera_keys *keys, int width, int height, struct err *err);

/* Checks that an eye whose limbus of limbus_mm is radius_px wide in the picture stands before the camera where one can be photographed:
 * 10 mm to 100 m. False, err set (the keys that put it elsewhere). */
bool camera_keys_place(double focal_px, double limbus_mm, double radius_px, struct err *err);

/* Checks that a camera's numbers can be those of a picture of width x height px: the principal point lies within one picture's size of
 * the picture, and the distortion does not fold it (the radius in the picture grows with the angle to the axis out to the
 * farthest corner; tangential terms are not looked at).
 * False, err set (key, value, rule), where they cannot; err may blame two keys together. */
bool camera_keys_check(const struct camera *camera, int width, int height, struct err *err);

/* Checks that every key of capture.conf or the command line that names a photograph (`photo.NAME.*`), a view (`view.NAME.*`) or
 * a character (`target.NAME.*`) names a file of the capture folder: its name without the ending, of a frame of a video
 * with its number ("clip_120").
 * False, err set (file, line, key, the names that there are), where one does not, or where a folder cannot be read. */
bool keys_check_names(const struct conf *conf, const char *capture, struct err *err);

#endif
