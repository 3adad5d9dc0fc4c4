/* arkit: the names of Apple's 52 blend shapes of a face. */
#ifndef RIG_GLB_ARKIT_H
#define RIG_GLB_ARKIT_H
#include <stdbool.h>

enum { ARKIT_SHAPES = 52 };
extern const char *const arkit_names[ARKIT_SHAPES];

/* Those of them that gaze and lids give, in the order of a bake's poses. */
enum { GLB_POSES = 12 };
extern const char *const glb_pose_names[GLB_POSES];

/* Targets that are no one's but ours: what the straight way of a blink's target lacks half way down, left and right. */
enum { GLB_HALVES = 2 };
extern const char *const glb_half_names[GLB_HALVES];

/* And what a blink's lacks where the eye looks down or up: left and right of each; then what that way lacks half way (turned.h). */
enum { GLB_TURNED_LOOKS = 4, GLB_TURNED = 2 * GLB_TURNED_LOOKS };
extern const char *const glb_turned_names[GLB_TURNED];
/* The bake's pose of such a blink's look. */
int glb_turned_look(int turned);

/* Whether a name means one of them, written in whatever way: eyeBlinkLeft, eyeBlink_L, "blendShape1.eye_blink_left". */
bool arkit_means(const char *name, const char *arkit);

#endif
