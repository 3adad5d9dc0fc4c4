/* places: points and known lengths on the subject, from capture.conf or from the pictures themselves.
 */
#ifndef SFM_HEAD_PLACES_H
#define SFM_HEAD_PLACES_H
#include "sfm/head/head.h"

enum { PLACES_LENGTHS = 400 };

struct places_lengths {
	struct sfm_length l[PLACES_LENGTHS];
	int n;
};

/* Eyes and mouth in views, in the form of capture.conf's keys. found: by eyes.h, not named by hand. */
struct places_face {
	const struct opt_each_list *eye[2], *mouth;
	bool found, has_mouth;  // has_mouth: named or found; false: an estimate at the mean place below the eyes
};

/* Each appends the lengths it finds, as many as fit: from view.NAME.ruler_px, printed markers (calibrate.marker_mm),
 * view.NAME.distance_mm. Returns false, err set (key, rule), when a key is given but cannot be used, or a picture not be read. */
bool places_ruler(struct places_lengths *out, const struct head *head, const struct views *views,
                  const struct calibrate_options *o, struct err *err);
bool places_markers(struct places_lengths *out, const struct head *head, struct stage *stage,
                    const struct calibrate_options *o, struct err *err);
bool places_distances(struct places_lengths *out, const struct head *head, const struct views *views,
                      const struct calibrate_options *o, struct err *err);
/* Triangulates a point of the face that capture.conf's key, or eyes.h, gives in several views.
 * xyz    out: world; set where *found
 * found  out: two registered views or more give it
 * which  0, 2: column of the key's numbers at which x stands
 * Returns false, err set, when the rays do not meet. */
bool places_point(double xyz[3], bool *found, const struct head *head, const struct views *views,
                  const struct opt_each_list *key, int which, struct err *err);

#endif
