/* deform_cards: hair cards, lashes and brows that came with a character stand on its skin: each turns as a whole with the skin below its roots. Posed vertex by
 * vertex, as skin is, a card that stands on a lid is left behind by what it stands on, and its length changes in a blink. */
#ifndef RIG_DEFORM_CARDS_H
#define RIG_DEFORM_CARDS_H
#include "rig/rig.h"

/* A place where a card meets the skin: the skin's vertices about it, and their weights, from which its place and rotation are. */
enum { DEFORM_PATCH = 32, DEFORM_ROOTS = 4 };
struct deform_root {
	int n, vertex[DEFORM_PATCH];
	float weight[DEFORM_PATCH];   // of the rotation
	float foot[DEFORM_PATCH];     // of the place: sum 1
	double at[3];                 // at rest, mm
};

/* A vertex of a card: it goes with its roots. */
struct deform_carried {
	int vertex, n, root[DEFORM_ROOTS];
	float weight[DEFORM_ROOTS];   // sum 1
};

/* Owned; deform_cards_free. */
struct deform_cards {
	int n, n_roots;
	struct deform_carried *carried;
	struct deform_root *root;
};

/* Finds them: pieces of the mesh near the eyes that touch the skin and stand off it, and whose vertices move. */
struct deform_cards deform_cards_of(const struct rig *rig, const bool *moves);
void deform_cards_free(struct deform_cards *cards);

#endif
