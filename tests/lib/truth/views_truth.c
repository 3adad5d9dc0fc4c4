#include "tests/lib/truth/views_truth.h"

#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "math/vec.h"

/* M = K R by Gram and Schmidt from the last row up; K's diagonal positive, its last entry 1. */
static void decompose(struct views_camera *c, const double M[3][3])
{
	double q[3][3] = { 0 }, K[3][3] = { 0 };
	for (int i = 2; i >= 0; i--) {
		memcpy(q[i], M[i], sizeof q[i]);
		for (int j = 2; j > i; j--) {
			K[i][j] = vec_dot(M[i], q[j]);
			vec_add(q[i], q[i], -K[i][j], q[j]);
		}
		K[i][i] = vec_norm(q[i]);
		vec_unit(q[i], q[i]);
	}
	for (int i = 0; i < 9; i++)
		c->K[i / 3][i % 3] = K[i / 3][i % 3] / K[2][2];
	memcpy(c->R, q, sizeof q);
}

static bool read_one(struct views_camera *c, const char *path)
{
	double p[12], det;
	FILE *f = fopen(path, "r");
	bool ok = f;
	for (int i = 0; i < 12 && ok; i++)
		ok = fscanf(f, "%lf", &p[i]) == 1;
	if (f)
		fclose(f);
	if (!ok)
		return false;
	double M[3][3], col[3][3], b[3] = { -p[3], -p[7], -p[11] }, cross[3];
	for (int i = 0; i < 9; i++)
		M[i / 3][i % 3] = p[i / 3 * 4 + i % 3];
	vec_cross(cross, M[1], M[2]);
	det = vec_dot(M[0], cross);
	for (int i = 0; i < 9; i++)
		M[i / 3][i % 3] *= det < 0 ? -1 : 1;
	for (int i = 0; i < 3; i++)
		b[i] *= det < 0 ? -1 : 1;
	decompose(c, M);
	// M center = b: Cramer, rows' cross products are the columns of the adjugate.
	for (int i = 0; i < 3; i++)
		vec_cross(col[i], M[(i + 1) % 3], M[(i + 2) % 3]);
	for (int k = 0; k < 3; k++)
		c->center[k] = (col[0][k] * b[0] + col[1][k] * b[1] + col[2][k] * b[2]) / fabs(det);
	return true;
}

static bool read_camera(struct views_camera *c, const char *path)
{
	double v[24];
	FILE *f = fopen(path, "r");
	bool ok = f;
	for (int i = 0; i < 24 && ok; i++)
		ok = fscanf(f, "%lf", &v[i]) == 1;
	if (f)
		fclose(f);
	for (int i = 0; i < 9 && ok; i++) {
		c->K[i / 3][i % 3] = v[i];
		c->R[i % 3][i / 3] = v[12 + i];
		c->center[i % 3] = v[21 + i % 3];
	}
	return ok;
}

/* All files of a folder with that ending. */
static bool load_all(struct views_truth *truth, const char *folder, const char *ending,
                     bool read(struct views_camera *c, const char *path), struct err *err)
{
	struct file_list list;
	*truth = (struct views_truth){ 0 };
	bool ok = file_list(&list, folder, err);
	truth->c = mem_new((size_t)list.n, sizeof *truth->c);
	for (int i = 0; i < list.n; i++) {
		char *path = mem_printf("%s/%s", folder, list.names[i]), *tail = strstr(list.names[i], ending);
		struct views_camera *c = &truth->c[truth->n];
		if (tail && read(c, path)) {
			snprintf(c->name, sizeof c->name, "%.*s", (int)(tail - list.names[i]), list.names[i]);
			truth->n++;
		}
		free(path);
	}
	file_list_free(&list);
	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (int i = 0; i < truth->n; i++) {
			low = fmin(low, truth->c[i].center[k]);
			high = fmax(high, truth->c[i].center[k]);
		}
		truth->extent = fmax(truth->extent, high - low);
	}
	return ok && (truth->n || err_set(err, "%s: no cameras", folder));
}

