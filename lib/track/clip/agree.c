#include "track/clip/agree.h"

#include <math.h>

#include "track/clip/trust.h"

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

/* A chance above its bound, rounded up, so that it reads so, too. */
static double told(double chance)
{
	return fmin(ceil(100 * chance - 1e-9) / 100, 1);
}

bool track_agrees(struct track_result *r, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	const double share = fmax(gaze_share(r, SIDE_LEFT), gaze_share(r, SIDE_RIGHT));
	int worst = 0;
	track_trust(&r->trust, r, clip, s, conf);
	for (int i = 0; i < TRUST_EVIDENCES; i++)
		worst = r->trust.log_odds[i] < r->trust.log_odds[worst] ? i : worst;
	const struct trust_name *name = &trust_names[worst];
	const char *needed = s->assumed ? "the person's mesh (subject.ply) and the lens (camera.focal_px)" : "subject.eye_center.left and .right";
	if (r->trust.wrong > conf->wrong_most && r->trust.far > 0.5 * r->trust.wrong)
		return err_set(err, "%s: gaze is off by more than %g degrees (track.%s) with a probability of %.2g, must be at most %g (track.wrong_most): %s in frame %ld is not known well enough; give %s%s",
		               clip->file, trust_wrong_deg(s, conf), s->assumed ? "wrong_alone_deg" : "wrong_deg", told(r->trust.wrong), conf->wrong_most, s->assumed ? "how large the eyeballs are and where they lie" : "how the head is turned",
		               clip->reference, needed, s->assumed ? "" : ", or let the head turn");
	if (r->trust.wrong > conf->wrong_most && r->trust.lens > 0.5 * r->trust.wrong)
		return err_set(err, "%s: followed wrongly with a probability of %.2g, must be at most %g (track.wrong_most), above all for camera.focal_px = %g: frame %ld shows %.2f +- %.2f of the perspective that it makes of eyeballs and face, as a lens of some %.0f px would: measure the lens, or check subject.eye_center.* and subject.unit_mm",
		               clip->file, told(r->trust.wrong), conf->wrong_most, clip->camera.focal_px, clip->reference, clip->lens.share, clip->lens.sigma,
		               clip->camera.focal_px / clip->lens.share);
	// What is known speaks for it, but too little is known.
	if (r->trust.wrong > conf->wrong_most && !(r->trust.log_odds[worst] < 0))
		return err_set(err, "%s: followed from frame %ld; too little shows that it is right: wrong with a probability of %.2g, must be at most %g (track.wrong_most): give %s, or film longer and from in front",
		               clip->file, clip->reference, told(r->trust.wrong), conf->wrong_most, needed);
	if (r->trust.wrong > conf->wrong_most)
		return err_set(err, "%s: followed from frame %ld, but wrongly with a probability of %.2g, must be at most %g (track.wrong_most): %s by %.2f %s, in clips followed rightly %.2g (track.trust_%s): %s",
		               clip->file, clip->reference, told(r->trust.wrong), conf->wrong_most, name->what, r->trust.value[worst], name->unit, conf->trust[worst][0], name->key,
		               s->assumed ? "film from in front, or give the person's mesh (subject.ply) and the lens (camera.focal_px)" : name->advice);
	if (share < conf->gaze_least)
		return err_set(err, "%s: gaze in %.0f %% of the frames, must be in at least %.0f %% (track.gaze_least): film closer, sharper, or give subject.eye_center.* and camera.focal_px",
		               clip->file, 100 * share, 100 * conf->gaze_least);
	return true;
}
