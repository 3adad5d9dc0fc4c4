#include "tests/lib/score/track_score.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"

enum { TENTH = 10 };
static const double blink_s = 0.4;  // a blink's peak lies within this after its start

struct array {
	double *x;
	long shape[4];
};

struct found {
	const char *dir, *truth;
	struct array skin, seen, vertex, head, lids;
	struct csv_table gaze;
	json_t *track, *clip;
	long n, reference;
	long first;            // frame of the truth at which the video begins
	double scale;          // px of the truth in one px of the video
};

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct spread spread_of(long n, double *x)
{
	qsort(x, (size_t)n, sizeof *x, by_value);
	if (!n)
		return (struct spread){ NAN, NAN, NAN, 0 };
	return (struct spread){ x[n / 2], x[(long)(0.9 * (double)(n - 1))], x[(long)(0.95 * (double)(n - 1))], n };
}

static bool npy(struct array *a, const char *dir, const char *name, struct err *err)
{
	struct npy file;
	char *path = mem_printf("%s/work/skin/%s", dir, name);
	bool ok = npy_read(&file, path, NPY_LIMIT, err);
	a->x = ok ? npy_doubles(&file) : 0;
	memcpy(a->shape, file.shape, sizeof a->shape);
	npy_free(&file);
	free(path);
	return ok;
}

/* What the truth says of each frame from the video's first on. */
static void begin(struct array *a, const struct found *f)
{
	long each = 1;
	if (!a->x || a->shape[0] != f->n + f->first)
		return;
	for (int k = 1; k < 4 && a->shape[k]; k++)
		each *= a->shape[k];
	memmove(a->x, a->x + f->first * each, (size_t)(f->n * each) * sizeof *a->x);
	a->shape[0] = f->n;
}

/* An array of the truth; x null where it has none. free(). */
static struct array truth(const struct found *f, const char *name, const char *side)
{
	struct npy file;
	struct err none = { 0 };
	struct array a = { 0 };
	char *path = mem_printf("%s/truth.npz", f->truth), *key = side ? mem_printf("%s_%s", name, side) : mem_str(name);
	if (npz_read(&file, path, key, NPY_LIMIT, &none)) {
		a.x = npy_doubles(&file);
		memcpy(a.shape, file.shape, sizeof a.shape);
		npy_free(&file);
	}
	if (f->first)
		begin(&a, f);
	free(path);
	free(key);
	return a;
}

static bool load(struct found *f, struct err *err)
{
	char *csv = mem_printf("%s/work/skin/gaze.csv", f->dir), *track = mem_printf("%s/work/skin/track.json", f->dir);
	char *clip = mem_printf("%s/truth.json", f->truth);
	double reference = 0;
	bool ok = csv_read(&f->gaze, csv, err) && npy(&f->skin, f->dir, "skin.npy", err) && npy(&f->seen, f->dir, "confidence.npy", err)
	          && npy(&f->vertex, f->dir, "vertices.npy", err) && npy(&f->head, f->dir, "head.npy", err) && npy(&f->lids, f->dir, "lids.npy", err)
	          && (f->track = json_read(track, 1 << 24, err)) && (f->clip = json_read(clip, 1 << 24, err))
	          && json_get(&reference, f->track, "reference_frame", track, err);
	// a clip of fewer pixels is measured in those of its truth
	double wide = 1, full = 1;
	ok = ok && json_get(&wide, json_object_get(f->track, "camera"), "width", track, err) && json_get(&full, f->clip, "width", clip, err);
	f->scale = full / wide;
	for (long i = 0; ok && i < f->skin.shape[0] * f->skin.shape[1] * 2; i++)
		f->skin.x[i] *= f->scale;
	for (long i = 0; ok && i < f->lids.shape[0] * f->lids.shape[1] * f->lids.shape[2] * 2; i++)
		f->lids.x[i] *= f->scale;
	f->reference = (long)reference;
	f->n = f->skin.shape[0];
	free(csv);
	free(track);
	free(clip);
	return ok;
}

