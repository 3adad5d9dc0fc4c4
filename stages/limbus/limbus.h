/* limbus: the stage's own parts. */
#ifndef STAGES_LIMBUS_H
#define STAGES_LIMBUS_H
#include "base/stage.h"
#include "anatomy/capture.h"
#include "anatomy/keys.h"
#include "limbus/record.h"

struct limbus_options {
	struct eye eye;
	struct limbus_conf find;
	struct pose_conf pose;
	struct camera_keys camera;
	struct opt_each_list photo_focal, photo_center, photo_hint, photo_eye;
	double limit_mpx;
	int overlay_px;
};

/* A photograph in memory, for who needs the same one next. */
struct limbus_kept {
	const struct capture_photo *of;  // null: none
	struct photo photo;
};

/* work/limbus/NAME.edge.json of every photograph that is not up to date; the last of them is kept. photo_free(&kept->photo). */
bool limbus_measure(struct limbus_kept *kept, struct stage *stage, const struct capture *capture, const struct limbus_options *o,
                    struct err *err);

/* work/limbus/NAME.json and NAME.png, all photographs of an eye together. False when none is usable. */
bool limbus_fit_poses(struct limbus_kept *kept, struct stage *stage, const struct capture *capture, const struct limbus_options *o,
                      struct err *err);

/* "work/limbus/NAME.edge.json"; owned by the caller, free(). */
char *limbus_record_path(const struct capture_photo *photo);

#endif
