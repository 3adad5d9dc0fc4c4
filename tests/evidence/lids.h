/* lids: the opening between two drawn lids, folds, lashes and brow of one eye.
 * Frame  eye: mm, x towards the temple, y up, origin at the ball's centre as the picture shows it.
 */
#ifndef EVIDENCE_LIDS_H
#define EVIDENCE_LIDS_H
#include "canvas.h"

enum { LID_SAMPLES = 96 };
enum lash_style { LASH_FAN, LASH_STRAIGHT, LASH_SPARSE, LASH_NONE, LASH_CLUMPED, LASH_STYLES };  // the last: test split alone

/* How much darker what lies between the lids is at their edge, and how many mm away that has fallen to a third: under the upper lid, over the lower one, in the
 * inner and the outer corner; and the sharper shadow that the upper lid casts, cast_mm wide. */
struct lid_shade { float upper, upper_mm, lower, lower_mm, corner[2], corner_mm[2], cast, cast_mm, cast_soft; };

struct lids {
	float inner[2], outer[2];                             // corners
	float upper[LID_SAMPLES], lower[LID_SAMPLES], crease[LID_SAMPLES];  // y over x from inner to outer
	float open;                                           // largest gap, mm
	float crease_depth, crease_wide, bag, rim, caruncle;
	float liner, liner_wide, shadow, shadow_rgb[3];       // make-up
	enum lash_style style;
	int lashes[2];                                        // upper, lower
	float lash_length[2], lash_wide, lash_curl, lash_rgb[3];
	struct lid_shade shade;
	int brow_hairs;
	float brow_at, brow_arch, brow_thick, brow_tilt, brow_wide, brow_tone, brow_rgb[3];
};

/* openness 0 closed .. 1 wide; gaze_y: sine of the gaze upwards, which the lids follow. */
struct lids lids_make(struct rng *rng, bool test, float openness, float gaze_y);

/* Heights of upper lid, lower lid and fold above x; outside of the corners the lids meet. */
struct lid_heights { float upper, lower, crease; };
struct lid_heights lids_at(const struct lids *lids, float x);

/* How the eye's frame lies in the face's: u = at[0] + side x. */
struct eye_frame { float at[2], side, narrow; };

void lids_draw_lashes(struct canvas *canvas, const struct lids *lids, const struct eye_frame *frame, struct rng *rng, const float light[3]);
void lids_draw_brow(struct canvas *canvas, const struct lids *lids, const struct eye_frame *frame, struct rng *rng, const float light[3]);

#endif
