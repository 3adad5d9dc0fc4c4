/* glb: exports a driven character as binary glTF 2.0: the skin as a mesh with morph targets, the eyeballs as rotating nodes, one baked
 * animation. Metres, y up, the face towards +z, as glTF requires.
 *
 * Algorithm 1 is not linear in e, because skin slides over a round skull and a turning cornea. So the animation is evaluated and its
 * displacements are decomposed (principal components): the fewest morph targets that keep every vertex of every frame within a
 * tolerance (at most `targets`), with their weights over time. Further targets of single poses (eyeBlinkLeft, eyeLookUpRight ..., the
 * names of Apple's ARKit, an eye's being its own side of a pose of both; expressions, by the model's) are included with weight 0; they may be
 * added to each other, but not to the animation's. A target is a straight line and a lid goes round the eye: where eyeBlinkLeft has the weight
 * w, eyeBlinkLeft_half has 4 w (1 - w) (halves.h). A second animation, `blink`, does so. And where eyeLookDownLeft has v, eyeBlinkLeft_down
 * has w v, eyeBlinkLeft_down_half 4 w (1 - w) v, and eyeBlinkLeft_up so with eyeLookUpLeft (turned.h); so has
 * eyeBlinkLeft_squint, and eyeBlinkLeft_squint_half where it is needed, with v of each expression that moves lids (mixed.h). The file says it of each mesh, in extras: drivenTargets, a
 * list of target, by (whose weight is w), and (v) and weight: "w v", "4 w (1 - w)" or "4 w (1 - w) v".
 */
#ifndef RIG_GLB_GLB_H
#define RIG_GLB_GLB_H
#include "character/look.h"
#include "rig/drive.h"
#include "rig/hair/hair.h"

struct glb_conf {
	int targets;           // at most, of the animation
	double tolerance;      // mm, worst vertex of all frames
	bool poses;            // include the named targets
	int n_expressions;     // with them: of the inputs after the eyes' (model/model.h)
	const char *const *expression;  // their names
	double skin_rgb[3];    // linear
	const struct hairs *hairs;  // lashes and brows, meshes of their own that follow the same targets; null: none
	double hair_rgb[3];
	double tear_mm;        // height of the meniscus of tears along the lower lids, where hairs has their rims; 0: none
	double over_mm;        // that the eyes stand over the rig's globes
};

/* A whole eye as the bytes of a binary glTF: metres, its origin in the centre of the scleral sphere, z out through the pupil, y up.
 * Both sides may have the same: it is in the file once. */
struct glb_eye {
	const void *bytes;
	size_t size;
	double radius;         // of the scleral sphere, mm: it is scaled to the globe's
};

struct glb_report {
	int targets, moving;   // of the animation; vertices that move
	double worst;          // largest error of the decomposition, mm; of skin
	long bytes;            // of the file
};

/* Writes the file. A character with a look keeps its meshes, texture coordinates, materials, textures and blend shapes; its eyeballs
 * are replaced by the eyes. The mesh that moves most has all 52 of ARKit's names as targets, where conf->poses: those that neither gaze nor the
 * character's file gives are zero, and listed in that mesh's extras (zeroTargets). A blend shape of the file that bears the name of
 * one of ours is called NAME.own.
 * report   overwritten
 * eye      left, right
 * look     of a character whose file has one (its rows are the rig's vertices), or null
 * name     of the root node; made_by: JSON text for asset.extras, or null
 * Returns false, err set, when the decomposition fails or the file cannot be written. */
bool glb_write(const char *path, struct glb_report *report, const struct rig *rig, const struct drive *drive,
               const struct glb_eye eye[2], const char *name, const struct look *look, const struct glb_conf *conf, const char *made_by, struct err *err);

#endif
