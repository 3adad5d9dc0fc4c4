/* script: keyframes or recorded gaze, from a .csv file.
 *
 * Keyframes: time_s and any of these columns; an empty field is no key.
 *     horizontal_deg, vertical_deg   where to look, of the world: towards the person's left, up (both or neither)
 *     distance_mm                    how far away that is
 *     pursuit                        1: from the key before to this one, the target moves steadily; else it jumps there
 *     head_horizontal_deg, head_vertical_deg   turn of the head
 *     openness                       factor c of equation 3.11: 1 as the gaze has it, 0 shut, above 1 wide
 *     wink_left, wink_right          how far the lids of that eye alone are shut: 1 wholly
 *     blink                          a blink begins: 1 a full one, less a partial one
 *     NAME or auN                    strength of an expression, 0..1; lids go with it
 * Recorded gaze: time_s and g1_deg, g2_deg, may be followed by g3_deg, g4_px, g5_px, g6_deg .. g10_px, au1 .. as in
 * gaze.csv; or time_s and x_px, y_px, a point on a screen (an eye tracker's). Other columns are not looked at.
 */
#ifndef MOTION_SCRIPT_H
#define MOTION_SCRIPT_H
#include "base/csv.h"
#include "model/model.h"

enum script_kind { SCRIPT_KEYS, SCRIPT_RECORDED, SCRIPT_SCREEN };

/* Keys of one channel, in time. */
struct script_track {
	int n;
	double *t, *v;
};

enum { KEY_HORIZONTAL, KEY_VERTICAL, KEY_DISTANCE, KEY_PURSUIT, KEY_HEAD_H, KEY_HEAD_V, KEY_OPENNESS, KEY_WINK_LEFT, KEY_WINK_RIGHT, KEY_BLINK, KEYS };

struct script {
	enum script_kind kind;
	double first, last;             // s
	struct script_track key[KEYS];  // keyframes
	struct script_track *au;        // [n_au]
	int n_au;
	long n;                         // rows of recorded gaze
	double *time, *g;               // [n] s, [n][inputs of the model], units of gaze.csv; NAN where not recorded
	double *screen;                 // [n][2] px of a screen
	bool has_apertures;
};

/* script: overwritten; script_free in any case. model: names of its expressions. Returns false, err set (file, line, column,
 * value, rule), when the file is neither. */
bool script_read(struct script *script, const char *path, const struct skin_model *model, struct err *err);
void script_free(struct script *script);

/* Value of a channel at t (s), along the path of minimum jerk from key to key; `otherwise` where it has no key. */
double script_smooth(const struct script_track *track, double t, double otherwise);

/* Target at t: held from key to key, or moving steadily to the next where that is one of pursuit. out: degrees, horizontal and
 * vertical;
 * distance: mm, INFINITY where no key says. */
void script_target(double out[2], double *distance, const struct script *script, double t);

#endif
