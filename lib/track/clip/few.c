#include "track/clip/few.h"

#include <math.h>

#include "track/clip/follow.h"

enum { FEW_POINTS = 120 };

struct track_conf track_few_of(const struct track_conf *conf, const struct track_clip *clip, int frames, long span)
{
	struct track_conf few = *conf;
	span = track_frames_of(clip, span);
	span = clip->info.frames < span ? clip->info.frames : span;
	few.points = FEW_POINTS;
	few.limit = frames;
	few.every = span > frames ? (span + frames - 1) / frames : 1;
	few.eyes.center_sigma = conf->settle_sigma;
	few.eyes.torsion_rays = 0;
	few.eyes.apart[0] = few.eyes.apart[1] = INFINITY;  // under a pose that is still wrong eyes look apart
	return few;
}

bool track_follow_few(struct track_result *r, const struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *few)
{
	struct track_points points = { 0 };
	struct err none = { 0 };
	// errors are reported when the whole clip is followed
	bool ok = track_points_choose(&points, clip, s, few, &none) && track_follow(r, stage, clip, s, &points, few, &none)
	          && clip->reference / few->every < r->n;
	track_points_free(&points);
	return ok;
}