static void score_skin(struct track_score *s, const struct found *f)
{
	struct array at = truth(f, "skin_px", 0), visible = truth(f, "skin_visible", 0), row = truth(f, "skin_vertex", 0);
	long n = f->n, m = f->skin.shape[1], all = row.shape[0], k = n / TENTH, sight = 0;
	double *moved = mem_new((size_t)(n * m) + 1, sizeof *moved), *place = mem_new((size_t)(n * m) + 1, sizeof *place);
	double *first = mem_new((size_t)(n * m) + 1, sizeof *first), *last = mem_new((size_t)(n * m) + 1, sizeof *last);
	long count = 0, n_first = 0, n_last = 0, r = f->reference;
	for (long i = 0; i < m; i++) {
		long j = 0;
		while (j < all && row.x[j] != f->vertex.x[i])
			j++;
		for (long t = 0; t < n && j < all && visible.x[r * all + j] > 0; t++) {
			const double *p = f->skin.x + 2 * (t * m + i), *p0 = f->skin.x + 2 * (r * m + i);
			const double *q = at.x + 2 * (t * all + j), *q0 = at.x + 2 * (r * all + j);
			if (!(visible.x[t * all + j] > 0))
				continue;
			sight++;
			if (!(f->seen.x[t * m + i] > 0))
				continue;
			place[count] = hypot(p[0] - q[0], p[1] - q[1]);
			double e = moved[count++] = hypot(p[0] - p0[0] - q[0] + q0[0], p[1] - p0[1] - q[1] + q0[1]);
			if (t < k)
				first[n_first++] = e;
			if (t >= n - k)
				last[n_last++] = e;
		}
	}
	s->points = (int)m;
	s->skin = spread_of(count, moved);
	s->skin_place = spread_of(count, place);
	s->skin_first = spread_of(n_first, first);
	s->skin_last = spread_of(n_last, last);
	s->skin_seen = sight ? (double)count / (double)sight : NAN;
	free(moved);
	free(place);
	free(first);
	free(last);
	free(at.x);
	free(visible.x);
	free(row.x);
}

/* Angle of the head's motion since the reference that is not the truth's. */
static void score_head(struct track_score *s, const struct found *f)
{
	struct array R = truth(f, "head_R", 0);
	double *e = mem_new((size_t)f->n + 1, sizeof *e);
	for (long t = 0; t < f->n && R.x; t++) {
		double trace = 0;
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++) {
				double a = 0, b = 0;
				for (int k = 0; k < 3; k++) {
					a += f->head.x[16 * t + 4 * i + k] * f->head.x[16 * f->reference + 4 * j + k];
					b += R.x[9 * t + 3 * i + k] * R.x[9 * f->reference + 3 * j + k];
				}
				trace += a * b;
			}
		e[t] = acos(fmin(1, fmax(-1, 0.5 * (trace - 1)))) * 180 / M_PI;
	}
	s->head_deg = spread_of(R.x ? f->n : 0, e).median;
	free(e);
	free(R.x);
}

/* Poses themselves, against the truth's. */
static void score_poses(struct track_score *s, const struct found *f)
{
	struct array R = truth(f, "head_R", 0), at = truth(f, "head_t", 0);
	double *turn = mem_new((size_t)f->n + 1, sizeof *turn), *off = mem_new((size_t)f->n + 1, sizeof *off), mid[3] = { 0 }, eye[3];
	const json_t *eyes = json_object_get(f->clip, "eye_centre_head_cm");
	struct err none = { 0 };
	long n = 0;
	for (int e = 0; e < 2; e++)
		for (int k = 0; k < 3 && json_get_array(eye, 3, eyes, e ? "right" : "left", "truth", &none); k++)
			mid[k] += 10 * eye[k] / 2;
	for (long t = 0; t < f->n && R.x && at.x; t++) {
		const double *m = f->head.x + 16 * t, *r = R.x + 9 * t;
		double trace = 0, square = 0;
		for (int i = 0; i < 3; i++) {
			double d = m[4 * i + 3] - 10 * at.x[3 * t + i];
			for (int k = 0; k < 3; k++) {
				trace += m[4 * i + k] * r[3 * i + k];
				d += (m[4 * i + k] - r[3 * i + k]) * mid[k];
			}
			square += d * d;
		}
		s->yaw = fmax(s->yaw, fabs(atan2(r[2], -r[8])) * 180 / M_PI);
		s->pitch = fmax(s->pitch, fabs(asin(fmin(1, fmax(-1, r[5])))) * 180 / M_PI);
		if (!isfinite(csv_at(&f->gaze, t, csv_column(&f->gaze, "head_h_deg"))))
			continue;
		turn[n] = acos(fmin(1, fmax(-1, 0.5 * (trace - 1)))) * 180 / M_PI;
		off[n++] = sqrt(square);
	}
	s->head_off = spread_of(n, turn);
	s->head_at = spread_of(n, off);
	free(turn);
	free(off);
	free(R.x);
	free(at.x);
}

