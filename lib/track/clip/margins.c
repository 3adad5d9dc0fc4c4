#include "track/clip/margins.h"

#include <math.h>

#include "track/clip/margin_draw.h"

/* Radius of the larger iris in the reference frame, px. */
static double iris_px(const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	double most = 0, p[3];
	for (int e = 0; e < SIDES; e++) {
		if (!s->opening[e].open || !clip->eye_seen[e])
			continue;
		head_from(p, clip->cam_from_head, s->opening[e].center);
		most = fmax(most, clip->camera.focal_px * conf->eye.limbus_radius / p[2]);
	}
	return most;
}

bool track_margins(struct track_result *r, struct stage *stage, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	const int every = conf->lids.every;
	if (!every || !r->has_eyes || s->assumed || iris_px(clip, s, conf) > conf->lids.most_px)
		return true;
	struct margin_seen(*seen)[SIDES] = bulk_new(r->bulk, (size_t)(r->n / every) + 1, sizeof *seen);
	const bool ok = margin_seen_all(seen, r, every, stage, clip, s, conf, err);
	if (ok)
		margin_draw(r, (const struct margin_seen(*)[SIDES])seen, clip->info.fps / (double)track_every(conf), conf);
	bulk_free(r->bulk, seen);
	return ok;
}
