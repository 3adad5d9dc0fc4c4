/* joint: all photographs of one eye together. They share the aspect of its limbus, which is declared or fitted to all of them
 * under the anatomical prior; each has a pose of its own.
 */
#ifndef LIMBUS_JOINT_H
#define LIMBUS_JOINT_H
#include "anatomy/fit.h"
#include "limbus/aspect.h"
#include "limbus/record.h"

/* What the photographs share. */
struct limbus_joint {
	struct pose_conf pose;  // its aspect_mean as declared or fitted, its aspect_sigma 0
	struct aspect aspect;   // as fitted; sigma 0: declared
};

/* What is level for a head, against the picture's rows, rad: the line through both of its eyes, from the one that is farther left. For view.level of either. */
double limbus_joint_level(const struct limbus_record *one, const struct limbus_record *other);

/* Fits what n photographs of one eye share; records that are not ok are left out.
 * False, err set, when a record has no pose. */
bool limbus_joint(struct limbus_joint *joint, int n, const struct limbus_record records[n], const struct eye *eye,
                  const struct pose_conf *conf, struct err *err);

/* What one record that is ok tells of the eye's tilt, to the other eye of a face in the same photograph. False, err set, when no pose fits. */
bool limbus_joint_tilt(struct fellow_tilt *tilt, const struct limbus_joint *joint, const struct limbus_record *record, const struct eye *eye, struct err *err);

/* The pose of one record that is ok, under the shared aspect. theta_sigma includes the aspect's uncertainty: the pose is fitted
 * again at one sigma more, and at its rivals. Where the picture could be one from in front the tilt is the mean of both poses', by their
 * chances, and theta_sigma the distance from both. other: what the other eye of a face says (limbus_joint_tilt of its record), which tells the sides apart and
 * draws the tilt to its own; null: there is none. False, err set, when no pose fits. */
bool limbus_joint_pose(struct pose *pose, const struct limbus_joint *joint, const struct limbus_record *record, const struct fellow_tilt *other,
                       const struct eye *eye, struct err *err);

/* What limbus/NAME.json says: record and pose as a fit. pose is not read where the record is not ok. */
struct fit limbus_joint_fit(const struct limbus_record *record, const struct pose *pose);

#endif
