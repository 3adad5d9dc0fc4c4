/* views_truth: photographs with known projection matrices, and how far cameras found without them are off. */
#ifndef TESTS_VIEWS_TRUTH_H
#define TESTS_VIEWS_TRUTH_H
#include "optics/camera_rig.h"

struct views_camera {
	char name[64];                // of the photograph, without ending
	double K[3][3], R[3][3], center[3];  // p_px ~ K R (p_world - center); px: first pixel's centre at 0
};

struct views_truth {
	struct views_camera *c;       // owned
	int n;
	double extent;                // largest side of the box round the centres
};

/* dir/P/NAME_P.txt: three rows of four numbers. False, err set, when there is none. */
bool views_truth_load(struct views_truth *truth, const char *dir, struct err *err);
/* dir/NAME.jpg.camera, as Strecha et al. (2008) publish theirs: K; lens; the camera's axes as columns; its centre; the size. */
bool views_truth_load_cameras(struct views_truth *truth, const char *dir, struct err *err);
void views_truth_free(struct views_truth *truth);

/* p_truth = scale R p_head + t, least squares over the cameras both have (Umeyama 1991). */
struct views_fit {
	double scale, R[3][3], t[3];
	double mean, worst;           // distance of the centres, truth's unit
	int n;
};
bool views_fit(struct views_fit *fit, const struct views_truth *truth, const struct camera_rig *rig);

void views_to_truth(double out[3], const struct views_fit *fit, const double head[3]);

#endif
