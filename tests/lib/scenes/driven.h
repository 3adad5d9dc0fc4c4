/* driven: the made face with its rig and hairs, as the tests of both drive it. */
#ifndef TESTS_DRIVEN_H
#define TESTS_DRIVEN_H
#include "rig/drive.h"
#include "rig/glb/glb.h"
#include "rig/hair/hair.h"
#include "tests/lib/scenes/face.h"

struct driven {
	struct face face;
	struct rig rig;
	struct hairs hairs;
};

/* Returns false, err set, where the rig cannot be made; driven_free in any case. */
bool driven_make(struct driven *driven, const struct hair_conf *hair, struct err *err);
void driven_free(struct driven *driven);

/* Vertices x[rig.n] in the pose in which both eyes look at horizontal, vertical (degrees), open by that share of what is usual; turn: of the
 * globes, out. */
void driven_pose(float (*x)[3], double turn[2][3][3], const struct driven *driven, double horizontal, double vertical, double open);

/* So many frames of a gaze that wanders, with a blink in the middle. drive_free. */
struct drive driven_wanders(const struct driven *driven, int frames);

/* Sensible settings of the glTF, with all there is: named poses, two expressions, hairs and tears. */
struct glb_conf driven_glb(const struct driven *driven);

/* One without hairs, as the state of a group of tests. */
int driven_setup(void **state);
int driven_teardown(void **state);

/* All of that, as the state of a group of tests. */
enum { WANDERING_FRAMES = 60 };
struct wandering {
	struct driven on;
	struct drive drive;
	struct glb_conf conf;
};
int wandering_setup(void **state);
int wandering_teardown(void **state);

#endif
