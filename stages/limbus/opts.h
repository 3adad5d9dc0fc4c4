/* opts: the option tables of the search for the limbus, by the part of struct limbus_conf that they fill; meanings, units and sources are in
 * config/limbus.conf.
 */
#ifndef STAGES_LIMBUS_OPTS_H
#define STAGES_LIMBUS_OPTS_H

#define TRIAL_OPTS(c) \
	OPT_INT("regions_tried", &(c)->regions, 1, 4, "", "regions of the evidence that are tried"), \
	OPT_INT("votes_tried", &(c)->votes, 0, 12, "", "ellipses of the edges' votes that are tried"), \
	OPT_INT("rounds_tried", &(c)->rounds, 0, 12, "", "of these, round which a larger one is tried"), \
	OPT_INT("strip_reads", &(c)->reads, 1, 10, "", "readings of a strip, each round the ellipse of the one before"), \
	OPT_INT("rough_passes", &(c)->passes, 1, 20, "", "of a rough measure"), \
	OPT_REAL("rough_px", &(c)->limbus_px, 30, 10000, "px", "semi-axis to which a limbus is reduced for it"), \
	OPT_REAL("rough_pupil_px", &(c)->pupil_px, 20, 10000, "px", "the same of a pupil"), \
	OPT_REAL("window_place", &(c)->window_place, 0.05, 2, "", "of the radius: a window serves an ellipse that near"), \
	OPT_REAL("window_size", &(c)->window_size, 0.05, 1, "", "logarithm of the radii's ratio: the same"), \
	OPT_REAL("window_again", &(c)->window_again, 0.01, 1, "", "of either, from which the ellipse gets a window of its own"), \
	OPT_REAL("least_region", &(c)->least_region, 0.05, 1, "", "size of the evidence's ellipse, of the radius looked for"), \
	OPT_REAL("start_alike", &(c)->start_alike, 0.001, 0.5, "", "of the radius: a start that near one that was tried is left out"), \
	OPT_REALS("other_scales", (c)->other_scale, 2, 0.2, 5, "", "of the first region's radius: tried in doubt"), \
	OPT_REAL("prior_arcs", &(c)->prior_arcs, 1, 360, "", "so many arcs of an edge count as one against the evidence's ellipse"), \
	OPT_REAL("strip_arcs", &(c)->strip_arcs, 1, 10000, "", "the same against a strip's ellipse")

#define SAME_OPTS(c) \
	OPT_REAL("same_sigmas", &(c)->sigmas, 0.5, 10, "", "so many sigmas apart two ellipses say the same"), \
	OPT_REAL("same_most", &(c)->most, 0.01, 0.3, "", "semi-axes: no farther apart than that"), \
	OPT_REAL("same_unseen", &(c)->unseen, 0.01, 0.5, "", "semi-axes: nor than that where lids hide the rest"), \
	OPT_REAL("other_eye", &(c)->other_eye, 0.2, 5, "", "semi-axes between centres: another eye, no rival"), \
	OPT_REAL("moved_gross", &(c)->moved, 0, 1, "", "chance of a gross error where the full measure left the rough one")

#define STRIP_OPTS(c) \
	OPT_REAL("strip_rays", &(c)->rays, 1, 128, "", "so many rays on which the limbus is seen count as one"), \
	OPT_REAL("strip_hidden", &(c)->hidden, 1, 1000, "", "so many rays on which it is hidden count as one"), \
	OPT_REAL("strip_pixels", &(c)->pixels, 1, 1e6, "", "so many pixels of the evidence count as one beside the strip"), \
	OPT_REAL("strip_least", &(c)->least, 0.0001, 0.5, "", "chance that a ray tells nothing"), \
	OPT_REAL("strip_seen", &(c)->seen, 0.01, 1, "", "chance of being seen from which a ray has a place"), \
	OPT_REAL("strip_noise", &(c)->noise, 0.01, 5, "rows", "of that place, beside what its chances say"), \
	OPT_REAL("strip_near", &(c)->near, 1, 64, "rows", "round the ellipse, in which it is looked for"), \
	OPT_REALS("strip_reach", (c)->reach, 2, 0.05, 2, "", "logarithm of the size, centre in semi-axes: from the strip's own ellipse"), \
	OPT_REALS("strip_start_sigma", (c)->start_sigma, 2, 0.01, 2, "", "semi-axes: centre and size, shape of the start")

