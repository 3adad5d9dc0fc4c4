/* views_capture: makes a capture of photographs with known cameras, runs calibrate on it, and compares the result. */
#ifndef TESTS_VIEWS_CAPTURE_H
#define TESTS_VIEWS_CAPTURE_H
#include "tests/lib/spent.h"
#include "tests/peers/sweep.h"
#include "tests/lib/truth/views_truth.h"

/* Photographs of the folder `images` into dir/views, beside those that are there: those named (null-terminated; null: all) but
 * for leave_out (null: none). conf: text of its capture.conf. */
bool views_capture(const char *dir, const char *images, const char *const names[], const char *leave_out, const char *conf,
                   struct err *err);

/* bin/calibrate on that capture; what it says in dir.log. */
bool views_calibrate(struct spent *spent, const char *dir, struct err *err);

/* Mean reprojection error, px, every observation alike. */
double views_residual(const struct camera_rig *rig);

/* Of a mesh's vertices beside the surface: the share within 1 % of the head's height of it, and the median distance over that
 * height. */
bool views_mesh_within(double *share, double *middle, const char *path, const struct views_fit *fit,
                       const struct sweep_points *surface, struct err *err);

#endif
