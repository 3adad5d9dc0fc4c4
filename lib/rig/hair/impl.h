/* hair_impl: a character at rest as its front sees it, and the hairs that are set there. */
#ifndef RIG_HAIR_IMPL_H
#define RIG_HAIR_IMPL_H
#include "math/rng.h"
#include "mesh/ray.h"
#include "rig/hair/hair.h"

/* One eye's surroundings: x outward (to the temple), y up, z out of the face, about the eyeball's centre; unit: mm of an eyeball of 12 mm. */
struct front {
	const struct rig *rig;
	const struct ray_scene *skin;
	const int *face;   // of the scene: the rig's
	int side;
	double scale;      // mm of the rig's in a unit
};

/* What is seen of the skin at (x, y). */
struct front_hit {
	double z, normal[3];
	int face;          // the rig's
	float weight[3];
};
bool front_skin(struct front_hit *hit, const struct front *front, double x, double y);

/* Height of the eyeball there; NAN beyond its outline. */
double front_globe(const struct front *front, double x, double y);

/* Of each column of the front where the eyeball shows: the ends of it; x by the column, units. */
enum { FRONT_COLUMNS = 441 };
#define FRONT_COLUMN 0.1
struct front_opening {
	int first, last;             // columns that are open, in a row
	double low[FRONT_COLUMNS], high[FRONT_COLUMNS];
};
static inline double front_column(int i) { return FRONT_COLUMN * (i - FRONT_COLUMNS / 2); }

/* opening.c. Returns false where the lids are shut. */
bool front_open(struct front_opening *opening, const struct front *front);

/* Adds the places of the lids' rims, where they touch the eyeball. */
void hairs_find_rims(struct hairs *hairs, const struct front *front, const struct front_opening *opening);

/* Adds a hair rooted at a hit, with n points given about the eyeball's centre: point[n][3], units. half: mm of an eyeball of 12 mm. */
void front_add(struct hairs *hairs, const struct front *front, const struct front_hit *root, int kind, int n, const double (*point)[3], double half);

/* The same with points in the frame of the root. */
void front_add_local(struct hairs *hairs, const struct front *front, const struct front_hit *root, int kind, int n, const double (*local)[3], double half);

/* Bends the last hair off the eyeball until none of it goes through the skin at rest, as far as that helps. */
void front_clear(struct hairs *hairs, const struct front *front);

/* From the rig's frame to the front's. */
void front_of(double at[3], const struct front *front, const float x[3]);

/* lash.c. A lid's lashes: the longest's length (an eyeball of 12 mm), how much more than the average they curl (1: a third of their length), their
 * number. */
struct lash_growth {
	double mm, curl, n;
};
struct lash_growth lash_average(const struct hair_conf *conf, int kind);
void lash_plant(struct hairs *hairs, const struct front *front, const struct front_opening *opening, int kind, const struct lash_growth *growth, double margin_mm,
                struct rng *rng);

/* The skin that lies `away` units from a place of the front, x and `from`, up (of an upper lid) or down along the skin as a column of the front shows it. False:
 * there is none. */
bool lash_root(struct front_hit *root, const struct front *front, double x, double from, bool upper, double away);

/* match.c, brow.c */
void hairs_grow_lashes(struct hairs *hairs, const struct front *front, const struct front_opening *opening, const struct hair_conf *conf, struct rng *rng);
void hairs_grow_brow(struct hairs *hairs, const struct front *front, const struct hair_conf *conf, struct rng *rng);

/* turn.c: turns lashes, or moves their roots off the margin, as little as does it, until skin crosses each in as few poses over the range of gaze, open, half open
 * and shut, as can be. front: of both eyes; skin: theirs, left in a pose. */
void hairs_turn_out(struct hairs *hairs, const struct front front[2], struct ray_scene *skin);

#endif
