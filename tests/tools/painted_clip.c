/* painted_clip: a capture whose video shows two painted eyes (tests/lib/scenes/painted_film.h) at any frame rate, and what `track` made of it against what was painted.
 *
 *     painted_clip make DIR FPS
 *     painted_clip score DIR      one line to standard output: "NAME VALUE NAME VALUE ..."
 * gaze_h, gaze_v, torsion (open eyes) degrees, skin px: medians, ...95: 95 %, ..._share: of all that there are; blinks and saccades found of both eyes' and
 * ..._wrong ones, ..._s: seconds that their ends are off at most, ..._size, ..._speed: what their amplitudes and peaks are off at most, as a share.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "image/video/video.h"
#include "math/stats.h"
#include "tests/lib/scenes/painted_eye.h"
#include "tests/lib/scenes/painted_film.h"

enum { COLUMNS = 97, ROWS = 12 };

static const char *root;

static char *at(const char *name)
{
	return mem_printf("%s/%s", root, name);
}

/* Skin above the eyes and below them; between the corners of an eye the two part. */
static bool write_mesh(void)
{
	char *path = at("subject.obj");
	FILE *f = fopen(path, "w");
	free(path);
	if (!f)
		return false;
	for (int part = 0; part < 2; part++)
		for (int i = 0; i < COLUMNS; i++)
			for (int k = 0; k < ROWS; k++) {
				double x = i - (COLUMNS - 1) / 2, from = film_rest_margin(x, part), to = part ? -11 : 11;
				// columns nearest the corners end in them
				for (int c = 0; c < 2; c++)
					if (fabs(fabs(x) - FILM_CANTHUS[c]) <= 0.5)
						x = copysign(FILM_CANTHUS[c], x), from = film_rest_margin(x, part);
				fprintf(f, "v %.5f %.5f %.5f\n", x, from + (to - from) * k / (ROWS - 1), FILM_SKIN_Z);
			}
	for (int part = 0; part < 2; part++)
		for (int i = 0; i + 1 < COLUMNS; i++)
			for (int k = 0; k + 1 < ROWS; k++) {
				int a = 1 + (part * COLUMNS + i) * ROWS + k, b = a + ROWS;
				if (part)
					fprintf(f, "f %d %d %d\nf %d %d %d\n", a, a + 1, b, b, a + 1, b + 1);
				else
					fprintf(f, "f %d %d %d\nf %d %d %d\n", a, b, a + 1, b, b + 1, a + 1);
			}
	return fclose(f) == 0;
}

static bool write_conf(struct err *err)
{
	char *path = at("capture.conf");
	char *text = mem_printf("quality = draft\ncamera.focal_px = %g\ncamera.center_px = %g %g\nsubject.unit_mm = 1\nsubject.eye_radius = %g\n"
	                        "subject.eye_center.left = %g 0 0\nsubject.eye_center.right = %g 0 0\n",
	                        PAINTED_FOCAL, 0.5 * FILM_W, 0.5 * FILM_H, PAINTED_R, FILM_EYE_X, -FILM_EYE_X);
	bool ok = file_write(path, text, strlen(text), err);
	free(path);
	free(text);
	return ok;
}

static bool make(double fps, struct err *err)
{
	char *folder = at("video"), *path = at("video/painted.mp4");
	struct video_writer_conf conf = { .width = FILM_W, .height = FILM_H, .fps = fps, .crf = 14, .preset = "veryfast" };
	struct video_writer *writer = file_mkdirs(folder, err) ? video_writer_open(path, &conf, err) : 0;
	long n = lround(FILM_SECONDS * fps), batch = 32;
	uint8_t *rgb = mem_array((size_t)batch, FILM_W * FILM_H * 3);
	bool ok = writer && (write_mesh() || err_set(err, "%s: cannot be written", root)) && write_conf(err);
	for (long f = 0; f < n && ok; f += batch) {
#pragma omp parallel for schedule(dynamic)
		for (long k = 0; k < batch; k++)
			if (f + k < n)
				film_draw(rgb + k * FILM_W * FILM_H * 3, (double)(f + k) / fps, (uint64_t)(1000 + f + k));
		for (long k = 0; k < batch && f + k < n && ok; k++)
			ok = video_writer_put(writer, rgb + k * FILM_W * FILM_H * 3, (double)(f + k) / fps, err);
	}
	free(rgb);
	free(folder);
	free(path);
	return video_writer_close(writer, ok, err) && ok;
}

/* Of open eyes, both together. */
static bool score_gaze(struct err *err)
{
	static const char *const column[2][3] = { { "g1_deg", "g2_deg", "g3_deg" }, { "g6_deg", "g7_deg", "g8_deg" } };
	static const char *const name[3] = { "gaze_h", "gaze_v", "torsion" };
	struct csv_table t;
	char *path = at("work/skin/gaze.csv");
	bool ok = csv_read(&t, path, err);
	double *off = mem_array(2 * (size_t)t.n_rows + 1, sizeof *off);
	for (int k = 0; k < 3 && ok; k++) {
		int n = 0, open = 0;
		for (long f = 0; f < t.n_rows; f++) {
			struct film_state s = film_at(csv_at(&t, f, csv_column(&t, "time_s")));
			for (int e = 0; e < 2 && s.closure < 0.05; e++) {
				double got = csv_at(&t, f, csv_column(&t, column[e][k]));
				open++;
				if (isfinite(got))
					off[n++] = fabs(got - s.gaze[k] * 180 / M_PI);
			}
		}
		printf("%s %.3f %s95 %.3f %s_share %.3f ", name[k], n ? stats_median(n, off) : NAN, name[k], n ? stats_quantile(n, off, 0.95) : NAN, name[k], (double)n / open);
	}
	free(off);
	free(path);
	csv_table_free(&t);
	return ok;
}

