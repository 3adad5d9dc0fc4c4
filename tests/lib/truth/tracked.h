/* tracked: a rendered clip's truth in the shape in which `track` leaves a clip, for tests of train and later stages. Lids and skin
 * in the modelling camera (head fixed), which is the clip's own camera at its first frame.
 */
#ifndef TESTS_TRACKED_H
#define TESTS_TRACKED_H
#include "model/train/train.h"

enum { TRACKED_POINTS = 20, TRACKED_AU = 2, TRACKED_INPUTS = SKIN_EYE_INPUTS + TRACKED_AU };

struct tracked {
	long n;
	int n_vertices;
	double *time, *g, *confidence;  // as in struct train_clip
	double *lid, *skin, *seen;      // [n][SKIN_LIDS][TRACKED_POINTS][2], [n][n_vertices][2], [n][n_vertices]
	int *vertices;
	struct skin_camera camera;
};

/* dir: a clip's folder. noise: of tracking, 1 as a good tracker has it (skin 0.3 px, lids 0.6 px, gaze 0.3 degrees); 0 the
 * truth itself. Gaze is missing behind closed lids; the second action unit is the squint. */
bool tracked_load(struct tracked *tracked, const char *dir, double noise, struct err *err);
void tracked_free(struct tracked *tracked);

/* As train takes it; refers to tracked. */
struct train_clip tracked_clip(const struct tracked *tracked);

/* The files of work/skin/ in `dir`, as track writes them. */
bool tracked_save(const struct tracked *tracked, const char *dir, struct err *err);

#endif
