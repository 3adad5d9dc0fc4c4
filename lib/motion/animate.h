/* animate: gaze, lids and expressions over time (skin paper, sections 3.7, 3.9 and 3.10). Targets come from keyframes, recorded
 * gaze or places of a scene; gaze_sim.h moves the eyes to them; apertures come from the model's baseline (eq. 3.11), blinks, keys
 * and expressions (model/express.h).
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
	double fps, duration;         // 1/s; s, NAN: as long as the script
	double key_latency;           // s from a key to its saccade
	double hold;                  // s that the last key is held
	bool blinks;                  // spontaneous blinks
	double gaze_blink;            // degrees: larger saccades come with a blink; 0: never
	double beyond;                // apertures may leave the clip's range by this share of it
	double scene_deg;             // width of the scene or screen, degrees
	double screen[2];             // size of the screen of x_px, y_px, px
	double scene_distance;        // mm, of the scene or screen
	uint64_t seed;
};

/* Fixations in a scene, in order: onset (s), place (share of width and height). Owned. */
struct animate_places {
	int n;
	double *t, (*at)[2];
	double aspect, duration;      // height over width; s
};

struct animation {
	long n;
	int n_inputs;
	double fps;
	double *g, *controls;         // [n][n_inputs]: units of gaze.csv; aperture controls g~
	double *closure, *head;       // [n] of blinks, 0..1; [n][2] horizontal, vertical, degrees
	int n_blinks, n_saccades;
	struct blink *blinks;
	struct gaze_saccade *saccades;
};

/* Animates by any of gaze (recorded), keys and places; null where there is none. keys may add head, lids and expressions to
 * recorded gaze or places. Recorded gaze is replayed, all else simulated. out: overwritten; animation_free in any case.
 * Returns false, err set, when the animation would have too many frames. */
bool animate_run(struct animation *out, const struct skin_model *model, const struct script *gaze,
                 const struct script *keys, const struct animate_places *places, const struct animate_conf *conf,
                 struct err *err);
void animation_free(struct animation *animation);

/* Writes a CSV: frame, time_s, g1_deg .. g10_px, au1 .., then a4 a5 a9 a10 (aperture controls), closure, head_horizontal_deg,
 * head_vertical_deg. */
bool animation_save(const char *path, const struct animation *animation, struct err *err);

#endif