static void score_gaze(struct track_score *s, const struct found *f)
{
	static const char *const sides[] = { "left", "right" };
	double *e[3], *off[2], *about[2];
	long n = 0, open = 0, have_about = 0;
	for (int k = 0; k < 2; k++)
		about[k] = mem_new(2 * (size_t)f->n + 1, sizeof *about[k]);
	for (int k = 0; k < 2; k++)
		off[k] = mem_new((size_t)f->n + 1, sizeof *off[k]);
	for (int k = 0; k < 3; k++)
		e[k] = mem_new(2 * (size_t)f->n + 1, sizeof *e[k]);
	for (int side = 0; side < 2; side++) {
		struct array gaze = truth(f, "gaze", side ? "right_deg" : "left_deg"), state = truth(f, "blink_state", 0), in = truth(f, "openness", sides[side]);
		long from = 0;
		// an eye that is out of the picture has a gaze, and no lids
		for (long t = 0; t < f->n && gaze.x && in.x; t++) {
			if (state.x[t] != 0)
				continue;
			open++;
			bool have = true;
			for (int k = 0; k < 3; k++) {
				char name[16];
				snprintf(name, sizeof name, "g%d_deg", 1 + k + 5 * side);
				double got = csv_at(&f->gaze, t, csv_column(&f->gaze, name));
				have = have && (isfinite(got) || k == 2);
				e[k][n] = fabs(got - gaze.x[3 * t + k]);
				if (k < 2 && have)
					off[k][from] = got - gaze.x[3 * t + k];
			}
			n += have;
			from += have;
		}
		for (int k = 0; k < 2; k++) {
			s->offset[side][k] = spread_of(from, off[k]).median;
			for (long t = 0; t < from; t++)
				about[k][have_about + t] = fabs(off[k][t] - s->offset[side][k]);
		}
		have_about += from;
		free(gaze.x);
		free(state.x);
		free(in.x);
	}
	for (int k = 0; k < 3; k++) {
		long m = 0;
		for (long i = 0; i < n; i++)
			if (isfinite(e[k][i]))
				e[k][m++] = e[k][i];
		s->gaze[k] = spread_of(m, e[k]);
		free(e[k]);
	}
	for (int k = 0; k < 2; k++) {
		s->about[k] = spread_of(have_about, about[k]);
		free(about[k]);
		free(off[k]);
	}
	s->gaze_share = open ? (double)n / (double)open : NAN;
}

/* Gaze as the camera sees it: Fick angles about its axes (x right, y up, towards it). */
static void against_camera(double fick[2], const double head[16], double h, double v)
{
	const double in_head[3] = { sin(h) * cos(v), sin(v), cos(h) * cos(v) };
	double seen[3] = { 0 };
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			seen[i] += head[4 * i + k] * in_head[k];
	fick[0] = atan2(seen[0], -seen[2]) * 180 / M_PI;
	fick[1] = asin(fmin(1, fmax(-1, -seen[1]))) * 180 / M_PI;
}

