/* fit: what `limbus` found in one photograph: work/limbus/NAME.json. */
#ifndef ANATOMY_FIT_H
#define ANATOMY_FIT_H
#include "base/err.h"
#include "anatomy/eye.h"
#include "math/ellipse.h"

enum { FIT_SECTORS = 72 };

struct fit {
	bool ok;                    // status "ok"
	char reason[256];           // why not
	struct ellipse limbus, pupil;
	bool has_pupil;
	double ellipse_sigma[5];    // 1 sigma of cx, cy, a, b, angle
	double cam_from_eye[4][4];  // mm
	double theta, phi, theta_sigma;
	double coverage, rms_px;
	double seen[FIT_SECTORS];   // share of the limbus in sight, in sectors about its centre from +x towards +y; 1 unknown
	double edge_sigma_px;       // width of the limbal step in the photograph
	struct camera camera;       // as used; CAMERA_NONE: weak perspective, a nominal camera 1000 mm away
	int width, height;          // of the photograph, px
	double limbus_aspect, limbus_aspect_sigma;
};

bool fit_load(struct fit *fit, const char *path, struct err *err);

/* made_by: stage_made_by(). extra: JSON object text of further keys, or null. */
bool fit_save(const struct fit *fit, const char *path, const char *made_by, const char *extra, struct err *err);

/* Camera centre in the eye frame, mm. */
void fit_camera_in_eye(double center[3], const struct fit *fit);

/* Ray of a photo pixel in the eye frame: origin and unit direction. */
void fit_ray(double origin[3], double dir[3], const struct fit *fit, const double px[2]);

/* Photo pixel of a point in the eye frame, no refraction. False behind the camera. */
bool fit_project(double px[2], const struct fit *fit, const double point_in_eye[3]);

#endif
