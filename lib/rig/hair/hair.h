/* hair: lashes and brows that grow from a character's skin, as curved, tapered, clumped hairs, and move with it.
 *
 * Lashes are rooted on the outer edge of the lids' margins, which is found at rest: along the skin from where the front sees the eyeball end, where
 * it turns to the front, at least a margin's breadth away. Brows lie along the ridge above the sockets. A hair is a chain of points in the frame of its root: off the eyeball,
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
	double brow_rgb[3];    // albedo of the brows' hairs; 0: that of lashes
	struct hair_rim *rim;  // [n_rims] from corner to corner, at most HAIR_RIMS of the left eye, then of the right
};

/* What a film shows of a person's lashes and brows. Fronts are mm of an eyeball of 12 mm about an eyeball's centre, x outward, y up; of an eye
 * (0 left, 1 right) cell [j][i] of a brow is at x = HAIR_FROM_X + HAIR_CELL i, y = HAIR_FROM_Y + HAIR_CELL j. */
enum { HAIR_CELLS_X = 130, HAIR_CELLS_Y = 100 };
#define HAIR_CELL 0.4
#define HAIR_FROM_X (-22)
#define HAIR_FROM_Y 3
struct hair_film {
	struct hair_lid {
		double area, reach;    // of its lashes as the front sees them: mm2 on a mm of its margin; mean distance from that, mm. 0: not known
	} lid[2];                  // enum hair_kind: upper, lower
	double rgb[3];             // albedo where brows are thickest; 0: not known
	bool brow[2];              // whether the skin of that brow was seen
	float cover[2][HAIR_CELLS_Y][HAIR_CELLS_X];  // share of the skin that its hairs hide
	float way[2][HAIR_CELLS_Y][HAIR_CELLS_X];    // where they grow to, radians from outward towards up
	double eye[2][3], radius;  // the person's eyeballs: mm, x to the left, y up, z out of the face
};

/* The cell that a place of the person (film->eye's axes, x and y) lies in for an eye, row by row; -1: none. */
int hair_cell(const struct hair_film *film, int side, const double at[2]);

/* Where an average brow's hairs grow to at x of an eye's front, radians from outward towards up. */
double hair_brow_way(double x);

struct hair_conf {
	double lash_mm, brow_mm;   // the longest, on an eyeball of 12 mm; 0: none
	int lashes, brow_hairs;    // of one upper lid (the lower has three fifths); of one brow
	double margin_mm;          // breadth of a lid's margin, on an eyeball of 12 mm
	// Null, or lashes and brows become those that the film shows, where it does, the numbers above being the average adult's:
	const struct hair_film *film;
	const float (*place)[3];   // [own vertices] where the character's lie on the person, as film->eye; null where film is
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

/* Albedo of a hair where that of lashes is lash_rgb. */
static inline const double *hair_albedo(const struct hairs *hairs, const struct hair *hair, const double lash_rgb[3])
{
	return hair->kind == HAIR_BROW && hairs->brow_rgb[1] > 0 ? hairs->brow_rgb : lash_rgb;
}

/* Half its breadth at point k, mm. */
static inline float hair_half(const struct hair *hair, int k)
{
	return hair->half * (1 - 0.85f * (float)k / (float)(hair->n - 1));
}

#endif
