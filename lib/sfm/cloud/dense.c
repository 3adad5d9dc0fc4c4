#include "sfm/cloud/dense.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "image/picture.h"

#define GRID CALIBRATE_DIR "/cloud.grid"
enum { BATCH = 16 };

/* The tag of a grid file: its options, then a line for each picture that is in it. */
static char *options_text(const struct cloud_conf *c)
{
	return mem_printf("%d %.9g %d %d %.9g %.9g %d %d %d %d\n", c->neighbours, c->best_angle, c->size_px, c->max_range, c->voxel,
	                  c->max_slant, c->stereo.block, c->stereo.uniqueness, c->stereo.left_right, c->stereo.speckle);
}

static char *tag_of(const struct colmap_model *m, const struct cloud_conf *conf)
{
	char *text = 0, *options = options_text(conf);
	size_t size = 0;
	FILE *f = open_memstream(&text, &size);
	fputs(options, f);
	for (int i = 0; i < m->n_images; i++)
		fprintf(f, "%s\n", m->images[i].name);
	fclose(f);
	free(options);
	return text;
}

/* Loads the kept grid where all its pictures are in this model; is_new: out, the pictures that are not in it yet. */
static struct cloud_grid *recall(bool *is_new, const struct colmap_model *m, struct stage *stage, const struct cloud_conf *conf)
{
	struct cloud_grid *grid;
	char *tag, *options = options_text(conf);
	int known = 0, lines = 0;
	for (int i = 0; i < m->n_images; i++)
		is_new[i] = true;
	bool same = cloud_grid_load(&grid, &tag, stage_path(stage, GRID)) && !strncmp(tag, options, strlen(options));
	if (same) {
		for (const char *c = tag + strlen(options); *c; c++)
			lines += *c == '\n';
		for (int i = 0; i < m->n_images; i++) {
			char *line = mem_printf("\n%s\n", m->images[i].name);
			is_new[i] = !strstr(tag, line);
			known += !is_new[i];
			free(line);
		}
		same = known == lines;
	}
	free(tag);
	free(options);
	if (same)
		return grid;
	for (int i = 0; i < m->n_images; i++)
		is_new[i] = true;
	cloud_grid_free(grid);
	return 0;
}

/* Reads a picture as grey, reduced to about the size at which the subject is matched. */
static bool load(struct cloud_picture *out, const struct colmap_image *im, const struct head *head, struct stage *stage,
                 const char *path, const struct calibrate_options *o, struct err *err)
{
	uint8_t *px;
	int w, h;
	double c[3], d = 0;
	(void)stage;
	if (out->grey)
		return true;
	if (!picture_read(&px, &w, &h, path, o->limit_mpx, err))
		return false;
	colmap_center(c, im);
	for (int i = 0; i < 3; i++)
		d += (c[i] - head->subject.center[i]) * (c[i] - head->subject.center[i]);
	double size = 2 * head->subject.radius / fmax(sqrt(d), head->subject.radius) * head->model->cameras[im->camera].params[0];
	double f = fmin(1, 1.2 * o->cloud.size_px / size);
	uint8_t *grey = mem_array((size_t)w * (size_t)h, 1);
	for (long i = 0; i < (long)w * h; i++)
		grey[i] = (uint8_t)((54 * px[3 * i] + 183 * px[3 * i + 1] + 19 * px[3 * i + 2]) >> 8);
	free(px);
	out->width = (int)fmax(8, lround(f * w));
	out->height = (int)fmax(8, lround(f * h));
	out->grey = cv_resize8(grey, w, h, 1, out->width, out->height);
	free(grey);
	return true;
}

/* Matches pairs in parallel and adds their points in order: the same sums on any number of threads. */
static bool match(struct cloud_grid *grid, const struct cloud_pair *pairs, int n, struct cloud_picture *pictures,
                  const struct sfm_subject *subject, const struct head *head, struct stage *stage,
                  const struct calibrate_options *o, struct err *err)
{
	const struct colmap_model *m = head->model;
	bool ok = true;
	for (int first = 0; first < n && ok; first += BATCH) {
		struct cloud_points points[BATCH] = { 0 };
		struct err errs[BATCH] = { 0 };
		int size = n - first < BATCH ? n - first : BATCH;
		for (int i = 0; i < size && ok; i++)
			for (int k = 0; k < 2 && ok; k++) {
				int image = k ? pairs[first + i].b : pairs[first + i].a;
				ok = load(&pictures[image], &m->images[image], head, stage,
				          stage_path(stage, CALIBRATE_DIR "/pictures/%s", m->images[image].name), o, err);
			}
#pragma omp parallel for schedule(dynamic) if (ok)
		for (int i = 0; i < size; i++) {
			const struct cloud_pair *p = &pairs[first + i];
			if (ok)
				cloud_stereo(&points[i], m, p, &pictures[p->a], &pictures[p->b], subject, &o->cloud, &errs[i]);
		}
		for (int i = 0; i < size; i++) {
			if (ok && err_is(&errs[i]))
				ok = err_set(err, "%s", errs[i].msg);
			cloud_grid_add(grid, &points[i]);
			cloud_points_free(&points[i]);
		}
		stage_progress(stage, first + size, n, "surface");
	}
	return ok;
}

bool dense_cloud(struct cloud_points *cloud, const struct head *head, const struct views *views, struct stage *stage,
                 const struct calibrate_options *o, struct err *err)
{
	const struct colmap_model *m = head->model;
	bool *is_new = mem_new((size_t)m->n_images, sizeof *is_new);
	struct sfm_subject subject = head->subject;
	int n = 0;
	(void)views;
	struct cloud_grid *grid = recall(is_new, m, stage, &o->cloud);
	if (grid)
		cloud_grid_subject(&subject, grid, &o->cloud);
	else
		grid = cloud_grid_new(&subject, &o->cloud);
	struct cloud_pair *pairs = cloud_pairs(&n, m, is_new, &o->cloud);
	struct cloud_picture *pictures = mem_new((size_t)m->n_images, sizeof *pictures);
	char *tag = tag_of(m, &o->cloud);
	bool ok = match(grid, pairs, n, pictures, &subject, head, stage, o, err)
	          && cloud_grid_save(grid, stage_path(stage, GRID), tag, err) && stage_made(stage, GRID, 0, 0, err);
	// A small set has few pairs: agreement of two has to suffice.
	enum { SMALL_SET = 20 };
	struct cloud_conf conf = o->cloud;
	conf.min_pairs = m->n_images < SMALL_SET && conf.min_pairs > 2 ? 2 : conf.min_pairs;
	if (ok)
		cloud_grid_points(cloud, grid, &conf);
	for (int i = 0; i < m->n_images; i++)
		free(pictures[i].grey);
	free(pictures);
	free(pairs);
	free(tag);
	free(is_new);
	cloud_grid_free(grid);
	return ok;
}
