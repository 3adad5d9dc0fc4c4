#include <ctype.h>
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "sfm/colmap/parse_impl.h"

static bool finite_within(int n, const double *x, double limit)
{
	for (int i = 0; i < n; i++)
		if (!(fabs(x[i]) <= limit))
			return false;
	return true;
}

static bool check_camera(const struct colmap_camera *c, const char *where, struct err *err)
{
	int n = colmap_kind_params(c->kind);
	bool two = c->kind == COLMAP_PINHOLE || c->kind == COLMAP_OPENCV || c->kind == COLMAP_OPENCV_FISHEYE
	           || c->kind == COLMAP_FULL_OPENCV || c->kind == COLMAP_FOV || c->kind == COLMAP_THIN_PRISM_FISHEYE;
	if (c->width < 1 || c->height < 1)
		return err_set(err, "%s: camera %u: %d x %d pixels, must be positive", where, c->id, c->width, c->height);
	if (!finite_within(n, c->params, 1e9) || !(c->params[0] > 0) || (two && !(c->params[1] > 0)))
		return err_set(err, "%s: camera %u: a parameter is out of range", where, c->id);
	return true;
}

static bool check_image(struct colmap_image *im, const char *where, struct err *err)
{
	double norm = sqrt(im->q[0] * im->q[0] + im->q[1] * im->q[1] + im->q[2] * im->q[2] + im->q[3] * im->q[3]);
	if (!finite_within(4, im->q, 2) || !(fabs(norm - 1) < 1e-6))
		return err_set(err, "%s: image %u: its quaternion has length %g, must be 1", where, im->id, norm);
	if (!finite_within(3, im->t, 1e12))
		return err_set(err, "%s: image %u: its translation is out of range", where, im->id);
	if (!*im->name)
		return err_set(err, "%s: image %u has no name", where, im->id);
	for (const char *c = im->name; *c; c++)
		if (iscntrl((unsigned char)*c))
			return err_set(err, "%s: image %u: a control byte in its name", where, im->id);
	for (int k = 0; k < im->n_seen; k++)
		if (!finite_within(2, im->seen[k].px, 2e6))
			return err_set(err, "%s: image %u: observation %d is out of range", where, im->id, k);
	return true;
}

static bool check_point(const struct colmap_point *p, const char *where, struct err *err)
{
	if (!finite_within(3, p->xyz, 1e15) || !(p->error >= -1 && p->error < 1e9))
		return err_set(err, "%s: point %llu is out of range", where, (unsigned long long)p->id);
	return true;
}

struct order {
	uint64_t id;
	int index;
};

static int by_id(const void *a, const void *b)
{
	uint64_t x = ((const struct order *)a)->id, y = ((const struct order *)b)->id;
	return (x > y) - (x < y);
}

static int find(const struct order *orders, int n, uint64_t id)
{
	struct order key = { id, 0 }, *found = bsearch(&key, orders, (size_t)n, sizeof *orders, by_id);
	return found ? found->index : -1;
}

static bool sort_ids(struct order *orders, int n, const char *what, const char *where, struct err *err)
{
	qsort(orders, (size_t)n, sizeof *orders, by_id);
	for (int i = 1; i < n; i++)
		if (orders[i].id == orders[i - 1].id)
			return err_set(err, "%s: %s %llu stands there twice", where, what, (unsigned long long)orders[i].id);
	return true;
}

struct orders {
	struct order *cameras, *images, *points;
};

static bool order_all(struct orders *o, const struct colmap_model *m, const char *const where[3], struct err *err)
{
	o->cameras = mem_array((size_t)m->n_cameras, sizeof(struct order));
	o->images = mem_array((size_t)m->n_images, sizeof(struct order));
	o->points = mem_array((size_t)m->n_points, sizeof(struct order));
	for (int i = 0; i < m->n_cameras; i++)
		o->cameras[i] = (struct order){ m->cameras[i].id, i };
	for (int i = 0; i < m->n_images; i++)
		o->images[i] = (struct order){ m->images[i].id, i };
	for (int i = 0; i < m->n_points; i++)
		o->points[i] = (struct order){ m->points[i].id, i };
	return sort_ids(o->cameras, m->n_cameras, "camera", where[0], err)
	       && sort_ids(o->images, m->n_images, "image", where[1], err)
	       && sort_ids(o->points, m->n_points, "point", where[2], err);
}

