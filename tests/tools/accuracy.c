/* accuracy: what a run of a bundled capture is off by, one quantity a line: NAME, tab, figure, tab, unit.
 *
 *     accuracy eye CAPTURE TRUTH      samples/demo, made with `unrefract.write_map = yes`
 *     accuracy face CAPTURE TRUTH     samples/face, to the stage extrapolate
 *
 * Errors are against the truth folder. What it does not hold (melanin, the renderer's own view, the fit of the model, the
 * registration) is a residual of the run itself, or the figure as it is. A figure that cannot be had is nan. tests/chain/accuracy.sh holds them.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "image/exr.h"
#include "tests/lib/score/track_score.h"
#include "tests/lib/truth/iris.h"
#include "tests/lib/truth/truth.h"

enum { LIMIT_PX = 1 << 26, JSON_LIMIT = 1 << 24 };

static int missing;

static void say(const char *name, double figure, const char *unit)
{
	missing += isnan(figure);
	printf("%s\t%.6g\t%s\n", name, figure, unit);
}

static void trouble(struct err *err)
{
	fprintf(stderr, "accuracy: %s\n", err->msg);
	*err = (struct err){ 0 };
}

/* ---- an eye ------------------------------------------------------------------------------------------------------- */
static double apart(const struct ellipse *a, const struct ellipse *b)
{
	return hypot(a->cx - b->cx, a->cy - b->cy);
}

static double other_axes(const struct ellipse *a, const struct ellipse *b)
{
	return fmax(fabs(a->a - b->a), fabs(a->b - b->b));
}

static void pose(const char *capture, const struct truth *t)
{
	char *path = mem_printf("%s/work/limbus/right_softbox.json", capture);
	struct fit f = { 0 };
	struct err err = { 0 };
	double dot = 0;
	bool ok = fit_load(&f, path, &err) && f.ok;
	if (!ok)
		trouble(&err);
	for (int i = 0; i < 3; i++)
		dot += f.cam_from_eye[i][2] * t->cam_from_eye[i][2];
	say("limbus, centre", ok ? apart(&f.limbus, &t->limbus) : NAN, "px");
	say("limbus, semi-axes", ok ? other_axes(&f.limbus, &t->limbus) : NAN, "px");
	say("pupil, centre", ok && f.has_pupil ? apart(&f.pupil, &t->pupil) : NAN, "px");
	say("pupil, semi-axes", ok && f.has_pupil ? other_axes(&f.pupil, &t->pupil) : NAN, "px");
	say("optical axis", ok ? acos(fmin(dot, 1)) * 180 / M_PI : NAN, "deg");
	free(path);
}

/* Positions on the iris, pixel for pixel, within 0.9 of its radius; and how high the relief puts them, beside what they are in the
 * mean. */
static void positions(const char *capture, const struct truth *t, const char *truth)
{
	static const char *const xy[] = { "X", "Y" }, *const rgba[] = { "R", "G", "B", "A" }, *const y_alone[] = { "Y" };
	struct image ours = { 0 }, theirs = { 0 }, relief = { 0 };
	struct exr_info info = { 0 };
	struct err err = { 0 };
	char *map = mem_printf("%s/work/iris/right_softbox.map.exr", capture), *path = mem_printf("%s/map.exr", truth);
	char *heights = mem_printf("%s/work/iris/relief.exr", capture);
	bool ok = exr_read(&ours, map, 2, xy, LIMIT_PX, 0, &err) && exr_read(&theirs, path, 4, rgba, LIMIT_PX, 0, &err)
	          && exr_read(&relief, heights, 1, y_alone, LIMIT_PX, &info, &err);
	if (!ok)
		trouble(&err);
	double *off = mem_array((size_t)theirs.width * (size_t)theirs.height + 1, sizeof *off), *high = mem_array((size_t)theirs.width * (size_t)theirs.height + 1, sizeof *high);
	double middle = 0, square = 0;
	long n = 0, m = 0;
	for (int y = 0; ok && y < theirs.height && 2 * y < ours.height; y++)
		for (int x = 0; x < theirs.width && 2 * x < ours.width; x++) {
			const float *p = image_at(&theirs, x, y), *q = image_at(&ours, 2 * x, 2 * y);
			double in[2] = { (double)p[0], (double)p[1] }, want[2], r = hypot(in[0], in[1]);
			if (lroundf(p[3]) != 1 || r > 0.9 * t->iris_radius)
				continue;
			truth_turn(want, t, in);
			double d = hypot((double)q[0] - want[0], (double)q[1] - want[1]);
			if (isfinite(d))
				off[n++] = d;
			int u = (int)((want[0] / info.extent_mm + 1) / 2 * relief.width), v = (int)((want[1] / info.extent_mm + 1) / 2 * relief.height);
			if (u < 0 || v < 0 || u >= relief.width || v >= relief.height)
				continue;
			// z points into the eye.
			double h = (double)*image_at(&relief, u, v) + (double)p[2];
			if (isfinite(h)) {
				high[m++] = h;
				middle += h;
			}
		}
	for (long i = 0; i < m; i++)
		square += (high[i] - middle / (double)m) * (high[i] - middle / (double)m);
	struct spread s = spread_of(n, off);
	say("iris position, median", ok ? s.median : NAN, "mm");
	say("iris position, 95 %", ok ? s.p95 : NAN, "mm");
	say("height field, rms about its mean", ok && m ? sqrt(square / (double)m) : NAN, "mm");
	image_free(&ours);
	image_free(&theirs);
	image_free(&relief);
	free(off);
	free(high);
	free(map);
	free(path);
	free(heights);
}

