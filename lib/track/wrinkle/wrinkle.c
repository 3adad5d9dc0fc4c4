#include "track/wrinkle/wrinkle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "math/vec.h"
#include "track/wrinkle/impl.h"

static void lines_free(int n, struct wrinkle_line *lines)
{
	for (int i = 0; i < n; i++) {
		free(lines[i].point);
		free(lines[i].depth);
		free(lines[i].shift);
	}
	free(lines);
}

static void pose_free(struct wrinkle_pose *p)
{
	lines_free(p->n, p->line);
	free(p->frame);
	free(p->name);
}

void wrinkles_free(struct wrinkles *w)
{
	for (int i = 0; i < w->n; i++)
		pose_free(&w->pose[i]);
	free(w->pose);
	*w = (struct wrinkles){ 0 };
}

/* Log ratio of a frame's light to the neutral one's. Gaps are filled from their surroundings, so that they give no edges. */
static void change_of(float *change, uint8_t *skin, const float *neutral, const uint8_t *known, const struct wrinkle_ground *g,
                      const struct wrinkle_frame *frame)
{
	long area = (long)g->width * g->height;
	float *weight = mem_array((size_t)area, sizeof *weight), *filled = mem_array((size_t)area, sizeof *filled);
	wrinkle_unwrap(change, skin, g, frame);
	for (long i = 0; i < area; i++) {
		skin[i] = skin[i] && known[i] ? 255 : 0;
		change[i] = skin[i] ? change[i] - neutral[i] : 0;
		weight[i] = skin[i] ? 1 : 0;
		filled[i] = change[i];
	}
	plane_blur_weighted(filled, weight, g->width, g->height, 4, 0);
	for (long i = 0; i < area; i++)
		change[i] = skin[i] ? change[i] : filled[i];
	free(weight);
	free(filled);
}

static void follow(struct wrinkle_pose *p, const struct wrinkles *w, const struct wrinkle_frame *frames, const float *neutral,
                   const uint8_t *known, const struct wrinkle_ground *g, const struct wrinkle_grooves *grooves)
{
	size_t area = (size_t)g->width * (size_t)g->height;
	float *change = mem_array(area, sizeof *change);
	uint8_t *skin = mem_array(area, 1);
	for (int k = 1; k < p->n_frames; k++) {
		change_of(change, skin, neutral, known, g, &frames[k]);
		for (int i = 0; i < p->n; i++)
			wrinkle_follow(&p->line[i], k, w, change, g, grooves);
	}
	free(change);
	free(skin);
}

/* Drops lines without points. */
static void keep(struct wrinkle_pose *p)
{
	int n = 0;
	for (int i = 0; i < p->n; i++) {
		struct wrinkle_line *line = &p->line[i];
		if (!line->n) {
			free(line->point);
			continue;
		}
		size_t room = (size_t)p->n_frames * (size_t)line->n;
		line->depth = mem_new(room, sizeof *line->depth);
		line->shift = mem_new(room, sizeof *line->shift);
		p->line[n++] = *line;
	}
	p->n = n;
}

/* The neutral frame, and the change to the peak, on the chart. */
struct faces {
	float *neutral, *change;
	uint8_t *known, *skin;
};

static struct faces faces_new(const struct wrinkle_frame *neutral, const struct wrinkle_frame *peak, const struct wrinkle_ground *g)
{
	size_t area = (size_t)g->width * (size_t)g->height;
	struct faces f = { mem_array(area, sizeof *f.neutral), mem_array(area, sizeof *f.change), mem_array(area, 1), mem_array(area, 1) };
	wrinkle_unwrap(f.neutral, f.known, g, neutral);
	for (size_t i = 0; i < area; i++)
		f.known[i] = f.known[i] && g->mask[i] ? 255 : 0;
	change_of(f.change, f.skin, f.neutral, f.known, g, peak);
	return f;
}

static void faces_free(struct faces *f)
{
	free(f->neutral);
	free(f->change);
	free(f->known);
	free(f->skin);
}

bool wrinkle_find(struct wrinkles *w, const char *name, int n, const struct wrinkle_frame frames[], const struct wrinkle_ground *g,
                  const struct wrinkle_conf *conf, struct err *err)
{
	w->pose = mem_grow(w->pose, (size_t)w->n + 1, sizeof *w->pose);
	struct wrinkle_pose *p = &w->pose[w->n++];
	*p = (struct wrinkle_pose){ .name = mem_str(name), .n_frames = n, .frame = mem_new((size_t)n + 1, sizeof *p->frame) };
	w->x0 = g->x0, w->y0 = g->y0, w->width = g->width, w->height = g->height;
	w->px_per_mm = g->px_per_mm;
	for (int k = 0; k < n; k++)
		p->frame[k] = frames[k].index;
	if (n < 2)
		return true;
	struct faces f = faces_new(&frames[0], &frames[n - 1], g);
	struct wrinkle_ridges ridges;
	wrinkle_light(w, f.neutral, f.known, g);
	bool ok = wrinkle_ridges_find(&ridges, f.change, f.neutral, f.skin, g, conf, err);
	// The light is told by what is surely a line alone.
	struct wrinkle_line *sure = 0;
	const int n_sure = ok ? wrinkle_link(&sure, &ridges, 1, g, conf) : 0;
	if (n_sure > 0) {
		struct wrinkle_grooves *grooves = wrinkle_grooves_new(conf->slope);
		wrinkle_ambient(w, n_sure, sure, f.change, g, grooves);
		p->n = wrinkle_link(&p->line, &ridges, wrinkle_follows, g, conf);
		for (int i = 0; i < p->n; i++)
			wrinkle_measure(&p->line[i], w, f.change, g, grooves, conf);
		keep(p);
		if (p->n > 0)
			follow(p, w, frames, f.neutral, f.known, g, grooves);
		free(grooves);
	}
	lines_free(n_sure, sure);
	wrinkle_ridges_free(&ridges);
	faces_free(&f);
	return ok;
}