static bool link_images(struct colmap_model *m, const struct colmap_raw *raw, const struct orders *o, long *n_linked,
                        const char *where, struct err *err)
{
	const uint64_t *of = raw->seen_point;
	for (int i = 0; i < m->n_images; i++) {
		struct colmap_image *im = &m->images[i];
		im->camera = find(o->cameras, m->n_cameras, raw->image_camera[i]);
		if (im->camera < 0)
			return err_set(err, "%s: image %u: camera %u does not exist", where, im->id, raw->image_camera[i]);
		for (int k = 0; k < im->n_seen; k++, of++) {
			im->seen[k].point = *of == UINT64_MAX ? -1 : find(o->points, m->n_points, *of);
			if (*of != UINT64_MAX && im->seen[k].point < 0)
				return err_set(err, "%s: image %u: point %llu does not exist", where, im->id, (unsigned long long)*of);
			*n_linked += im->seen[k].point >= 0;
		}
	}
	return true;
}

/* Checks that every element of a track is an observation of that point. As there are as many as the images have, and none twice, both
 * sides then agree. */
static bool link_points(struct colmap_model *m, const struct colmap_raw *raw, const struct orders *o, long n_linked,
                        const char *where, struct err *err)
{
	long at = 0, *start = mem_array((size_t)m->n_images + 1, sizeof *start);
	char *taken = mem_new((size_t)raw->n_seen, 1);
	start[0] = 0;
	for (int i = 0; i < m->n_images; i++)
		start[i + 1] = start[i] + m->images[i].n_seen;
	bool ok = true;
	for (int i = 0; i < m->n_points && ok; i++) {
		struct colmap_point *p = &m->points[i];
		p->track = mem_array((size_t)p->n_track, sizeof *p->track);
		for (int k = 0; k < p->n_track && ok; k++, at++) {
			int image = find(o->images, m->n_images, raw->track[at].image);
			uint32_t seen = raw->track[at].seen;
			ok = image >= 0 && seen < (uint32_t)m->images[image].n_seen && m->images[image].seen[seen].point == i
			     && !taken[start[image] + seen]++;
			if (!ok)
				err_set(err, "%s: point %llu: no observation %u of image %u is its alone", where,
				        (unsigned long long)p->id, seen, raw->track[at].image);
			p->track[k] = (struct colmap_track){ image, (int)seen };
		}
	}
	free(start);
	free(taken);
	return !ok || at == n_linked ? ok : err_set(err, "%s: %ld observations, the images have %ld", where, at, n_linked);
}

/* The array in the order of its ids; inverse[old] = new. */
static void arrange(void *array, size_t size, int n, const struct order *orders, int *inverse)
{
	char *was = mem_array((size_t)n, size);
	if (n)
		memcpy(was, array, (size_t)n * size);
	for (int i = 0; i < n; i++) {
		memcpy((char *)array + (size_t)i * size, was + (size_t)orders[i].index * size, size);
		inverse[orders[i].index] = i;
	}
	free(was);
}

/* Sorts by id: COLMAP writes in the order of a hash table. */
static void sort_all(struct colmap_model *m, const struct orders *o)
{
	int *camera = mem_array((size_t)m->n_cameras, sizeof(int)), *image = mem_array((size_t)m->n_images, sizeof(int)),
	    *point = mem_array((size_t)m->n_points, sizeof(int));
	arrange(m->cameras, sizeof *m->cameras, m->n_cameras, o->cameras, camera);
	arrange(m->images, sizeof *m->images, m->n_images, o->images, image);
	arrange(m->points, sizeof *m->points, m->n_points, o->points, point);
	for (int i = 0; i < m->n_images; i++) {
		m->images[i].camera = camera[m->images[i].camera];
		for (int k = 0; k < m->images[i].n_seen; k++)
			if (m->images[i].seen[k].point >= 0)
				m->images[i].seen[k].point = point[m->images[i].seen[k].point];
	}
	for (int i = 0; i < m->n_points; i++)
		for (int k = 0; k < m->points[i].n_track; k++)
			m->points[i].track[k].image = image[m->points[i].track[k].image];
	free(camera);
	free(image);
	free(point);
}

bool colmap_link(struct colmap_model *model, const struct colmap_raw *raw, const char *const where[3], struct err *err)
{
	struct orders o = { 0 };
	long n_linked = 0;
	bool ok = true;
	for (int i = 0; i < model->n_cameras && ok; i++)
		ok = check_camera(&model->cameras[i], where[0], err);
	for (int i = 0; i < model->n_images && ok; i++)
		ok = check_image(&model->images[i], where[1], err);
	for (int i = 0; i < model->n_points && ok; i++)
		ok = check_point(&model->points[i], where[2], err);
	ok = ok && order_all(&o, model, where, err) && link_images(model, raw, &o, &n_linked, where[1], err)
	     && link_points(model, raw, &o, n_linked, where[2], err);
	if (ok)
		sort_all(model, &o);
	free(o.cameras);
	free(o.images);
	free(o.points);
	return ok;
}