#define PUPIL_OPTS(c) \
	OPT_REAL("pupil_contrast", &(c)->min_contrast, 0.02, 1, "", "Weber contrast of pupil and iris"), \
	OPT_REAL("pupil_largest", &(c)->largest, 0.3, 1, "", "a pupil is smaller, share of the limbus"), \
	OPT_REAL("pupil_clear_coverage", &(c)->clear_coverage, 0.1, 1, "", "share seen of a margin near the other eye's size"), \
	OPT_REAL("pupil_clear_used", &(c)->clear_used, 0, 1, "", "share of it that is good enough to measure"), \
	OPT_REAL("pupil_coverage", &(c)->min_coverage, 0.1, 1, "", "share of the pupil's margin seen"), \
	OPT_REALS("pupil_first", (c)->first, 2, 0.05, 1, "", "sizes tried first, share of the limbus: least, most"), \
	OPT_REAL("pupil_first_contrast", &(c)->first_contrast, 0.01, 1, "", "Weber contrast of a fully supported edge there"), \
	OPT_REAL("pupil_first_score", &(c)->first_score, 0, 1, "", "support from which one is measured"), \
	OPT_REAL("pupil_window", &(c)->least_window, 0.5, 20, "px", "least width in which its step is fitted"), \
	OPT_REALS("pupil_told_sigma", (c)->told_sigma, 2, 0.001, 0.3, "", "of the networks' ellipse: of the limbus's semi-axis, of its own"), \
	OPT_REAL("pupil_told_sure", &(c)->told_sure, 0.01, 1, "", "mean chance of pupil in an ellipse that is believed"), \
	OPT_REAL("pupil_told_within", &(c)->told_within, 0.005, 0.5, "", "share of the limbus: an edge that near that ellipse is the pupil's"), \
	OPT_REAL("pupil_told_apart", &(c)->told_apart, 0.005, 0.5, "", "the same of what the pixels' evidence has"), \
	OPT_REAL("pupil_told_used", &(c)->told_used, 0, 1, "", "share of a margin that is good enough to measure, where both networks have it"), \
	OPT_REAL("pupil_brightest", &(c)->brightest, 1, 10, "", "brightness round a pupil over the iris's, beyond which a lamp is mirrored there"), \
	OPT_REAL("pupil_other_eye", &(c)->other_eye, 0.1, 1, "", "of what is asked of a margin, where the other eye shows its pupil"), \
	OPT_REAL("pupil_other_far", &(c)->other_far, 0.5, 10, "", "sigmas from the other eye's size, beyond which it is not the same")

#define FACE_OPTS(c) \
	OPT_REALS("face_distance", (c)->distance, 2, 2, 30, "", "between both limbi of a face, in radii: least, most"), \
	OPT_REAL("face_size_sigma", &(c)->size_sigma, 0.001, 0.5, "", "of the logarithm of their sizes' ratio"), \
	OPT_REAL("face_pupil_sigma", &(c)->pupil_sigma, 0.005, 0.5, "", "of the logarithm of their pupils' ratio"), \
	OPT_REAL("face_score", &(c)->score, 0, 1, "", "of a region of the evidence where the other eye is looked for"), \
	OPT_REAL("face_sure", &(c)->sure, 0, 1, "", "of one where it is, measured or not"), \
	OPT_REAL("face_region_alike", &(c)->region_alike, 0.05, 2, "", "logarithm of two regions' sizes' ratio, at most"), \
	OPT_REAL("face_off_alike", &(c)->off_alike, 0, 1, "", "chance that both are off for one reason"), \
	OPT_REAL("face_off_sigma", &(c)->off_sigma, 1, 20, "", "how many times face_size_sigma their sizes differ then"), \
	OPT_REAL("face_broad", &(c)->broad, 0.05, 2, "", "of the logarithm of all others' ratio"), \
	OPT_REAL("face_unlike", &(c)->unlike, 0, 0.5, "", "chance that two right ones are as unlike as any"), \
	OPT_REAL("face_far", &(c)->far, 1, 20, "", "sigmas, beyond which sizes or pupils contradict each other")

#define HAND_OPTS(c) \
	OPT_REAL("hand_close", &(c)->close, 0.01, 0.3, "", "of the radius: an edge that near a hand's mark is believed"), \
	OPT_REAL("hand_seen", &(c)->seen, 0, 1, "", "share of the ring that it shows")

#endif
