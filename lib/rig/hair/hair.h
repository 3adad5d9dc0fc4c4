/* hair: lashes and brows that grow from a character's skin, as curved, tapered, clumped hairs, and move with it.
 *
 * Lashes are rooted on the outer edge of the lids' margins, which is found at rest: a margin's breadth along the skin from where the front
 * sees the eyeball end. Brows lie along the ridge above the sockets. A hair is a chain of points in the frame of its root: off the eyeball,
 * along the lid outward, up over it; so it turns with the lid as that goes over the globe.
 */
#ifndef RIG_HAIR_HAIR_H
#define RIG_HAIR_HAIR_H
#include "rig/rig.h"

enum hair_kind { HAIR_UPPER, HAIR_LOWER, HAIR_BROW };
enum { HAIR_LASH_POINTS = 6, HAIR_BROW_POINTS = 4 };

struct hair {
	int vertex[3], side;   // the root: weighted mean of three of the rig's vertices; 0 left eye, 1 right
	float weight[3];
	int kind, first, n;    // enum hair_kind; its points
	float half;            // mm: half its breadth at the root, which tapers
};

/* A column of an eye's opening at rest: where its lids touch the eyeball, the lower [0] and the upper one [1]. There tears stand. */
enum { HAIR_RIMS = 64 };
struct hair_rim {
	int vertex[2][3], side;
	float weight[2][3], along;  // as of roots; 0 one corner of the eye, 1 the other
};

/* Owned; hairs_free. */
struct hairs {
	int n, n_points, n_rims;
	struct hair *hair;     // all lashes before all brows
	float (*local)[3];     // [n_points] mm
	struct hair_rim *rim;  // [n_rims] from corner to corner, at most HAIR_RIMS of the left eye, then of the right
};

struct hair_conf {
	double lash_mm, brow_mm;   // the longest, on an eyeball of 12 mm; 0: none
	int lashes, brow_hairs;    // of one upper lid (the lower has three fifths); of one brow
	double margin_mm;          // breadth of a lid's margin, on an eyeball of 12 mm
};

/* shown: [rig.n_faces] whether a face of skin has hairs on it; null: all. Lids that are shut at rest get no lashes. */
void hairs_grow(struct hairs *hairs, const struct rig *rig, const bool *shown, const struct hair_conf *conf);
void hairs_free(struct hairs *hairs);

/* Root of a hair and its frame, unit and orthogonal, in a pose x[rig.n] of the rig. */
struct hair_frame {
	float root[3], off[3], along[3], up[3];
};
struct hair_frame hair_frame_of(const struct hair *hair, const struct rig *rig, const float (*x)[3]);

/* Its points there: out[hair.n][3]. */
void hair_place(float (*out)[3], const struct hairs *hairs, const struct hair *hair, const struct rig *rig, const float (*x)[3]);

/* Half its breadth at point k, mm. */
static inline float hair_half(const struct hair *hair, int k)
{
	return hair->half * (1 - 0.85f * (float)k / (float)(hair->n - 1));
}

#endif
