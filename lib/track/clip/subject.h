/* subject: the person's mesh, and where its eyes are. */
#ifndef TRACK_CLIP_SUBJECT_H
#define TRACK_CLIP_SUBJECT_H
#include "base/stage.h"
#include "mesh/mesh.h"
#include "track/clip/conf.h"

enum { MARK_INNER, MARK_OUTER, MARK_UPPER, MARK_LOWER, MARKS };

/* In mm. */
struct track_subject {
	struct mesh mesh;      // n_vertices 0: there is none
	const char *file;      // relative to the capture; owned by the stage
	double unit_mm;
	int mark[SIDES][MARKS];          // rows; -1: not known
	double center[SIDES][3], radius; // of the eyeballs; NAN where not known
	bool center_given[SIDES];        // by capture.conf: not estimated
	struct eye_opening opening[SIDES];
	struct eye_opening margin[SIDES];  // where the lids stand clear of the eye and its tears: the inner edge of their margins
	bool assumed;          // there is no mesh: openings of a usual face, to find eyes with
};

bool track_subject_load(struct track_subject *subject, struct stage *stage, const struct track_conf *conf, struct err *err);
void track_subject_free(struct track_subject *subject);

/* Whether a point of the skin moves with the eyelids. */
bool track_on_lid(const double head[3], const struct track_subject *subject);

#endif
