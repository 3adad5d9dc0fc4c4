/* around: what lies round a person and is mirrored in the cornea: open country with sky and skyline, rooms with windows and what is seen through them, who takes the
 * photograph, and the lashes and the lid above. For the lessons on what covers an iris; other pictures have the room of light.h.
 * Directions are unit vectors in the frame of light.h.
 */
#ifndef EVIDENCE_AROUND_H
#define EVIDENCE_AROUND_H
#include "field.h"
#include "math/rng.h"

enum { PANES_MAX = 5 };

/* A window: its axes as those of a source; bars across and upright; the skyline seen in it (-1 its lower edge, 1 its upper); how much curtains leave, from where on. */
struct pane {
	float dir[3], side[3], up[3], half[2];
	int bars[2];
	float bar_wide, skyline, curtain_at, curtain, radiance[3], below;
};

struct around {
	bool on, open;
	float sky[3], ground[3], walls[3];  // mirrored radiance
	float skyline, rough, cloud, houses;
	const struct field *outline, *clutter;
	float at[2], scale;
	int n;
	struct pane pane[PANES_MAX];
	float person[4], person_dark;       // middle, half width of the head, height of its chin; what it lets through
	float lid, lid_dark;                // elevation from which the lid is mirrored, as y of a direction; what is left there
	float lash_gap, lash_long, lash_wide, lash_lean, lash_dark;
	uint32_t seed;
};

struct around around_make(struct rng *rng, bool test);

/* Radiance from d. */
void around_mirrored(float out[3], const struct around *around, const float d[3]);

/* Share of what is mirrored from d that lid, lashes and a person before it let through. */
float around_through(const struct around *around, const float d[3]);

#endif
