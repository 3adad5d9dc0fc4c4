/* low_lid TRUTH MESH: how much of a filmed person's own iris and pupil lies under the lower lid, by a rendered clip's truth (samples/face/truth): of frames without a blink a
 * line a frame and eye, as tools/lids.c says it of a character: h_deg,v_deg,side,iris_low,pupil_low; frame, and what is open between the margins, px^2. Pupil: 2 mm in radius. The camera looks straight at the head, which
 * rests: where it stands is found from the skin's points. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "math/chol.h"
#include "math/vec.h"
#include "mesh/mesh_clean.h"
#include "track/gaze/globe.h"

enum { UPPER = 20, LOWER = 24 };  // points of an upper and a lower margin, samples/README.md

static double *array(long *rows, const char *folder, const char *name, int columns, struct err *err)
{
	char path[4096];
	struct npy a;
	snprintf(path, sizeof path, "%s/truth.npz", folder);
	if (!npz_read(&a, path, name, NPY_LIMIT, err))
		return 0;
	double *out = npy_doubles(&a);
	*rows = a.shape[0];
	if (npy_count(&a) % ((long)columns * *rows))
		err_set(err, "%s: %s: not %d columns", path, name, columns);
	npy_free(&a);
	return out;
}

struct filmed {
	double focal, middle[2], t[3];   // px; the head's origin before the camera, cm
	double center[2][3], limbus, plane;  // cm, the head's axes: x to the person's left, y up, z out of the face
};

static double number(const json_t *of, const char *key)
{
	return json_number_value(json_object_get(of, key));
}

static bool take_json(struct filmed *f, const char *folder, struct err *err)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/truth.json", folder);
	json_t *says = json_read(path, 1 << 20, err);
	if (!says)
		return false;
	const json_t *K = json_object_get(says, "K"), *centers = json_object_get(says, "eye_centre_head_cm"), *cornea = json_object_get(says, "cornea");
	f->focal = json_number_value(json_array_get(json_array_get(K, 0), 0));
	for (size_t k = 0; k < 2; k++)
		f->middle[k] = json_number_value(json_array_get(json_array_get(K, k), 2));
	for (size_t c = 0; c < 3; c++) {
		f->center[0][c] = json_number_value(json_array_get(json_object_get(centers, "left"), c));
		f->center[1][c] = json_number_value(json_array_get(json_object_get(centers, "right"), c));
	}
	f->limbus = number(cornea, "limbus_radius_cm");
	f->plane = number(cornea, "limbus_plane_cm");
	json_decref(says);
	return true;
}

static void pixel(double px[2], const struct filmed *f, const double head[3])
{
	const double z = f->t[2] - head[2];
	px[0] = f->middle[0] + f->focal * (head[0] + f->t[0]) / z;
	px[1] = f->middle[1] + f->focal * (f->t[1] - head[1]) / z;
}

/* Least squares of f (x + tx) = (u - cx) (tz - z), and of y. Returns the root mean square of what is left, px. */
static double place(struct filmed *f, long n, const double *vertex, const double *px, const double *seen, const struct mesh *mesh)
{
	double a[9] = { 0 }, b[3] = { 0 }, sum = 0;
	long count = 0;
	for (long i = 0; i < n; i++)
		for (int k = 0; k < 2 && seen[i] > 0; k++) {
			const float *x = mesh->vertices[(long)vertex[i]];
			const double at = px[2 * i + k] - f->middle[k], row[3] = { k ? 0 : f->focal, k ? f->focal : 0, -at }, right = (k ? f->focal * (double)x[1] : -f->focal * (double)x[0]) - at * (double)x[2];
			for (int r = 0; r < 3; r++) {
				b[r] += row[r] * right;
				for (int c = 0; c < 3; c++)
					a[3 * r + c] += row[r] * row[c];
			}
		}
	if (!chol_solve(3, 3, a, b))
		return INFINITY;
	for (int k = 0; k < 3; k++)
		f->t[k] = b[k];
	for (long i = 0; i < n; i++) {
		const float *x = mesh->vertices[(long)vertex[i]];
		double at[2];
		pixel(at, f, (double[]){ (double)x[0], (double)x[1], (double)x[2] });
		sum += seen[i] > 0 ? pow(hypot(at[0] - px[2 * i], at[1] - px[2 * i + 1]), 2) : 0;
		count += seen[i] > 0;
	}
	return sqrt(sum / (double)count);
}

