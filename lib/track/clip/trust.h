/* trust: how likely a clip that was followed is wrong as a whole, by everything that would differ if it were.
 * A clip is right or wrong. Of each evidence x is the deviation from what a rightly followed one shows: normal about 0, of the scale `right` or `wrong`
 * (conf->trust, the keys track.trust_*). A wrong clip is right in some respects, a right one seldom odd in one:
 *     p(x | right) = (1 - odd) N(right) + odd N(wrong),    p(x | wrong) = (N(right) + N(wrong)) / 2,
 * and the logarithms of the quotients add up with the prior's (Bayes' rule for independent evidence). No evidence decides alone what others contradict,
 * and one that is far off is not outvoted.
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

/* Fills trust: the values, each one's log odds of right against wrong (NAN, 0 where the clip does not tell it), and the probability of wrong. */
void track_trust(struct track_trust *trust, const struct track_result *result, const struct track_clip *clip, const struct track_subject *subject,
                 const struct track_conf *conf);

#endif
