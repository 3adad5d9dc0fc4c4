/* measure: one photograph to a record: its ellipses, its camera, and which of the two poses of the limbus is likelier. */
#ifndef LIMBUS_MEASURE_H
#define LIMBUS_MEASURE_H
#include "anatomy/keys.h"
#include "limbus/record.h"
#include "optics/camera_rig.h"

/* What is known of a photograph's camera beside its EXIF. The first source that gives a focal length counts: the photograph's
 * own key, the keys for all, a calibrated camera of the photograph's size, EXIF with the table of sensors (optics/sensor.h);
 * without any of them a nominal camera far away stands in (pose_nominal_camera). */
struct limbus_camera {
	const struct camera_keys *keys;
	double focal_px;              // of this photograph alone (photo.NAME.focal_px); NAN: not given
	const double *center_px;      // [2] of this photograph alone; null: not given
	const struct rig_camera *calibrated;  // of work/rig.json; null: none
};

/* Measures one photograph.
 * record  overwritten; not ok, with the reason, when no limbus is found or no pose fits it
 * hint    x, y, radius px (limbus_find), or null
 * drawn   the limbus as a person has drawn it (limbus_find_drawn), or null; goes before the hint */
void limbus_measure_photo(struct limbus_record *record, const struct photo *photo, const double *hint, const struct ellipse *drawn,
                          const struct limbus_camera *known, const struct eye *eye, const struct limbus_conf *conf,
                          const struct pose_conf *pose_conf);

/* What a person says of one eye: x, y, radius px, or the drawn limbus, which goes before; null: nothing. */
struct limbus_mark { const double *hint; const struct ellipse *drawn; };

/* Measures a photograph that may show both eyes (limbus_find_face).
 * record  [FACE_LEFT, FACE_RIGHT] (limbus/face/face.h) where 2 is returned, which it is also where an eye is marked: the other eye's is not
 *         ok then where it is not found. [0] where 1 is returned: the photograph shows one eye, as limbus_measure_photo measures it
 * mark    of the left and the right eye */
int limbus_measure_face(struct limbus_record record[2], const struct photo *photo, const struct limbus_mark mark[2], bool mirrored,
                        const struct limbus_camera *known, const struct eye *eye, const struct limbus_conf *conf, const struct pose_conf *pose_conf);

#endif