/* Height of the margin at x; beyond its ends as at them. */
static double margin_at(const double *px, long n, double x)
{
	const int rising = px[2 * (n - 1)] > px[0] ? 1 : -1;
	long i = 0;
	while (i < n - 2 && rising * (px[2 * (i + 1)] - x) < 0)
		i++;
	const double t = fmin(fmax((x - px[2 * i]) / (px[2 * (i + 1)] - px[2 * i]), 0), 1);
	return px[2 * i + 1] + t * (px[2 * (i + 1) + 1] - px[2 * i + 1]);
}

/* Area between an upper and a lower margin, px^2. */
static double between(const double *upper, const double *lower)
{
	double twice = 0, outline[2 * (UPPER + LOWER)];
	for (int i = 0; i < UPPER + LOWER; i++)
		for (int k = 0; k < 2; k++)
			outline[2 * i + k] = i < UPPER ? upper[2 * i + k] : lower[2 * (UPPER + LOWER - 1 - i) + k];
	for (int i = 0; i < UPPER + LOWER; i++) {
		const double *a = outline + 2 * i, *b = outline + 2 * ((i + 1) % (UPPER + LOWER));
		twice += a[0] * b[1] - a[1] * b[0];
	}
	return fabs(twice) / 2;
}

static double under(const struct filmed *f, int side, const double gaze_deg[3], double radius, const double *lower, long points)
{
	double turn[3][3], below = 0, all = 0;
	gaze_rotation(turn, (double[]){ gaze_deg[0] * M_PI / 180, gaze_deg[1] * M_PI / 180, 0 });
	for (int ring = 1; ring <= 12; ring++)
		for (int k = 0; k < 60; k++) {
			const double r = radius * ring / 12, a = 2 * M_PI * k / 60;
			double head[3], px[2];
			mat_vec(head, turn, (double[]){ r * cos(a), r * sin(a), f->plane });
			vec_add(head, head, 1, f->center[side]);
			pixel(px, f, head);
			below += px[1] > margin_at(lower, points, px[0]) ? r : 0;
			all += r;
		}
	return below / all;
}

int main(int argc, char **argv)
{
	struct filmed f = { 0 };
	struct mesh mesh = { 0 };
	struct err err = { 0 };
	char *data = 0;
	size_t size;
	long frames = 0, points = 0, n;
	if (argc < 3) {
		fprintf(stderr, "low_lid: TRUTH MESH\n");
		return 2;
	}
	double *vertex = array(&points, argv[1], "skin_vertex", 1, &err), *px = array(&frames, argv[1], "skin_px", 2, &err), *seen = array(&frames, argv[1], "skin_visible", 1, &err);
	double *gaze[2] = { array(&frames, argv[1], "gaze_left_deg", 3, &err), array(&frames, argv[1], "gaze_right_deg", 3, &err) };
	double *shut = array(&n, argv[1], "blink_closure", 1, &err);
	double *upper[2] = { array(&n, argv[1], "lid_upper_px_left", 2, &err), array(&n, argv[1], "lid_upper_px_right", 2, &err) };
	double *lower[2] = { array(&n, argv[1], "lid_lower_px_left", 2, &err), array(&n, argv[1], "lid_lower_px_right", 2, &err) };
	bool ok = !err_is(&err) && take_json(&f, argv[1], &err) && file_read(&data, &size, argv[2], 1 << 26, &err) && mesh_clean(&mesh, data, size, 1000000, &err);
	for (long i = 0; i < points && ok; i++)
		ok = vertex[i] < mesh.n_vertices || err_set(&err, "%s: no vertex %g", argv[2], vertex[i]);
	const double off = ok ? place(&f, points, vertex, px, seen, &mesh) : 0;
	if (ok && !(off < 2))
		ok = err_set(&err, "%s: the head does not look straight at its camera: points are %.2f px off", argv[1], off);
	if (ok)
		puts("h_deg,v_deg,side,iris_low,pupil_low,frame,open_px2");
	else
		fprintf(stderr, "low_lid: %s\n", err.msg);
	for (long i = 0; i < frames && ok; i++)
		for (int side = 0; side < 2 && shut[i] < 0.01; side++) {
			const double *g = gaze[side] + 3 * i, *low = lower[side] + 2L * LOWER * i;
			printf("%.2f,%.2f,%d,%.3f,%.3f,%ld,%.0f\n", g[0], g[1], side, under(&f, side, g, f.limbus, low, LOWER), under(&f, side, g, 0.2, low, LOWER), i, between(upper[side] + 2L * UPPER * i, low));
		}
	free(data);
	free(vertex);
	free(px);
	free(seen);
	free(shut);
	for (int side = 0; side < 2; side++) {
		free(gaze[side]);
		free(lower[side]);
		free(upper[side]);
	}
	mesh_free(&mesh);
	return !ok || fflush(stdout) != 0;
}
