/* transfer_check: whether a registration can be true, by what it was not fitted to. */
#ifndef REGISTER_TRANSFER_CHECK_H
#define REGISTER_TRANSFER_CHECK_H
#include "register/transfer.h"

struct transfer_check_conf {
	double covered;    // least share of the subject that a character lies on
	double flipped;    // most flipped triangles, share of those that follow
	double stretch;    // most stretch
	double eyes;       // most distance of an eyeball from the subject's, share of the distance between these
	double landmarks;  // most distance of a given landmark from its place, share of the subject's size
};

/* Of vertices that follow the subject (transfer_trusted), and triangles with three such corners. */
struct transfer_check {
	double follow;     // share of all vertices
	double covered;    // share of the subject's area within the snapping distance of them
	int flipped;       // triangles whose normal turned by more than 90 degrees against the similarity
	double stretch;    // 95 % quantile of |ln(edge after / edge after the similarity)|
	double eyes;       // distance of the worse eyeball's centre from the subject's, share of the distance between these; NAN: not known
	double landmarks;  // mean distance of the given landmarks from their places, share of the subject's size; NAN: none
	char reason[1024]; // why it cannot be true; empty: nothing speaks against it
};

/* Checks a registration.
 * target       as it was registered
 * subject_eye  centres of its left and right eyeball, mm, or null
 * given        landmarks given by hand; n = 0: none
 * Returns whether nothing speaks against it. */
bool transfer_check(struct transfer_check *out, const struct transfer *transfer, const struct mesh *target, const struct mesh *subject,
                    const double (*subject_eye)[3], const struct nricp_landmarks *given, const struct transfer_conf *conf,
                    const struct transfer_check_conf *limits);

#endif
