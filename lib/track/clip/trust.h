/* trust: how likely a clip that was followed is wrong as a whole, by everything that would differ if it were.
 * A clip is right or wrong. Of each evidence x is the deviation from what a rightly followed one shows: normal about 0, of the scale `right` or `wrong`
 * (conf->trust, the keys track.trust_*). A wrong clip is right in some respects, a right one seldom odd in one:
 *     p(x | right) = (1 - odd) N(right) + odd N(wrong),    p(x | wrong) = (N(right) + N(wrong)) / 2,
 * and the logarithms of the quotients add up with the prior's (Bayes' rule for independent evidence). No evidence decides alone what others contradict,
 * and one that is far off is not outvoted.
 * Of clips that one eye alone lays the mesh on, its centre not told, more are wrong before anything is known (wrong_prior_one).
 * A lens that was told wrongly is followed as well as another, and no evidence but the perspective seen (head/lens.h) speaks of it: its probability joins at the end.
 * A clip that is followed rightly may still be off by more than wrong_deg, as its gaze's own standard deviations say.
 */
#ifndef TRACK_CLIP_TRUST_H
#define TRACK_CLIP_TRUST_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* What each evidence is called in track.json and in a refusal, its unit, and what to do about it. */
struct trust_name {
	const char *key, *what, *unit, *advice;
};
extern const struct trust_name trust_names[TRUST_EVIDENCES];

/* Fills trust: the values, each one's log odds of right against wrong (NAN, 0 where the clip does not tell it), and the probabilities. */
void track_trust(struct track_trust *trust, const struct track_result *result, const struct track_clip *clip, const struct track_subject *subject,
                 const struct track_conf *conf);

/* What a residual of the reference's pose is divided by to be in px of a picture 1280 wide, the eyes of usual size: in proportion to theirs. Outlines in
 * one frame alone fit half as well as a pose refined by many. */
double trust_scale(const struct track_clip *clip, const struct track_subject *subject);

/* Log odds of right against wrong that one evidence's value tells; 0 for NAN. */
double trust_odds(int evidence, double value, const struct track_conf *conf);

/* Those of a reference before the clip is followed: its pose's residual, and its skin against that of the frames it was judged by. -INFINITY where no pose was found. */
double trust_reference(const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf);

/* Median of gaze's standard deviations in the axis and eye that is known least, degrees; NAN with few frames. */
double trust_sigma_deg(const struct track_result *result);

/* Gaze that is off by more is wrong, degrees: conf's wrong_deg, or wrong_alone_deg without a mesh. */
double trust_wrong_deg(const struct track_subject *subject, const struct track_conf *conf);

/* Median over the frames of how far the skin lies off the rigid head, mm; NAN with few frames or no skin. */
double trust_skin_mm(const struct track_result *result, const struct track_clip *clip, const struct track_subject *subject);

#endif