static void score_seen(struct track_score *s, const struct found *f)
{
	double *off[2], *ratio[2], degree = M_PI / 180;
	long n = 0;
	for (int k = 0; k < 2; k++) {
		off[k] = mem_new(2 * (size_t)f->n + 1, sizeof *off[k]);
		ratio[k] = mem_new(2 * (size_t)f->n + 1, sizeof *ratio[k]);
	}
	for (int side = 0; side < 2; side++) {
		struct array gaze = truth(f, "gaze_cam", side ? "right_deg" : "left_deg"), turned = truth(f, "gaze", side ? "right_deg" : "left_deg"), state = truth(f, "blink_state", 0);
		const int g = side ? 6 : 1;
		for (long t = 0; t < f->n && gaze.x && turned.x && state.x; t++) {
			double got[2], sigma[2], fick[2];
			for (int k = 0; k < 2; k++) {
				char name[24];
				snprintf(name, sizeof name, "g%d_deg", g + k);
				got[k] = csv_at(&f->gaze, t, csv_column(&f->gaze, name));
				snprintf(name, sizeof name, "sigma_g%d_deg", g + k);
				sigma[k] = csv_at(&f->gaze, t, csv_column(&f->gaze, name));
			}
			if (state.x[t] != 0 || !isfinite(got[0] + got[1] + sigma[0] + sigma[1]))
				continue;
			against_camera(fick, f->head.x + 16 * t, got[0] * degree, got[1] * degree);
			for (int k = 0; k < 2; k++) {
				off[k][n] = fabs(fick[k] - gaze.x[2 * t + k]);
				ratio[k][n] = fabs(got[k] - turned.x[3 * t + k]) / sigma[k];
			}
			n++;
		}
		free(gaze.x);
		free(turned.x);
		free(state.x);
	}
	for (int k = 0; k < 2; k++) {
		s->seen[k] = spread_of(n, off[k]);
		s->ratio[k] = spread_of(n, ratio[k]);
		free(off[k]);
		free(ratio[k]);
	}
}

/* Distance of a point from a margin: its control points are joined by a Catmull-Rom spline. NAN where it has none. */
static double off_margin(const double *lid, long m, const double p[2])
{
	enum { PARTS = 6 };
	double best = INFINITY, a[2] = { lid[0], lid[1] };
	for (long i = 0; i + 1 < m; i++) {
		const double *q[4] = { lid + 2 * (i ? i - 1 : 0), lid + 2 * i, lid + 2 * (i + 1), lid + 2 * (i + 2 < m ? i + 2 : m - 1) };
		for (int part = 1; part <= PARTS; part++) {
			double t = (double)part / PARTS, b[2], along = 0, length = 0;
			for (int k = 0; k < 2; k++)
				b[k] = 0.5 * (2 * q[1][k] + (q[2][k] - q[0][k]) * t + (2 * q[0][k] - 5 * q[1][k] + 4 * q[2][k] - q[3][k]) * t * t
				              + (3 * q[1][k] - q[0][k] - 3 * q[2][k] + q[3][k]) * t * t * t);
			for (int k = 0; k < 2; k++) {
				along += (p[k] - a[k]) * (b[k] - a[k]);
				length += (b[k] - a[k]) * (b[k] - a[k]);
			}
			double u = fmin(1, fmax(0, along / fmax(length, 1e-12)));
			best = fmin(best, hypot(p[0] - a[0] - u * (b[0] - a[0]), p[1] - a[1] - u * (b[1] - a[1])));
			a[0] = b[0];
			a[1] = b[1];
		}
	}
	return isfinite(lid[0]) && isfinite(lid[2 * m - 1]) ? best : NAN;
}

