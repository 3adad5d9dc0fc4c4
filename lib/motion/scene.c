#include "motion/scene.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/saliency.h"
#include "image/saliency_pick.h"
#include "math/rng.h"

struct watch {
	struct saliency saliency;
	struct rng rng;
	double next, last;   // s: when to look elsewhere; of the frame before
	uint8_t *rgb;
};

static void add_place(struct animate_places *p, double t, const double at[2])
{
	p->t = mem_grow(p->t, (size_t)p->n + 1, sizeof *p->t);
	p->at = mem_grow(p->at, (size_t)p->n + 1, sizeof *p->at);
	p->t[p->n] = t;
	p->at[p->n][0] = at[0];
	p->at[p->n++][1] = at[1];
}

/* Frames between fixations are only decoded: saliency is computed from the frame in which gaze moves on and the one looked at
 * before, whose difference is flicker. */
static void watch_frame(struct animate_places *places, struct watch *w, const struct video_frame *f,
                        const struct scene_conf *conf)
{
	double at[2];
	places->duration = f->time;
	if (f->time < w->next)
		return;
	if (!w->rgb)
		w->rgb = mem_array((size_t)f->width * (size_t)f->height * 3, 1);
	video_frame_rgb(w->rgb, 3 * f->width, f, 0, 0, f->width, f->height);
	saliency_push(&w->saliency, w->rgb, f->width, f->height, 3 * f->width);
	saliency_decay(&w->saliency, f->time - w->last, conf->inhibit_s);
	w->last = f->time;
	if (saliency_next(at, &w->saliency)) {
		add_place(places, f->time, at);
		saliency_inhibit(&w->saliency, at, conf->inhibit);
	}
	w->next = f->time + fmax(0.1, conf->dwell[0] + conf->dwell[1] * rng_normal(&w->rng));
}

bool scene_places(struct animate_places *places, struct stage *stage, const char *rel, const struct scene_conf *conf,
                  struct err *err)
{
	struct video_info info;
	struct watch w = { .rng = { conf->seed } };
	*places = (struct animate_places){ 0 };
	struct video *video = video_open(&info, stage_path(stage, "%s", rel), &conf->video, err);
	bool ok = video, got = ok;
	int width = 0, height = 0;
	while (ok && got) {
		struct video_frame frame = { 0 };
		ok = video_next(&frame, &got, video, err);
		if (ok && got && width && (frame.width != width || frame.height != height))
			ok = err_set(err, "%s: frame %ld has another size than the first", rel, frame.index);
		if (ok && got) {
			width = frame.width;
			height = frame.height;
			watch_frame(places, &w, &frame, conf);
			stage_progress(stage, (int)frame.index + 1, (int)info.frames, "frames");
		}
		video_frame_free(&frame);
	}
	places->aspect = width ? (double)height / width : 1;
	video_close(video);
	saliency_free(&w.saliency);
	free(w.rgb);
	return ok;
}

void scene_places_free(struct animate_places *p)
{
	free(p->t);
	free(p->at);
	*p = (struct animate_places){ 0 };
}