bool views_truth_load(struct views_truth *truth, const char *dir, struct err *err)
{
	char *folder = mem_printf("%s/P", dir);
	bool ok = load_all(truth, folder, "_P.txt", read_one, err);
	free(folder);
	return ok;
}

bool views_truth_load_cameras(struct views_truth *truth, const char *dir, struct err *err)
{
	return load_all(truth, dir, ".jpg.camera", read_camera, err);
}

void views_truth_free(struct views_truth *truth)
{
	free(truth->c);
	*truth = (struct views_truth){ 0 };
}

static void center_of(double c[3], const struct rig_camera *cam)
{
	const double (*m)[4] = cam->cam_from_head;
	for (int i = 0; i < 3; i++)
		c[i] = -(m[0][i] * m[0][3] + m[1][i] * m[1][3] + m[2][i] * m[2][3]);
}

/* Pairs of centres; n of them. */
static int match(double (*a)[3], double (*b)[3], const struct views_truth *truth, const struct camera_rig *rig)
{
	int n = 0;
	for (int i = 0; i < truth->n; i++)
		for (int k = 0; k < rig->n; k++)
			if (!strcmp(truth->c[i].name, rig->cameras[k].name) && rig->cameras[k].has_pose) {
				center_of(a[n], &rig->cameras[k]);
				memcpy(b[n++], truth->c[i].center, sizeof *b);
			}
	return n;
}

/* Rotation and scale from the covariance of centred points. */
static void umeyama(struct views_fit *fit, const double S[3][3], double variance)
{
	double s[9], sv[3], U[9], Vt[9], work[3];
	for (int i = 0; i < 9; i++)
		s[i] = S[i / 3][i % 3];
	LAPACKE_dgesvd(LAPACK_ROW_MAJOR, 'A', 'A', 3, 3, s, 3, sv, U, 3, Vt, 3, work);
	double u[3][3], v[3][3], R[3][3], cross[3];
	memcpy(u, U, sizeof u);
	memcpy(v, Vt, sizeof v);
	mat_mul(R, u, v);
	vec_cross(cross, R[0], R[1]);
	double sign = vec_dot(cross, R[2]) < 0 ? -1 : 1;
	for (int i = 0; i < 3; i++)
		u[i][2] *= sign;
	mat_mul(fit->R, u, v);
	fit->scale = (sv[0] + sv[1] + sign * sv[2]) / variance;
}

bool views_fit(struct views_fit *fit, const struct views_truth *truth, const struct camera_rig *rig)
{
	double (*a)[3] = mem_new((size_t)truth->n, sizeof *a), (*b)[3] = mem_new((size_t)truth->n, sizeof *b);
	double ma[3] = { 0 }, mb[3] = { 0 }, S[3][3] = { 0 }, variance = 0;
	int n = match(a, b, truth, rig);
	*fit = (struct views_fit){ .n = n, .mean = NAN, .worst = NAN };
	for (int i = 0; i < n; i++) {
		vec_add(ma, ma, 1.0 / n, a[i]);
		vec_add(mb, mb, 1.0 / n, b[i]);
	}
	for (int i = 0; i < n; i++)
		for (int r = 0; r < 3; r++) {
			for (int c = 0; c < 3; c++)
				S[r][c] += (b[i][r] - mb[r]) * (a[i][c] - ma[c]);
			variance += (a[i][r] - ma[r]) * (a[i][r] - ma[r]);
		}
	if (n >= 3) {
		double moved[3];
		umeyama(fit, S, variance);
		mat_vec(moved, fit->R, ma);
		vec_add(fit->t, mb, -fit->scale, moved);
		fit->mean = fit->worst = 0;
	}
	for (int i = 0; i < n && n >= 3; i++) {
		double p[3], d[3];
		views_to_truth(p, fit, a[i]);
		vec_add(d, p, -1, b[i]);
		fit->mean += vec_norm(d) / n;
		fit->worst = fmax(fit->worst, vec_norm(d));
	}
	free(a);
	free(b);
	return n >= 3;
}

void views_to_truth(double out[3], const struct views_fit *fit, const double head[3])
{
	double p[3];
	mat_vec(p, fit->R, head);
	vec_add(out, fit->t, fit->scale, p);
}