/* The iris without its cornea against the painted one, each channel with a gain of its own: light and exposure are not known. And
 * the freckles. */
static void texture(const char *capture, const struct truth *t, const char *truth)
{
	static const char *const rgbw[] = { "R", "G", "B", "W" }, *const y_alone[] = { "Y" };
	struct image ours = { 0 }, painted = { 0 }, opacity = { 0 };
	struct exr_info info = { 0 };
	struct err err = { 0 };
	double extent, uv[3] = { 0 }, uu[3] = { 0 }, vv[3] = { 0 }, off = 0;
	char *path = mem_printf("%s/work/iris/texture.exr", capture), *mask = mem_printf("%s/work/iris/freckles.exr", capture);
	bool ok = exr_read(&ours, path, 4, rgbw, LIMIT_PX, &info, &err) && exr_read(&opacity, mask, 1, y_alone, LIMIT_PX, 0, &err)
	          && iris_painted(&painted, &extent, t, truth, ours.width);
	uint8_t *freckled = ok ? iris_freckle_mask(t, truth, ours.width, info.extent_mm, true) : 0;
	if (!ok)
		trouble(&err);
	for (int y = 0; ok && y < ours.height; y++)
		for (int x = 0; x < ours.width; x++) {
			const float *p = image_at(&ours, x, y);
			double mm[2] = { ((x + 0.5) * 2 / ours.width - 1) * info.extent_mm, ((y + 0.5) * 2 / ours.height - 1) * info.extent_mm };
			double c = cos(t->turn), s = sin(t->turn), at[2] = { c * mm[0] + s * mm[1], c * mm[1] - s * mm[0] };
			int u = (int)((at[0] / extent + 1) / 2 * painted.width), v = (int)((at[1] / extent + 1) / 2 * painted.height);
			if (p[3] < 0.5f || u < 0 || v < 0 || u >= painted.width || v >= painted.height || hypot(at[0], at[1]) > 0.9 * t->iris_radius)
				continue;
			const float *q = image_at(&painted, u, v);
			for (int k = 0; k < 3 && q[3] > 0; k++) {
				uv[k] += (double)p[k] * (double)q[k];
				uu[k] += (double)p[k] * (double)p[k];
				vv[k] += (double)q[k] * (double)q[k];
			}
		}
	for (int k = 0; k < 3; k++)  // of the painted one's square, what the best multiple of ours leaves
		off += (1 - uv[k] * uv[k] / (uu[k] * vv[k])) / 3;
	say("iris texture, rms of what one gain a channel leaves", ok ? 100 * sqrt(off) : NAN, "%");
	struct freckles found = { .size = ours.width, .opacity = opacity.px };
	say("freckles, 1 - intersection over union", freckled && opacity.width == ours.width ? 1 - iris_freckle_overlap(&found, freckled, &ours) : NAN, "");
	free(freckled);
	image_free(&ours);
	image_free(&painted);
	image_free(&opacity);
	free(path);
	free(mask);
}

/* A number of a JSON file, by a path of keys; NAN where it is none. */
static double number_in(const char *capture, const char *file, const char *keys[])
{
	struct err err = { 0 };
	char *path = mem_printf("%s/work/%s", capture, file);
	json_t *json = json_read(path, JSON_LIMIT, &err), *at = json;
	for (int i = 0; at && keys[i]; i++)
		at = json_object_get(at, keys[i]);
	double x = json_is_number(at) ? json_number_value(at) : NAN;
	if (!json)
		trouble(&err);
	json_decref(json);
	free(path);
	return x;
}
#define NUMBER(capture, file, ...) number_in(capture, file, (const char *[]){ __VA_ARGS__, 0 })

static bool eye(const char *capture, const char *truth)
{
	struct truth t;
	struct err err = { 0 };
	if (!truth_load(&t, truth, &err)) {
		trouble(&err);
		return false;
	}
	pose(capture, &t);
	positions(capture, &t, truth);
	texture(capture, &t, truth);
	say("melanin of the border layer", NUMBER(capture, "iris/pigment.json", "abl", "melanin", "value"), "");
	say("melanin, residual in colour", 100 * NUMBER(capture, "iris/pigment.json", "residual_colour"), "%");
	say("own view, mean difference", NUMBER(capture, "render/right_softbox_compare.json", "difference_mean"), "CIEDE2000");
	say("own view, difference, 95 %", NUMBER(capture, "render/right_softbox_compare.json", "difference_95"), "CIEDE2000");
	say("own view, explained by the model", 100 * NUMBER(capture, "render/right_softbox_compare.json", "explained_by_model"), "%");
	say("refraction function, worst", NUMBER(capture, "log/refraction.json", "figures", "refraction_error_worst", "value"), "mm");
	return true;
}

