/* kappa: the line of sight (visual axis) of each eye against its optical axis, which gaze is of. A prior from people's eyes; measured where capture.conf says that the person
 * looks into the camera. Angles in the eye's own axes: horizontal, positive towards the nose, and vertical, positive up; radians.
 */
#ifndef TRACK_CLIP_KAPPA_H
#define TRACK_CLIP_KAPPA_H
#include "track/clip/clip.h"
#include "track/clip/result.h"

/* Fills result->kappa: the prior (conf->kappa, conf->kappa_sigma), and where conf->camera_frames are set their evidence with it: the median over those frames of
 * the camera's direction against the optical axis, as good as gaze is in the median (its sigma, which is the eyeball's and the pose's in all frames alike).
 * An eye whose gaze is known in fewer than five of them keeps the prior. Returns false, err set (key, value, rule), where those are no frames of the clip in order. */
bool track_kappa(struct track_result *result, const struct track_conf *conf, struct err *err);

/* The line of sight's Fick angles against the head, radians: the optical axis turned by kappa. gaze: h, v, torsion; NAN torsion counts as 0. Returns NAN where gaze is. */
void kappa_sight(double sight[2], const double gaze[3], const double kappa[2], int side);

#endif
