#include "track/clip/margins.h"

#include "track/clip/margin_draw.h"

bool track_margins(struct track_result *r, struct stage *stage, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	const int every = conf->lids.every;
	if (!every || !r->has_eyes || s->assumed)
		return true;
	struct margin_seen(*seen)[SIDES] = bulk_new(r->bulk, (size_t)(r->n / every) + 1, sizeof *seen);
	const bool ok = margin_seen_all(seen, r, every, stage, clip, s, conf, err);
	if (ok)
		margin_draw(r, (const struct margin_seen(*)[SIDES])seen, clip->info.fps / (double)track_every(conf), conf);
	bulk_free(r->bulk, seen);
	return ok;
}