/* ---- a face ------------------------------------------------------------------------------------------------------- */
/* Strengths of the expressions that were marked, in the frames before the truth's first: 0 there. */
static void unshown(const char *capture, const char *truth)
{
	struct csv_table gaze = { 0 };
	struct err err = { 0 };
	char *path = mem_printf("%s/work/skin/gaze.csv", capture), *facts = mem_printf("%s/truth.json", truth);
	json_t *json = json_read(facts, JSON_LIMIT, &err), *unit;
	bool ok = json && csv_read(&gaze, path, &err) && csv_column(&gaze, "au1") >= 0 && csv_column(&gaze, "au2") >= 0;
	double first = INFINITY;
	size_t at;
	json_array_foreach(json_object_get(json_object_get(json, "intervals_s"), "action_units"), at, unit)
		first = fmin(first, json_number_value(json_object_get(unit, "start")));
	if (!ok)
		trouble(&err);
	double *x = mem_array(2 * (size_t)gaze.n_rows + 1, sizeof *x);
	long n = 0;
	for (long f = 0; ok && f < gaze.n_rows; f++)
		for (int k = 1; k <= 2 && csv_at(&gaze, f, csv_column(&gaze, "time_s")) < first; k++)
			x[n++] = fabs(csv_at(&gaze, f, csv_column(&gaze, k == 1 ? "au1" : "au2")));
	say("expressions, where none is shown, 95 %", n ? spread_of(n, x).p95 : NAN, "of the peak");
	free(x);
	csv_table_free(&gaze);
	json_decref(json);
	free(path);
	free(facts);
}

static void tracked(const char *capture, const char *truth)
{
	static const char *const axes[] = { "gaze, horizontal", "gaze, vertical", "torsion" };
	struct track_score s;
	struct err err = { 0 };
	bool ok = track_score(&s, capture, truth, &err);
	if (!ok)
		trouble(&err);
	for (int k = 0; k < 3; k++) {
		char *tail = mem_printf("%s, 95 %%", axes[k]);
		say(axes[k], ok ? s.gaze[k].median : NAN, "deg");
		say(tail, ok ? s.gaze[k].p95 : NAN, "deg");
		free(tail);
	}
	say("gaze, frames with open eyes that lack it", ok ? 100 * (1 - s.gaze_share) : NAN, "%");
	say("lid margins", ok ? s.lid.median : NAN, "px");
	say("lid margins, 95 %", ok ? s.lid.p95 : NAN, "px");
	say("aperture", ok ? s.aperture.median : NAN, "px");
	say("skin, motion since the reference", ok ? s.skin.median : NAN, "px");
	say("skin, motion, 95 %", ok ? s.skin.p95 : NAN, "px");
	say("skin, place", ok ? s.skin_place.median : NAN, "px");
	say("skin, points in sight that are not seen", ok ? 100 * (1 - s.skin_seen) : NAN, "%");
	say("blinks missed or invented", ok ? s.blinks - s.found + s.wrong : NAN, "");
	unshown(capture, truth);
}

static bool face(const char *capture, const char *truth)
{
	static const struct {
		const char *stage, *figure, *name, *unit;
	} own[] = {
		{ "track", "track_pose", "head pose, residual", "px" },
		{ "train", "train_lids_left_px", "model, left lids held out", "px" },
		{ "train", "train_lids_right_px", "model, right lids held out", "px" },
		{ "train", "train_skin_px", "model, skin held out", "px" },
		{ "transfer", "residual_rms", "registration, residual", "mm" },
		{ "transfer", "distance_95", "registration, distance, 95 %", "mm" },
		{ "extrapolate", "off_chart", "registered mesh against the skin at rest", "px" },
		{ "extrapolate", "lids_folded_error", "lids, left by their own components", "px" },
		{ "extrapolate", "open_after_sealing", "closed eyes, left open", "mm" },
	};
	tracked(capture, truth);
	for (int i = 0; i < COUNT(own); i++) {
		char *file = mem_printf("log/%s.json", own[i].stage);
		say(own[i].name, NUMBER(capture, file, "figures", own[i].figure, "value"), own[i].unit);
		free(file);
	}
	return true;
}

int main(int argc, char **argv)
{
	if (argc == 4 && !strcmp(argv[1], "eye"))
		return eye(argv[2], argv[3]) && !missing ? 0 : 1;
	if (argc == 4 && !strcmp(argv[1], "face"))
		return face(argv[2], argv[3]) && !missing ? 0 : 1;
	fprintf(stderr, "usage: accuracy eye|face CAPTURE TRUTH\n");
	return 2;
}