/* What points of skin seen have moved since the reference, against the head's way. */
static bool score_skin(long reference, double fps, struct err *err)
{
	struct npy at_px = { 0 }, seen = { 0 };
	char *a = at("work/skin/skin.npy"), *b = at("work/skin/confidence.npy");
	bool ok = npy_read(&at_px, a, 1 << 28, err) && npy_read(&seen, b, 1 << 28, err);
	long frames = ok ? at_px.shape[0] : 0, points = ok ? at_px.shape[1] : 0;
	const float(*p)[2] = at_px.data, *c = seen.data;
	double *off = mem_array((size_t)(frames * points) + 1, sizeof *off), scale = PAINTED_FOCAL / (PAINTED_FAR - FILM_SKIN_Z);
	struct film_state was = film_at((double)reference / fps);
	int n = 0;
	for (long i = 0; i < frames * points; i++) {
		struct film_state now = film_at((double)(i / points) / fps);
		const float *q = p[reference * points + i % points];
		if (c[i] > 0)
			off[n++] = hypot((double)(p[i][0] - q[0]) - scale * (now.head[0] - was.head[0]), (double)(p[i][1] - q[1]) + scale * (now.head[1] - was.head[1]));
	}
	if (ok)
		printf("points %ld skin %.3f skin95 %.3f skin_share %.3f ", points, stats_median(n, off), stats_quantile(n, off, 0.95), (double)n / (double)(frames * points));
	free(off);
	npy_free(&at_px);
	npy_free(&seen);
	free(a);
	free(b);
	return ok;
}

/* When a blink has fallen to, and risen from, the share of its depth at which it is said to begin and end (track/eye/events.c). */
static void blink_ends(double end[2], const struct film_event *e)
{
	const double onset = 0.15, step = 1e-4;
	for (int k = 0; k < 2; k++) {
		double t = k ? e->end : e->start;
		while (film_at(t).closure < onset * e->size)
			t += k ? -step : step;
		end[k] = t;
	}
}

/* What was found of events of one kind against those painted; saccades that a blink hides are none. */
static void score_events(const char *name, const json_t *found, double fps, int n, const struct film_event *truth)
{
	bool blinks = !strcmp(name, "blinks");
	int seen[2][8] = { { 0 } }, wrong = 0, all = 0;
	double ends = 0, size = 0, speed = 0;
	size_t i;
	json_t *j;
	json_array_foreach(found, i, j) {
		double first = json_number_value(json_object_get(j, "first")) / fps, last = json_number_value(json_object_get(j, "last")) / fps;
		double amplitude = json_number_value(json_object_get(j, blinks ? "amplitude" : "amplitude_deg")), fast = json_number_value(json_object_get(j, "peak_speed_deg_s"));
		int side = strcmp(json_string_value(json_object_get(j, "eye")), "left") != 0, k = 0;
		while (k < n && !(first < truth[k].end && last > truth[k].start))
			k++;
		if (k == n || seen[side][k]++) {
			wrong++;
			continue;
		}
		double end[2] = { truth[k].start, truth[k].end };
		if (blinks)
			blink_ends(end, &truth[k]);
		ends = fmax(ends, fmax(fabs(first - end[0]), fabs(last - end[1])));
		size = fmax(size, fabs(amplitude / truth[k].size - 1));
		speed = blinks ? 0 : fmax(speed, fabs(fast / truth[k].peak_speed - 1));
	}
	for (int e = 0; e < 2; e++)
		for (int k = 0; k < n; k++)
			all += seen[e][k] > 0;
	printf("%s %d %s_wrong %d %s_s %.4f %s_size %.3f ", name, all, name, wrong, name, ends, name, size);
	if (!blinks)
		printf("%s_speed %.3f ", name, speed);
}

static bool score(struct err *err)
{
	char *path = at("work/skin/track.json");
	double fps = NAN;
	struct film_event turn[FILM_SACCADES];
	json_t *j = score_gaze(err) ? json_read(path, 1 << 22, err) : 0;
	for (int i = 0; i < FILM_SACCADES; i++)
		turn[i] = film_saccade(i);
	bool ok = j && json_get(&fps, j, "fps", path, err) && score_skin((long)json_integer_value(json_object_get(j, "reference_frame")), fps, err);
	if (ok) {
		printf("fps %.3f frames %lld reference %lld ", fps, (long long)json_integer_value(json_object_get(j, "frames")),
		       (long long)json_integer_value(json_object_get(j, "reference_frame")));
		score_events("blinks", json_object_get(j, "blinks"), fps, FILM_BLINKS, film_blink);
		score_events("saccades", json_object_get(j, "saccades"), fps, FILM_SACCADES, turn);
		printf("\n");
	}
	json_decref(j);
	free(path);
	return ok;
}

int main(int argc, char **argv)
{
	struct err err = { 0 };
	bool making = argc == 4 && !strcmp(argv[1], "make") && atof(argv[3]) > 0;
	if (!making && !(argc == 3 && !strcmp(argv[1], "score")))
		return 2;
	root = argv[2];
	bool ok = making ? make(atof(argv[3]), &err) : score(&err);
	if (!ok)
		fprintf(stderr, "painted_clip: %s\n", err.msg);
	return !ok;
}
