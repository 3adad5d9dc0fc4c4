/* skin/animate: gaze, lids and expressions over time (skin paper, sections 3.7, 3.9 and 3.10).
 * Where the eyes look comes from keyframes, from recorded gaze or from places of a scene; how they get there from
 * motion/gaze_sim.h; how far they are open from the model's baseline (eq. 3.11), blinks and keys.
 */
#ifndef MOTION_ANIMATE_H
#define MOTION_ANIMATE_H
#include <stdint.h>

#include "motion/blink.h"
#include "motion/gaze_sim.h"
#include "motion/script.h"

struct animate_conf {
	struct gaze_conf gaze;
	struct blink_conf blink;
	double fps, duration;         // duration NAN: as long as the script
	double key_latency;           // s from a key to the saccade it asks for
	double hold;                  // s that the last key is held
	bool blinks;                  // spontaneous ones
	double gaze_blink;            // degrees: larger saccades come with a blink; 0: never
	double beyond;                // apertures leave the clip's own range by no more than this share of it
	double scene_deg;             // width of the scene or screen, degrees
	double screen[2];             // its size, px, for x_px, y_px
	double scene_distance;        // mm
	uint64_t seed;
};

/* Places looked at in a scene, in order: share of its width and height. */
struct animate_places {
	int n;
	double *t, (*at)[2];
	double aspect, duration;      // height over width; s
};

struct animation {
	long n;
	int n_inputs;
	double fps;
	double *g, *controls;         // [n][n_inputs], units of gaze.csv; g~
	double *closure, *head;       // [n] 0..1; [n][2] degrees
	int n_blinks, n_saccades;
	struct blink *blinks;
	struct gaze_saccade *saccades;
};

/* What drives: any of script (a second one may add keys of head, lids and expressions to recorded gaze or places) and
 * places; null where there is none. animation_free in any case. */
bool animate_run(struct animation *out, const struct skin_model *model, const struct script *gaze,
                 const struct script *keys, const struct animate_places *places, const struct animate_conf *conf,
                 struct err *err);
void animation_free(struct animation *animation);

/* frame, time_s, g1_deg .. g10_px, au1 .., then a4 a5 a9 a10 (aperture controls), closure, head_horizontal_deg,
 * head_vertical_deg. */
bool animation_save(const char *path, const struct animation *animation, struct err *err);

#endif
