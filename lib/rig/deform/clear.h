/* deform_clear: keeps the faces of a posed character out of its eyeballs. Algorithm 1 keeps the vertices out; where skin unfolds as a
 * lid shuts, an edge gets so long that its middle lies inside all the same. */
#ifndef RIG_DEFORM_CLEAR_H
#define RIG_DEFORM_CLEAR_H
#include <stdbool.h>

#include "rig/deform/cards.h"
#include "rig/rig.h"

/* Faces that can come near an eyeball, and which vertices deform_pose writes: others are not moved here either. deform_near_free. */
struct deform_opening;
struct deform_rooms;

/* An edge of one face or two (of more, two at a time): from the vertex of the smaller number to the other; way: 1 where the face runs so, -1 where it runs back. */
struct deform_edge { int from, to, face[2], way[2]; };

struct deform_near {
	int n, *face;
	int n_beside, *beside;   // other faces of skin before an eyeball: they cover it, and come no nearer
	int n_edges;
	struct deform_edge *edge; // of both; their faces: deform_near_face
	int n_seen[2], *seen[2]; // of each eye: the vertices of both
	bool *moves;   // [rig.n]
	float *upper;  // [rig.n] share in the upper lid, by the opening at rest: 0 below its middle, and where lids are shut at rest
	float *lower;  // [rig.n] the same in the lower lid
	float *own;    // [rig.n] mm: how far up from an arc the margin at rest has a vertex
	double arch[2];       // of each eye: mean height of the upper margin at rest over the line between its corners, mm
	struct deform_opening *rest;  // [2] each eye's opening at rest
	struct deform_opening *rest_aside;  // [4] the same as seen from either side, two of each eye (slide.h)
	double (*lifted)[2];  // [expressions] mm by which each in full raises the left and the right lower lid of eyes that look ahead (arc.h)
	struct deform_cards cards;    // what stands on the skin
	double within[2][2];  // of each eye: heights over the eyeball's centre between which its opening is looked for, mm
	struct deform_rooms *rooms;   // where poses are worked out; several threads may settle poses of their own with one deform_near
};
struct deform_near deform_near_of(const struct rig *rig);
void deform_near_free(struct deform_near *near);

/* Face k of n + n_beside, as a row of the rig. */
static inline int deform_near_face(const struct deform_near *near, int k)
{
	return k < near->n ? near->face[k] : near->beside[k - near->n];
}

/* Moves vertices away from the eyeballs' centres until the middles of edges and faces before the eye are DEFORM_CLEAR_MM off, most
 * those that lie further from it at rest: the lid's margin stays on the eye. What lines a lid goes no further than half of the
 * way to its outside, nor than half a millimetre of an eyeball of 12 mm.
 * x  [rig.n], the target's frame, mm, in and out;  target_from_globe  of both globes in this pose */
#define DEFORM_CLEAR_MM 0.03
/* Whether a vertex lines a lid: at rest it looks at the eyeball. */
bool deform_lines(const struct rig *rig, int vertex);
void deform_clear(float (*x)[3], const struct rig *rig, const struct deform_near *near, const double target_from_globe[2][3][3]);

#endif
