/* landmarks: the pairs of rows that a capture's configuration names on the subject and on a target. */
#ifndef REGISTER_LANDMARKS_H
#define REGISTER_LANDMARKS_H
#include "base/opt.h"
#include "register/nricp/align.h"

/* Pairs the rows of a target's list ("name row, name row", capture.conf's target.NAME.landmarks) with the subject's landmarks of the
 * same names; those that the subject has not are left out.
 * out              overwritten; out->moving is the caller's, free((void *)out->moving)
 * lists            of all targets; the one called `name` counts, none gives no pairs
 * target_vertices, subject_vertices  rows must be below these
 * subject          subject.landmark.*: one row each
 * Returns false, err set, when the list is no such list, is longer than 256, or a row is out of range; out->moving is set then, too. */
bool landmarks_pair(struct nricp_landmarks *out, const char *name, const struct opt_each_list *lists, int target_vertices,
                    int subject_vertices, const struct opt_each_list *subject, struct err *err);

#endif
