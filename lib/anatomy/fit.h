/* fit: the eye in one photograph as `limbus` found it, work/limbus/NAME.json: limbus, pupil, pose, camera. */
#ifndef ANATOMY_FIT_H
#define ANATOMY_FIT_H
#include "base/err.h"
#include "anatomy/eye.h"
#include "math/ellipse.h"

enum { FIT_SECTORS = 72 };

struct fit {
	bool ok;                    // status "ok" or "rough"
	double rough;               // status "rough": only known to this share of the semi-axis, in (0, 1); 0: to what was asked for
	char reason[256];           // why rejected, or rough
	struct ellipse limbus, pupil;
	bool has_pupil;
	double ellipse_sigma[5];    // standard deviations of cx, cy, a, b (px), angle (rad)
	double cam_from_eye[4][4];  // mm
	double theta, phi, theta_sigma;  // rad: angle between optical axis and direction to the camera; direction of tilt in the image
	double coverage, rms_px;    // share of the limbus seen, 0..1; residual
	double seen[FIT_SECTORS];   // share of the limbus visible in each sector about its centre, from +x towards +y; 1 where unknown
	double edge_sigma_px;       // width of the limbal step in the photograph
	struct camera camera;       // as used; CAMERA_NONE: weak perspective, a nominal camera 1000 mm away
	int width, height;          // of the photograph, px
	double limbus_aspect, limbus_aspect_sigma;
};

/* Loads a fit. Returns false, err set (path, key, rule), when the file cannot be used. */
bool fit_load(struct fit *fit, const char *path, struct err *err);

/* Writes a fit. made_by: stage_made_by(). extra: text of a JSON object with further keys, or null. Returns false, err set, when
 * it cannot be written. */
bool fit_save(const struct fit *fit, const char *path, const char *made_by, const char *extra, struct err *err);

/* Camera centre in the eye frame, mm. */
void fit_camera_in_eye(double center[3], const struct fit *fit);

/* Ray of a photo pixel in the eye frame: origin and unit direction. */
void fit_ray(double origin[3], double dir[3], const struct fit *fit, const double px[2]);

/* Photo pixel of a point in the eye frame (mm), without refraction. Returns false for a point behind the camera. */
bool fit_project(double px[2], const struct fit *fit, const double point_in_eye[3]);

#endif
