#include "track/clip/agree.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"

/* Share of the frames that are not lost in which that eye's gaze is known; shut eyes count as known. */
static double gaze_share(const struct track_result *r, int side)
{
	long all = 0, known = 0;
	for (long f = 0; f < r->n; f++) {
		const struct eye_state *s = &r->eyes.state[f][side];
		all += !r->lost_at[f];
		known += !r->lost_at[f] && (isfinite(s->gaze[0]) || s->blink != BLINK_OPEN);
	}
	return all ? (double)known / (double)all : 0;
}

/* Median of how much higher (axis 1), or further to the person's left (axis 0), the left eye looks than the right one, degrees; NAN where the two are
 * seldom seen together. */
static double between(const struct track_result *r, int axis)
{
	enum { LEAST = 12 };
	double *d = mem_array((size_t)r->n + 1, sizeof *d);
	int n = 0;
	for (long f = 0; f < r->n; f++) {
		double off = r->eyes.state[f][SIDE_LEFT].gaze[axis] - r->eyes.state[f][SIDE_RIGHT].gaze[axis];
		if (!r->lost_at[f] && isfinite(off))
			d[n++] = off * 180 / M_PI;
	}
	double at = n >= LEAST ? stats_median(n, d) : NAN;
	free(d);
	return at;
}

/* Median over the frames of how far the skin lies off the rigid head, mm; 0 without skin. */
static double misfit_mm(const struct track_result *r, const struct track_clip *clip)
{
	double *off = mem_array((size_t)r->n + 1, sizeof *off), middle = 0;
	int n = 0;
	for (long f = 0; f < r->n && r->misfit; f++)
		if (!r->lost_at[f])
			off[n++] = r->misfit[f];
	if (n)
		middle = stats_median(n, off) * clip->cam_from_head[2][3] / clip->camera.focal_px;
	free(off);
	return middle;
}

bool track_agrees(const struct track_result *r, const struct track_clip *clip, const struct track_conf *conf, struct err *err)
{
	double share = fmax(gaze_share(r, SIDE_LEFT), gaze_share(r, SIDE_RIGHT)), off = between(r, 1), apart = between(r, 0);
	const double misfit = misfit_mm(r, clip);
	if (misfit > conf->misfit_mm)
		return err_set(err, "%s: its skin lies %.2f mm off the head that is laid on frame %ld (median), must be within %.2f (track.misfit_mm): the head's motion is not followed; check camera.focal_px, or give another track.reference_frame",
		               clip->file, misfit, clip->reference, conf->misfit_mm);
	if (share < conf->gaze_least)
		return err_set(err, "%s: gaze in %.0f %% of the frames, must be in at least %.0f %% (track.gaze_least): film closer, sharper, or give subject.eye_center.* and camera.focal_px",
		               clip->file, 100 * share, 100 * conf->gaze_least);
	if (fabs(off) > conf->agree_deg)
		return err_set(err, "%s: the left eye looks %.1f degrees higher than the right one (median), must be within %.1f (track.agree_deg): the head's pose in frame %ld is wrong; give subject.eye_center.*, or another track.reference_frame",
		               clip->file, off, conf->agree_deg, clip->reference);
	if (apart > conf->diverge_deg)
		return err_set(err, "%s: the eyes look %.1f degrees apart (median), must not diverge by more than %.1f (track.diverge_deg): the head's pose in frame %ld is wrong; give subject.eye_center.*, or another track.reference_frame",
		               clip->file, apart, conf->diverge_deg, clip->reference);
	return true;
}
