#include <stdlib.h>

#include "base/mem.h"
#include "sfm/colmap/parse_impl.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "values stand in the files as in memory");

struct cursor {
	const char *p;
	size_t left;
	bool ended;  // asked for more than there is
};

static void take(void *out, struct cursor *c, size_t n)
{
	if (c->left < n) {
		memset(out, 0, n);
		c->ended = true;
		c->left = 0;
		return;
	}
	memcpy(out, c->p, n);
	c->p += n;
	c->left -= n;
}

static uint32_t take32(struct cursor *c)
{
	uint32_t v;
	take(&v, c, sizeof v);
	return v;
}

static uint64_t take64(struct cursor *c)
{
	uint64_t v;
	take(&v, c, sizeof v);
	return v;
}

/* A count of things of which each takes at least `least` bytes. */
static bool take_count(long *n, struct cursor *c, size_t least, const char *what, const char *where, struct err *err)
{
	uint64_t count = take64(c);
	if (c->ended)
		return err_set(err, "%s: is cut off", where);
	if (count > c->left / least)
		return err_set(err, "%s: %s = %llu: the file ends before", where, what, (unsigned long long)count);
	*n = (long)count;
	return true;
}

static bool finish(const struct cursor *c, const char *where, struct err *err)
{
	if (c->ended)
		return err_set(err, "%s: is cut off", where);
	return c->left ? err_set(err, "%s: %zu bytes behind its end", where, c->left) : true;
}

static bool cameras(struct colmap_model *model, struct cursor c, const char *where, struct err *err)
{
	long n = 0;
	if (!take_count(&n, &c, 24, "cameras", where, err))
		return false;
	model->cameras = mem_new((size_t)n, sizeof *model->cameras);
	for (long i = 0; i < n && !c.ended; i++) {
		struct colmap_camera *camera = &model->cameras[model->n_cameras++];
		camera->id = take32(&c);
		uint32_t kind = take32(&c);
		uint64_t width = take64(&c), height = take64(&c);
		if (kind >= COLMAP_KINDS || width > 1000000 || height > 1000000)
			return err_set(err, "%s: camera %u: model %u, %llu x %llu pixels: no such camera", where, camera->id, kind,
			               (unsigned long long)width, (unsigned long long)height);
		camera->kind = (enum colmap_kind)kind;
		camera->width = (int)width;
		camera->height = (int)height;
		take(camera->params, &c, sizeof(double) * (size_t)colmap_kind_params(camera->kind));
	}
	return finish(&c, where, err);
}

static bool image_seen(struct colmap_image *image, struct colmap_raw *raw, struct cursor *c, const char *where,
                       struct err *err)
{
	long n = 0;
	if (!take_count(&n, c, 24, "observations", where, err))
		return false;
	image->n_seen = (int)n;
	image->seen = mem_array((size_t)n, sizeof *image->seen);
	raw->seen_point = mem_grow(raw->seen_point, (size_t)(raw->n_seen + n), sizeof *raw->seen_point);
	for (long k = 0; k < n; k++) {
		take(image->seen[k].px, c, 2 * sizeof(double));
		raw->seen_point[raw->n_seen++] = take64(c);
	}
	return true;
}

static bool images(struct colmap_model *model, struct colmap_raw *raw, struct cursor c, const char *where,
                   struct err *err)
{
	long n = 0;
	if (!take_count(&n, &c, 73, "images", where, err))
		return false;
	model->images = mem_new((size_t)n, sizeof *model->images);
	raw->image_camera = mem_array((size_t)n, sizeof *raw->image_camera);
	for (long i = 0; i < n && !c.ended; i++) {
		struct colmap_image *image = &model->images[model->n_images++];
		image->id = take32(&c);
		take(image->q, &c, sizeof image->q);
		take(image->t, &c, sizeof image->t);
		raw->image_camera[i] = take32(&c);
		size_t length = strnlen(c.p, c.left);
		if (length == c.left)
			return err_set(err, "%s: image %u: its name does not end", where, image->id);
		image->name = mem_str(c.p);
		c.p += length + 1;
		c.left -= length + 1;
		if (!image_seen(image, raw, &c, where, err))
			return false;
	}
	return finish(&c, where, err);
}

static bool points(struct colmap_model *model, struct colmap_raw *raw, struct cursor c, const char *where,
                   struct err *err)
{
	long n = 0, n_track = 0;
	if (!take_count(&n, &c, 51, "points", where, err))
		return false;
	model->points = mem_new((size_t)n, sizeof *model->points);
	raw->track = mem_array(c.left / 8, sizeof *raw->track);
	for (long i = 0; i < n && !c.ended; i++) {
		struct colmap_point *point = &model->points[model->n_points++];
		point->id = take64(&c);
		take(point->xyz, &c, sizeof point->xyz);
		take(point->rgb, &c, sizeof point->rgb);
		take(&point->error, &c, sizeof point->error);
		if (!take_count(&n_track, &c, 8, "track", where, err))
			return false;
		point->n_track = (int)n_track;
		take(raw->track + raw->n_track, &c, 8 * (size_t)n_track);
		raw->n_track += n_track;
	}
	return finish(&c, where, err);
}

bool colmap_parse_binary(struct colmap_model *model, struct colmap_raw *raw, const char *const data[3],
                         const size_t size[3], const char *const where[3], struct err *err)
{
	return cameras(model, (struct cursor){ data[0], size[0], false }, where[0], err)
	       && images(model, raw, (struct cursor){ data[1], size[1], false }, where[1], err)
	       && points(model, raw, (struct cursor){ data[2], size[2], false }, where[2], err);
}
