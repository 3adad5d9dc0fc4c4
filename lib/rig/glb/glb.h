/* glb: a driven character as glTF 2.0 binary: skin as a mesh with morph targets, eyeballs as nodes that turn, one baked
 * animation. Metres, y up, the face towards +z, as glTF has it.
 *
 * Algorithm 1 is not linear in e once skin slides over a round skull and a turning cornea; so the animation is evaluated,
 * and its displacements are decomposed: the fewest morph targets that keep every vertex of every frame within a
 * tolerance (at most `targets`), with their weights over time. Further targets of poses by themselves (eyeBlinkLeft,
 * eyeLookUpRight ..., the names of Apple's ARKit) stand ready with weight 0.
 */
#ifndef RIG_GLB_GLB_H
#define RIG_GLB_GLB_H
#include "rig/drive.h"

struct glb_conf {
	int targets;           // at most, of the animation
	double tolerance;      // mm, worst vertex of all frames
	bool poses;            // the named targets, too
	double skin_rgb[3], iris_rgb[3], sclera_rgb[3];  // linear
};

struct glb_report {
	int targets, moving;   // of the animation; vertices that move
	double worst;          // mm, that the decomposition is off by at most
	long bytes;
};

/* name: of the character; made_by: JSON text kept in asset.extras, or null. */
bool glb_write(const char *path, struct glb_report *report, const struct rig *rig, const struct drive *drive, const char *name,
               const struct glb_conf *conf, const char *made_by, struct err *err);

#endif
