#include "tests/lib/scenes/sfm_scene.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"

void sfm_quaternion(double q[4], const double R[3][3])
{
	// The largest of the four is found first: the others divide by it.
	double trace = R[0][0] + R[1][1] + R[2][2], four[4] = { trace, 2 * R[0][0] - trace, 2 * R[1][1] - trace, 2 * R[2][2] - trace };
	int k = 0;
	for (int i = 1; i < 4; i++)
		k = four[i] > four[k] ? i : k;
	double s = 2 * sqrt(1 + four[k]);
	q[k] = s / 4;
	if (k == 0) {
		q[1] = (R[2][1] - R[1][2]) / s;
		q[2] = (R[0][2] - R[2][0]) / s;
		q[3] = (R[1][0] - R[0][1]) / s;
	} else {
		int a = k - 1, b = (a + 1) % 3, c = (a + 2) % 3;
		q[0] = (R[c][b] - R[b][c]) / s;
		q[1 + b] = (R[a][b] + R[b][a]) / s;
		q[1 + c] = (R[a][c] + R[c][a]) / s;
	}
	for (int i = 0; i < 4 && q[0] < 0; i++)
		q[i] = i ? -q[i] : q[i];
	q[0] = fabs(q[0]);
}

/* Looks from (5 cos a, h, 5 sin a) at the origin, x to the right of the viewer, y down. */
static void place(struct colmap_image *im, double R[3][3], double angle, double height)
{
	double centre[3] = { 5 * cos(angle), height, 5 * sin(angle) }, down[3] = { 0, -1, 0 };
	for (int i = 0; i < 3; i++)
		R[2][i] = -centre[i];
	vec_unit(R[2], R[2]);
	vec_cross(R[0], down, R[2]);
	vec_unit(R[0], R[0]);
	vec_cross(R[1], R[2], R[0]);
	for (int i = 0; i < 3; i++)
		im->t[i] = -vec_dot(R[i], centre);
	sfm_quaternion(im->q, R);
}

static void see(struct colmap_model *m, int i, const double R[3][3], struct rng *rng)
{
	const double *k = m->cameras[0].params;
	for (int p = 0; p < m->n_points; p++) {
		struct colmap_point *point = &m->points[p];
		double c[3], got[2];
		mat_vec(c, R, point->xyz);
		for (int a = 0; a < 3; a++)
			c[a] += m->images[i].t[a];
		double x = c[0] / c[2], y = c[1] / c[2], g = 1 + k[3] * (x * x + y * y);
		double u[2] = { k[0] * x * g + k[1], k[0] * y * g + k[2] };
		struct colmap_seen *seen = &m->images[i].seen[p];
		for (int a = 0; a < 2; a++)
			got[a] = seen->px[a] = u[a] + 0.3 * rng_normal(rng);
		seen->point = p;
		point->track[i] = (struct colmap_track){ i, p };
		point->error += hypot(got[0] - u[0], got[1] - u[1]) / m->n_images;
	}
}

void sfm_scene(struct colmap_model *m, int n_images, int n_points, unsigned seed)
{
	struct rng rng = { seed };
	*m = (struct colmap_model){ mem_new(1, sizeof *m->cameras), mem_new((size_t)n_images, sizeof *m->images),
		                    mem_new((size_t)n_points, sizeof *m->points), 1, n_images, n_points };
	m->cameras[0] = (struct colmap_camera){ 1, COLMAP_SIMPLE_RADIAL, 1000, 800, { 1200, 500, 400, -0.05 } };
	for (int p = 0; p < n_points; p++) {
		struct colmap_point *point = &m->points[p];
		*point = (struct colmap_point){ .id = (uint64_t)p + 1, .rgb = { (uint8_t)p, 100, 200 }, .n_track = n_images,
			                        .track = mem_new((size_t)n_images, sizeof *point->track) };
		do
			for (int a = 0; a < 3; a++)
				point->xyz[a] = rng_range(&rng, -1, 1);
		while (vec_norm(point->xyz) > 1);
	}
	for (int i = 0; i < n_images; i++) {
		struct colmap_image *im = &m->images[i];
		double R[3][3];
		im->id = (uint32_t)i + 1;
		im->name = mem_printf("view_%d.jpg", i);
		im->n_seen = n_points;
		im->seen = mem_new((size_t)n_points, sizeof *im->seen);
		place(im, R, 2 * M_PI * i / n_images, 1 + 0.5 * (i % 3));
		see(m, i, R, &rng);
	}
}

bool sfm_same(const struct colmap_model *a, const struct colmap_model *b, double slack)
{
	if (a->n_cameras != b->n_cameras || a->n_images != b->n_images || a->n_points != b->n_points)
		return false;
	bool ok = true;
	for (int i = 0; i < a->n_cameras; i++)
		ok &= a->cameras[i].id == b->cameras[i].id && a->cameras[i].kind == b->cameras[i].kind
		      && a->cameras[i].width == b->cameras[i].width && a->cameras[i].height == b->cameras[i].height
		      && !memcmp(a->cameras[i].params, b->cameras[i].params, sizeof a->cameras[i].params);
	for (int i = 0; i < a->n_images; i++) {
		const struct colmap_image *p = &a->images[i], *q = &b->images[i];
		ok &= p->id == q->id && !strcmp(p->name, q->name) && p->camera == q->camera && p->n_seen == q->n_seen;
		for (int k = 0; k < 4; k++)
			ok &= fabs(p->q[k] - q->q[k]) <= slack;
		for (int k = 0; k < 3; k++)
			ok &= fabs(p->t[k] - q->t[k]) <= slack;
		for (int k = 0; ok && k < p->n_seen; k++)
			ok &= p->seen[k].point == q->seen[k].point && fabs(p->seen[k].px[0] - q->seen[k].px[0]) <= 1e3 * slack
			      && fabs(p->seen[k].px[1] - q->seen[k].px[1]) <= 1e3 * slack;
	}
	for (int i = 0; ok && i < a->n_points; i++) {
		const struct colmap_point *p = &a->points[i], *q = &b->points[i];
		ok &= p->id == q->id && p->n_track == q->n_track && !memcmp(p->rgb, q->rgb, 3) && fabs(p->error - q->error) <= slack;
		for (int k = 0; k < 3; k++)
			ok &= fabs(p->xyz[k] - q->xyz[k]) <= slack;
		for (int k = 0; ok && k < p->n_track; k++)
			ok &= p->track[k].image == q->track[k].image && p->track[k].seen == q->track[k].seen;
	}
	return ok;
}
