/* places: what capture.conf or the pictures themselves say of points and lengths on the subject. */
#ifndef SFM_HEAD_PLACES_H
#define SFM_HEAD_PLACES_H
#include "sfm/head/head.h"

enum { PLACES_LENGTHS = 400 };

struct places_lengths {
	struct sfm_length l[PLACES_LENGTHS];
	int n;
};

/* Eyes and mouth in views, as capture.conf's keys have them: named by a hand, or found. */
struct places_face {
	const struct opt_each_list *eye[2], *mouth;
	bool found, has_mouth;  // has_mouth: named or found, not only expected below the eyes
};

/* Each appends what it finds; what is given but cannot be used is an error that says why. */
bool places_ruler(struct places_lengths *out, const struct head *head, const struct views *views,
                  const struct calibrate_options *o, struct err *err);
bool places_markers(struct places_lengths *out, const struct head *head, struct stage *stage,
                    const struct calibrate_options *o, struct err *err);
bool places_distances(struct places_lengths *out, const struct head *head, const struct views *views,
                      const struct calibrate_options *o, struct err *err);
/* Points of the face: world. *found false where fewer than two registered views name it. which: column of the key. */
bool places_point(double xyz[3], bool *found, const struct head *head, const struct views *views,
                  const struct opt_each_list *key, int which, struct err *err);

#endif
