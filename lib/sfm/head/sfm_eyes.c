#include "sfm/head/sfm_eyes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

bool sfm_project(double px[2], double *focal, const struct colmap_model *m, int image, const double xyz[3])
{
	const struct colmap_image *im = &m->images[image];
	struct camera camera;
	struct err none = { 0 };
	double f[2], R[3][3], p[3];
	if (!colmap_to_camera(&camera, f, &m->cameras[im->camera], &none))
		return false;
	colmap_rotation(R, im->q);
	mat_vec(p, R, xyz);
	vec_add(p, p, 1, im->t);
	*focal = sqrt(f[0] * f[1]) / p[2];
	return p[2] > 0 && camera_project(px, &camera, p);
}

/* Distance of a face's eyes, px. */
static double apart_in(const struct sfm_face *f)
{
	return hypot(f->eye[0][0] - f->eye[1][0], f->eye[0][1] - f->eye[1][1]);
}

/* Reprojection error of the worse eye, as a share of the distance of that face's eyes. */
static double off(const struct colmap_model *m, const struct sfm_face *f, const double eye[2][3])
{
	double worst = 0, apart = apart_in(f);
	for (int e = 0; e < 2; e++) {
		double px[2], focal;
		if (!sfm_project(px, &focal, m, f->image, eye[e]))
			return INFINITY;
		worst = fmax(worst, hypot(px[0] - f->eye[e][0], px[1] - f->eye[e][1]));
	}
	return worst / apart;
}

/* Counts the pictures that agree (inliers) and sums their errors. Of two faces in one picture the nearer one counts. */
static int vote(bool *agrees, double *sum, const struct colmap_model *m, int n, const struct sfm_face faces[], const double eye[2][3],
                double near)
{
	int votes = 0;
	double own = INFINITY;
	*sum = 0;
	for (int i = 0, first = 0, best = -1; i < n; i++) {
		if (i && faces[i].image != faces[i - 1].image) {
			first = i;
			best = -1;
		}
		double d = off(m, &faces[i], eye);
		agrees[i] = d <= near && (best < first || d < own);
		if (!agrees[i])
			continue;
		if (best >= first) {
			agrees[best] = false;
			*sum -= own;
			votes--;
		}
		best = i;
		own = d;
		*sum += d;
		votes++;
	}
	return votes;
}

/* Triangulates a point from the faces that agree: which 0, 1: an eye; 2: the mouth. */
static bool point(double xyz[3], double *sigma, const struct colmap_model *m, int n, const struct sfm_face faces[], const bool *agrees,
                  int which)
{
	struct sfm_sight *sights = mem_array((size_t)n + 1, sizeof *sights);
	struct err none = { 0 };
	int k = 0;
	for (int i = 0; i < n; i++)
		if (agrees[i]) {
			sights[k].image = faces[i].image;
			memcpy(sights[k++].px, which < 2 ? faces[i].eye[which] : faces[i].mouth, sizeof sights->px);
		}
	bool ok = sfm_triangulate(xyz, sigma, m, k, sights, 0.5, &none);
	free(sights);
	return ok;
}

static bool eyes_from(double eye[2][3], double sigma[2], const struct colmap_model *m, int n, const struct sfm_face faces[],
                      const bool *agrees)
{
	return point(eye[0], &sigma[0], m, n, faces, agrees, 0) && point(eye[1], &sigma[1], m, n, faces, agrees, 1);
}

static double apart(const double eye[2][3])
{
	double d[3];
	vec_add(d, eye[0], -1, eye[1]);
	return vec_norm(d);
}

/* Marks the faces whose detected mouth lies within `near` of that point's projection; returns how many. */
static int mouth_votes(bool *seen, const struct colmap_model *m, int n, const struct sfm_face faces[], const bool *agrees, const double mouth[3],
                       double near)
{
	int votes = 0;
	for (int i = 0; i < n; i++) {
		const struct sfm_face *f = &faces[i];
		double px[2], focal, far = near * apart_in(f);
		seen[i] = agrees[i] && f->mouth_found && sfm_project(px, &focal, m, f->image, mouth)
		          && hypot(px[0] - f->mouth[0], px[1] - f->mouth[1]) <= far;
		votes += seen[i];
	}
	return votes;
}

/* The mouth by the same consensus: every two faces propose a point, the one with the most inliers is refined. Returns the number of
 * inliers, 0 where there are fewer than `least`. */
static int mouth_from(double mouth[3], const struct colmap_model *m, int n, const struct sfm_face faces[], const bool *agrees, int least,
                      double near)
{
	bool *seen = mem_new((size_t)n + 1, sizeof *seen);
	double unused, at[3];
	int most = 0;
	for (int i = 0; i < n; i++)
		for (int k = i + 1; k < n; k++) {
			if (!agrees[i] || !agrees[k] || !faces[i].mouth_found || !faces[k].mouth_found)
				continue;
			memset(seen, 0, (size_t)n * sizeof *seen);
			seen[i] = seen[k] = true;
			int votes = point(at, &unused, m, n, faces, seen, 2) ? mouth_votes(seen, m, n, faces, agrees, at, near) : 0;
			if (votes > most) {
				most = votes;
				memcpy(mouth, at, sizeof at);
			}
		}
	for (int round = 0; round < 3 && most >= least; round++) {
		most = mouth_votes(seen, m, n, faces, agrees, mouth, near);
		most = most >= least && point(mouth, &unused, m, n, faces, seen, 2) ? most : 0;
	}
	free(seen);
	return most >= least ? most : 0;
}

bool sfm_eyes(struct sfm_eyes *out, bool *agrees, const struct colmap_model *m, int n, const struct sfm_face faces[], int least,
              double near)
{
	double eye[2][3], best[2][3], sigma[2], sum, best_sum = 0;
	int most = 0;
	// Every two pictures propose a pair of points.
	for (int i = 0; i < n; i++)
		for (int k = i + 1; k < n; k++) {
			if (faces[i].image == faces[k].image)
				continue;
			memset(agrees, 0, (size_t)n * sizeof *agrees);
			agrees[i] = agrees[k] = true;
			if (!eyes_from(eye, sigma, m, n, faces, agrees))
				continue;
			int votes = vote(agrees, &sum, m, n, faces, eye, near);
			if (votes > most || (votes == most && sum < best_sum)) {
				most = votes;
				best_sum = sum;
				memcpy(best, eye, sizeof best);
			}
		}
	if (most < least)
		return false;
	for (int round = 0; round < 4; round++) {
		if (vote(agrees, &sum, m, n, faces, best, near) < least || !eyes_from(best, sigma, m, n, faces, agrees))
			return false;
	}
	double unused;
	memcpy(out->eye, best, sizeof best);
	out->n = vote(agrees, &sum, m, n, faces, best, near);
	out->sigma = fmax(sigma[0], sigma[1]) / apart(best);
	if (out->n < least || out->sigma >= near)
		return false;
	out->mouths = mouth_from(out->mouth, m, n, faces, agrees, least, near);
	return out->mouths || point(out->mouth, &unused, m, n, faces, agrees, 2);
}
