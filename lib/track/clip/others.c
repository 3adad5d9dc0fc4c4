#include "track/clip/others.h"

#include <math.h>

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
