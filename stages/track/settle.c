/* The head's pose at the reference, settled by what the eyes turn about: their centres lie 12 mm behind the lids, so that a head
 * that is thought to be turned wrongly has them in the wrong place beside the lids' outlines. */
#include <math.h>
#include <string.h>

#include "stages/track/track.h"

enum { FEW_POINTS = 120, LEAST_FRAMES = 20 };

static int centers(struct head_sight sights[SIDES], const struct track_result *r, const struct track_clip *clip, const struct track_subject *s,
                   const struct track_conf *conf)
{
	int n = 0;
	for (int e = 0; e < SIDES; e++) {
		const struct eye_globe *g = &r->eyes.globe[e];
		double p[3];
		if (!g->seen || g->frames < LEAST_FRAMES)
			continue;
		head_from(p, clip->cam_from_head, g->center_in_head);
		double px_per_mm = clip->camera.focal_px / p[2], found = hypot(g->center_sigma[0], g->center_sigma[1]);
		struct head_sight *to = &sights[n];
		*to = (struct head_sight){ .sure = true, .weight = 1 / (px_per_mm * px_per_mm * (conf->center_sigma * conf->center_sigma + found * found)) };
		memcpy(to->head, s->center[e], sizeof to->head);
		n += head_project(to->px, &clip->camera, clip->cam_from_head, g->center_in_head);
	}
	return n;
}

bool track_settle(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	struct track_conf few = *conf;
	struct track_points points = { 0 };
	struct track_result r = { 0 };
	struct head_sight sights[SIDES];
	struct err none = { 0 };
	if (s->assumed || clip->pose_given || !conf->settle)
		return true;
	few.points = FEW_POINTS;
	few.limit = conf->settle;
	few.eyes.center_sigma = conf->settle_sigma;
	few.eyes.torsion_rays = 0;
	// what cannot be followed here is said when the whole clip is
	if (track_points_choose(&points, clip, s, &few, &none) && track_follow(&r, stage, clip, s, &points, &few, &none)) {
		int n = centers(sights, &r, clip, s, conf);
		struct head_found found = { .edge_px = clip->pose_px };
		memcpy(found.cam_from_head, clip->cam_from_head, sizeof found.cam_from_head);
		memcpy(found.seen, clip->eye_seen, sizeof found.seen);
		if (n && head_find_refine(&found, clip->rgb, clip->info.width, clip->info.height, &clip->camera, s->opening, n, sights, &conf->head)) {
			memcpy(clip->cam_from_head, found.cam_from_head, sizeof clip->cam_from_head);
			clip->pose_px = found.edge_px;
		}
	}
	track_result_free(&r);
	track_points_free(&points);
	(void)err;
	return true;
}
