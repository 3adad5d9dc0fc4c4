/* pair: registration pairs with known truth (data/registration), and how far a registration is from it. */
#ifndef TESTS_PAIR_H
#define TESTS_PAIR_H
#include <stdbool.h>

#include "base/err.h"
#include "mesh/mesh.h"

struct pair {
	const char *name;
	struct mesh source, target, clean;  // clean: the target's surface without noise, strays and holes
	float (*truth)[3];                  // [source.n_vertices]
	bool *covered;                      // [source.n_vertices] its true place lies on the target
	double diag;                        // of the bounding box, as the pair gives it: unit of the errors
};

struct pair_error {
	double surface, surface_95;  // of all vertices from the clean target, per cent of diag: mean and 95 %
	double truth, truth_95;      // of covered vertices from their true places
	int flipped;                 // triangles whose normal turned by more than 90 degrees
};

/* False, err set, when the data is not there. pair_free. */
bool pair_load(struct pair *pair, const char *name, struct err *err);
void pair_free(struct pair *pair);

/* place: [source.n_vertices] where they were registered to. */
struct pair_error pair_measure(const struct pair *pair, const float (*place)[3]);

#endif
