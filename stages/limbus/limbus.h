/* limbus: the stage's files: photographs in, work/limbus/ out. The algorithms are in lib/limbus. */
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
	struct opt_each_list photo_focal, photo_center, photo_hint, photo_limbus, photo_eye, photo_mirrored;
	double limit_mpx, rough_used, face_roll_deg, roll_sigma_deg, tilt_sigma_deg, face_apart_deg, face_apart_sigma_deg, face_level_deg, opening_sigma_deg;
	int overlay_px;
};

/* The photograph that was read last, kept in memory because the next step often needs the same one. */
struct limbus_kept {
	char *file;  // "photos/left_a.jpg"; null: none
	struct photo photo;
};

/* The photograph `file` of the capture, at `path`, is in memory then. False, err set, where it cannot be read. */
bool limbus_keep(struct limbus_kept *kept, const char *file, const char *path, double limit_mpx, struct err *err);
void limbus_kept_free(struct limbus_kept *kept);

/* Measures every photograph whose work/limbus/NAME.edge.json is not up to date, and writes it; a photograph that cannot be used
 * gets a record with the reason; one that shows both eyes becomes two of the capture, with NAME.left.edge.json and NAME.right.edge.json.
 * capture: of capture_list. kept: out; limbus_kept_free. o->find: gets the networks that are shipped where there is something to measure; closed
 * by the caller. False, err set, when a file cannot be read or written, or a network cannot be used. */
bool limbus_measure(struct limbus_kept *kept, struct stage *stage, struct capture *capture, struct limbus_options *o, struct err *err);

/* Fits the poses of all photographs of each eye together; writes work/limbus/NAME.json and NAME.png. False, err set, when no
 * photograph is usable or a file cannot be read or written. */
bool limbus_fit_poses(struct limbus_kept *kept, struct stage *stage, const struct capture *capture, const struct limbus_options *o,
                      struct err *err);

/* "work/limbus/NAME.edge.json"; owned by the caller, free(). */
char *limbus_record_path(const struct capture_photo *photo);

#endif
