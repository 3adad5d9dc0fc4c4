/* truth: a rendered capture with its truth (shared data, or samples/demo), for tests and benchmarks.
 * Lengths mm, pixel centres at (0.5, 0.5).
 */
#ifndef TESTS_TRUTH_H
#define TESTS_TRUTH_H
#include "anatomy/eye.h"
#include "anatomy/fit.h"

struct truth {
	char name[64], photo[1024];       // path of the photograph
	struct eye eye;                   // anatomy as rendered; limbus_aspect 1
	double iris_radius, pupil_radius; // mm
	double focal_px, center_px[2];
	double cam_from_eye[4][4];        // in the product's frame (lib/README.md): x and y are the camera's, carried by the smallest rotation
	double turn;                      // radians about z: p_product = Rz(turn) p_truth
	double theta, phi;                // radians
	double covered;                   // share of the limbus behind lids and lashes
	struct ellipse limbus, pupil;     // exact projection; the pupil's seen through the cornea
};

/* dir: a folder with truth.json. False, err set, when it is missing or incomplete. */
bool truth_load(struct truth *truth, const char *dir, struct err *err);

/* The names of all capture folders with truth under ../shared/data/eyes (or $EYEWRIGHT_DATA/eyes); 0 when the data
 * is not there. Paths into `dirs`, at most `max`; free() each. */
int truth_captures(char *dirs[], int max);

/* A fit as a perfect `limbus` would write it. */
struct fit truth_fit(const struct truth *truth);

/* Turns a point of the truth's eye frame into the product's. */
void truth_turn(double out[2], const struct truth *truth, const double in[2]);

/* Makes a capture folder at `dest` (must not exist): the photograph, and a capture.conf with camera and anatomy as
 * rendered, then `extra` (may be null). */
bool truth_make_capture(const struct truth *truth, const char *dest, const char *extra, struct err *err);

#endif