static void score_lids(struct track_score *s, const struct found *f)
{
	static const char *const sides[] = { "left", "right" }, *const px[] = { "lid_upper_px", "lid_lower_px" };
	static const char *const sight[] = { "lid_upper_visible", "lid_lower_visible" };
	double *e = mem_new((size_t)f->n * 4 * 32 + 1, sizeof *e);
	long n = 0, frames = 0, have = 0, m = f->lids.shape[2];
	for (int lid = 0; lid < 4; lid++) {
		struct array at = truth(f, px[lid % 2], sides[lid / 2]), visible = truth(f, sight[lid % 2], sides[lid / 2]);
		for (long t = 0; t < f->n && at.x; t++) {
			const double *margin = f->lids.x + 2 * m * (4 * t + lid);
			int seen = 0;
			for (long i = 0; i < at.shape[1]; i++) {
				bool there = !visible.x || visible.x[t * at.shape[1] + i] > 0;  // a truth without it: all of the face is in the picture
				double d = there ? off_margin(margin, m, at.x + 2 * (t * at.shape[1] + i)) : NAN;
				seen += there;
				if (isfinite(d))
					e[n++] = d;
			}
			frames += seen > 0;
			have += seen > 0 && isfinite(margin[0]);
		}
		free(at.x);
		free(visible.x);
	}
	s->lid = spread_of(n, e);
	s->lid_share = frames ? (double)have / (double)frames : NAN;
	free(e);
}

static void score_aperture(struct track_score *s, const struct found *f)
{
	static const char *const sides[] = { "left", "right" };
	double *e = mem_new(2 * (size_t)f->n + 1, sizeof *e);
	long n = 0;
	for (int side = 0; side < 2; side++) {
		struct array up = truth(f, "lid_upper_px", sides[side]), low = truth(f, "lid_lower_px", sides[side]);
		int a = csv_column(&f->gaze, side ? "g9_px" : "g4_px"), b = csv_column(&f->gaze, side ? "g10_px" : "g5_px");
		for (long t = 0; t < f->n && up.x && low.x; t++) {
			const double *u = up.x + 2 * (t * up.shape[1] + up.shape[1] / 2), *l = low.x + 2 * (t * low.shape[1] + low.shape[1] / 2);
			double d = f->scale * (csv_at(&f->gaze, t, a) + csv_at(&f->gaze, t, b)) - (l[1] - u[1]);
			if (isfinite(d))
				e[n++] = fabs(d);
		}
		free(up.x);
		free(low.x);
	}
	s->aperture = spread_of(n, e);
	free(e);
}

static void score_blinks(struct track_score *s, const struct found *f)
{
	const json_t *real = json_object_get(json_object_get(f->clip, "intervals_s"), "blinks"), *got = json_object_get(f->track, "blinks");
	double fps = json_number_value(json_object_get(f->clip, "fps"));
	bool hit[64] = { 0 };
	double begun = (double)f->first / fps;
	for (size_t k = 0; k < json_array_size(real); k++) {
		double start = json_number_value(json_object_get(json_array_get(real, k), "start"));
		s->blinks += start > begun && start < (double)(f->first + f->n) / fps;
	}
	for (size_t i = 0; i < json_array_size(got); i++) {
		double at = json_number_value(json_object_get(json_array_get(got, i), "peak")) / fps;
		bool right = false;
		for (int k = 0; k < (int)json_array_size(real) && k < 64; k++) {
			double start = json_number_value(json_object_get(json_array_get(real, (size_t)k), "start")) - begun;
			if (at >= start - 0.02 && at <= start + blink_s)
				right = true, hit[k] = start > 0;
		}
		s->wrong += !right;
	}
	for (int k = 0; k < 64; k++)
		s->found += hit[k];
}

bool track_score(struct track_score *s, const char *dir, const char *truth, struct err *err)
{
	return track_score_from(s, dir, truth, 0, err);
}

bool track_score_from(struct track_score *s, const char *dir, const char *truth_dir, long first, struct err *err)
{
	struct found f = { .dir = dir, .truth = truth_dir, .first = first };
	*s = (struct track_score){ 0 };
	bool ok = load(&f, err);
	if (ok) {
		s->frames = f.n;
		score_skin(s, &f);
		score_head(s, &f);
		score_poses(s, &f);
		score_gaze(s, &f);
		score_seen(s, &f);
		score_lids(s, &f);
		score_aperture(s, &f);
		score_blinks(s, &f);
	}
	free(f.skin.x);
	free(f.seen.x);
	free(f.vertex.x);
	free(f.head.x);
	free(f.lids.x);
	csv_table_free(&f.gaze);
	json_decref(f.track);
	json_decref(f.clip);
	return ok;
}
