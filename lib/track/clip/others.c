#include "track/clip/others.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/head/propose.h"

bool track_alone_in_it(const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	struct evidence_net *net = 0;
	double known[SIDES][2], other[2][2], radius = 0;
	int n = 0;
	for (int e = 0; e < SIDES; e++) {
		// where it looks is not known: the opening's middle
		double p[3];
		known[e][0] = known[e][1] = NAN;
		if (!s->opening[e].open || !head_project(known[e], &clip->camera, clip->cam_from_head, s->opening[e].center))
			continue;
		head_from(p, clip->cam_from_head, s->opening[e].center);
		radius += clip->camera.focal_px * conf->eye.limbus_radius / p[2];
		n++;
	}
	if (!n)
		return true;
	if (!evidence_open_shipped(&net, err))
		return false;
	const bool more = head_propose_other(other, (const double(*)[2])known, radius / n, net, clip->rgb, clip->info.width, clip->info.height, err);
	evidence_close(net);
	if (err_is(err))
		return false;
	return !more || err_set(err, "%s: frame %ld shows eyes at %.0f %.0f and %.0f %.0f px besides those followed: more than one face, a mirror image of it, or none that the mesh fits: cut the video to one face",
	                        clip->file, clip->reference, other[0][0], other[0][1], other[1][0], other[1][1]);
}

bool track_alone_through(const struct track_result *r, struct stage *stage, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf,
                         struct err *err)
{
	enum { FRAMES = 4, SPAN = 600 };  // a film of an hour is not decoded anew for it
	const size_t area = (size_t)clip->info.width * (size_t)clip->info.height;
	struct track_clip at = *clip;
	struct err none = { 0 };
	bool alone = true;
	const long n = r->n < SPAN ? r->n : SPAN;
	at.luma = mem_array(area + 1, 1);
	at.rgb = mem_array(3 * area + 1, 1);
	for (int i = 0; alone && i < FRAMES; i++) {
		const long f = (2 * i + 1) * n / (2 * FRAMES);
		at.reference = f * track_every(conf);
		memcpy(at.cam_from_head, r->pose[f], sizeof at.cam_from_head);
		if (!r->lost_at[f] && track_clip_take(&at, at.reference, stage, conf, &none))
			alone = track_alone_in_it(&at, s, conf, err);
	}
	free(at.luma);
	free(at.rgb);
	return alone;
}
