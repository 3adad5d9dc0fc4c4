#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "sfm/colmap/colmap.h"

/* Text in the program's own layout; 17 digits bring every double back as it was. */
static void text_camera(FILE *f, const struct colmap_camera *c)
{
	fprintf(f, "%u %s %d %d", c->id, colmap_kind_name(c->kind), c->width, c->height);
	for (int i = 0; i < colmap_kind_params(c->kind); i++)
		fprintf(f, " %.17g", c->params[i]);
	fputc('\n', f);
}

static void text_image(FILE *f, const struct colmap_model *m, const struct colmap_image *im)
{
	fprintf(f, "%u %.17g %.17g %.17g %.17g %.17g %.17g %.17g %u %s\n", im->id, im->q[0], im->q[1], im->q[2], im->q[3],
	        im->t[0], im->t[1], im->t[2], m->cameras[im->camera].id, im->name);
	for (int k = 0; k < im->n_seen; k++) {
		fprintf(f, "%s%.17g %.17g ", k ? " " : "", im->seen[k].px[0], im->seen[k].px[1]);
		if (im->seen[k].point < 0)
			fputs("-1", f);
		else
			fprintf(f, "%llu", (unsigned long long)m->points[im->seen[k].point].id);
	}
	fputc('\n', f);
}

static void text_point(FILE *f, const struct colmap_model *m, const struct colmap_point *p)
{
	fprintf(f, "%llu %.17g %.17g %.17g %d %d %d %.17g", (unsigned long long)p->id, p->xyz[0], p->xyz[1], p->xyz[2],
	        p->rgb[0], p->rgb[1], p->rgb[2], p->error);
	for (int k = 0; k < p->n_track; k++)
		fprintf(f, " %u %d", m->images[p->track[k].image].id, p->track[k].seen);
	fputc('\n', f);
}

static void put(FILE *f, const void *data, size_t n)
{
	fwrite(data, 1, n, f);
}

static void put_count(FILE *f, long n)
{
	uint64_t count = (uint64_t)n;
	put(f, &count, sizeof count);
}

static void binary_camera(FILE *f, const struct colmap_camera *c)
{
	int32_t kind = (int32_t)c->kind;
	put(f, &c->id, sizeof c->id);
	put(f, &kind, sizeof kind);
	put_count(f, c->width);
	put_count(f, c->height);
	put(f, c->params, sizeof(double) * (size_t)colmap_kind_params(c->kind));
}

static void binary_image(FILE *f, const struct colmap_model *m, const struct colmap_image *im)
{
	put(f, &im->id, sizeof im->id);
	put(f, im->q, sizeof im->q);
	put(f, im->t, sizeof im->t);
	put(f, &m->cameras[im->camera].id, sizeof(uint32_t));
	fputs(im->name, f);
	fputc(0, f);
	put_count(f, im->n_seen);
	for (int k = 0; k < im->n_seen; k++) {
		int point = im->seen[k].point;
		uint64_t id = point < 0 ? UINT64_MAX : m->points[point].id;
		put(f, im->seen[k].px, sizeof im->seen[k].px);
		put(f, &id, sizeof id);
	}
}

static void binary_point(FILE *f, const struct colmap_model *m, const struct colmap_point *p)
{
	put(f, &p->id, sizeof p->id);
	put(f, p->xyz, sizeof p->xyz);
	put(f, p->rgb, sizeof p->rgb);
	put(f, &p->error, sizeof p->error);
	put_count(f, p->n_track);
	for (int k = 0; k < p->n_track; k++) {
		uint32_t pair[2] = { m->images[p->track[k].image].id, (uint32_t)p->track[k].seen };
		put(f, pair, sizeof pair);
	}
}

static void write_one(FILE *f, const struct colmap_model *m, int which, enum colmap_format format)
{
	int n = which == 0 ? m->n_cameras : which == 1 ? m->n_images : m->n_points;
	bool text = format == COLMAP_TEXT;
	if (!text)
		put_count(f, n);
	for (int i = 0; i < n; i++)
		if (which == 0)
			(text ? text_camera : binary_camera)(f, &m->cameras[i]);
		else if (which == 1)
			(text ? text_image : binary_image)(f, m, &m->images[i]);
		else
			(text ? text_point : binary_point)(f, m, &m->points[i]);
}

bool colmap_save(const struct colmap_model *model, const char *dir, enum colmap_format format, struct err *err)
{
	static const char *const stems[] = { "cameras", "images", "points3D" };
	bool ok = true;
	for (int i = 0; i < COUNT(stems) && ok; i++) {
		char *bytes = 0, *path = mem_printf("%s/%s.%s", dir, stems[i], format == COLMAP_TEXT ? "txt" : "bin");
		size_t size = 0;
		FILE *f = open_memstream(&bytes, &size);
		write_one(f, model, i, format);
		fclose(f);
		ok = file_write(path, bytes, size, err);
		free(bytes);
		free(path);
	}
	return ok;
}
