/* registered: how far our picture of a rendered capture's iris is from the independent renderer's.
 * Errors are px of the photograph. Captures with a painted, self-luminous or checkered iris: geometry alone.
 */
#ifndef TESTS_REGISTERED_H
#define TESTS_REGISTERED_H
#include "draw/eye/scene.h"
#include "tests/lib/truth/truth.h"

struct registered {
	int n;          // pixels, or patches
	double *px;     // distance of each; owned
	double mean[2]; // of the offset, px: what is common to all
};

/* By the map of iris points that comes with the capture: our reference path shows an iris whose colours are its coordinates (quick
 * pictures hold such colours back where the model is dark). False, err set, where the capture has no map. registered_free. */
bool registered_map(struct registered *out, const struct truth *truth, const char *dir, struct err *err);

/* By the photograph, with that enum scene_shading: patches of our picture of the capture's texture are found again in it, to a fraction of a pixel; those
 * whose pattern both show (correlation above 0.9). registered_free. */
bool registered_photo(struct registered *out, const struct truth *truth, const char *dir, int shading, struct err *err);
void registered_free(struct registered *of);

#endif
