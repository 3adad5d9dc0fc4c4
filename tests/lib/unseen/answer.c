#include "tests/lib/unseen/answer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "limbus/joint.h"
#include "limbus/measure.h"
#include "tests/lib/conf/limbus_conf.h"

struct limbus_conf *answer_conf(void)
{
	return &limbus_defaults;
}

double answer_right(void)
{
	return limbus_defaults.tolerance;
}

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The stage's own prior of the aspect (config/limbus.conf); the other defaults are what tests use. */
static struct pose_conf pose_conf_of(void)
{
	struct pose_conf conf = pose_defaults;
	conf.aspect_mean = 0.95;
	conf.aspect_sigma = 0.035;
	conf.roll_sigma = 4 * M_PI / 180;
	conf.tilt_sigma = 30 * M_PI / 180;
	return conf;
}

static struct eye eye_of(double aspect)
{
	return (struct eye){ .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = 5.85, .limbus_aspect = aspect,
		.iris_depth = 3.3, .post_radius = 6.5, .post_asphericity = 0.75, .thickness = 0.55, .cornea_index = 1.376 };
}

static void fill(struct answer *out, const struct limbus_record *record)
{
	out->ok = record->ok;
	out->rough = record->rough;
	snprintf(out->reason, sizeof out->reason, "%s", record->reason);
	out->e = record->guess;
	if (!record->ok && !(record->rough > 0))
		return;
	out->has_pupil = record->view.has_pupil;
	out->pupil = record->view.pupil;
	ellipse_sigma(out->sigma, &out->e, record->view.cov_q);
	out->weak = acos(fmin(out->e.b / out->e.a, 1));
}

/* The pose of one that is ok, or known roughly, as the stage takes it. other: of a face's other eye; null: there is none. */
static void tilt(struct answer *out, struct limbus_record *record, const struct limbus_record *other, const struct eye *eye, const struct pose_conf *conf)
{
	struct limbus_joint joint, fellow;
	struct fellow_tilt said;
	struct pose pose;
	struct err err = { 0 };
	if (!record->ok || !limbus_joint(&joint, 1, record, eye, conf, &err))
		return;
	other = other && other->ok && limbus_joint(&fellow, 1, other, eye, conf, &err) && limbus_joint_tilt(&said, &fellow, other, eye, &err) ? other : 0;
	if (!limbus_joint_pose(&pose, &joint, record, other ? &said : 0, eye, &err))
		return;
	out->theta = pose.theta;
	out->theta_sigma = pose.theta_sigma;
}

static const struct camera_keys no_keys = { .focal_px = NAN, .focal_mm = NAN, .sensor_mm = NAN, .center_px = { NAN, NAN } };

void answer_ours(struct answer *out, const struct photo *photo, double aspect)
{
	const struct eye eye = eye_of(aspect);
	const struct limbus_camera known = { .keys = &no_keys, .focal_px = NAN };
	const struct pose_conf pose_conf = pose_conf_of();
	struct limbus_record *record = mem_new(1, sizeof *record);
	*out = (struct answer){ .theta = NAN, .theta_sigma = NAN, .weak = NAN };
	const double start = now();
	limbus_measure_photo(record, photo, 0, 0, &known, &eye, &limbus_defaults, &pose_conf);
	out->seconds = now() - start;
	fill(out, record);
	record->ok = record->ok || record->rough > 0;
	tilt(out, record, 0, &eye, &pose_conf);
	free(record);
}

int answer_face(struct answer out[2], const struct photo *photo, double aspect, bool mirrored)
{
	const struct eye eye = eye_of(aspect);
	const struct limbus_camera known = { .keys = &no_keys, .focal_px = NAN };
	const struct limbus_mark unmarked[2] = { 0 };
	const struct pose_conf pose_conf = pose_conf_of();
	struct limbus_record *record = mem_new(2, sizeof *record);
	for (int s = 0; s < 2; s++)
		out[s] = (struct answer){ .theta = NAN, .theta_sigma = NAN, .weak = NAN };
	const double start = now();
	const int n = limbus_measure_face(record, photo, unmarked, mirrored, &known, &eye, &limbus_defaults, &pose_conf);
	out[0].seconds = out[1].seconds = now() - start;
	for (int s = 0; s < n; s++) {
		fill(&out[s], &record[s]);
		record[s].ok = record[s].ok || record[s].rough > 0;
	}
	if (n == 2 && record[0].ok && record[1].ok)
		record[0].view.level = record[1].view.level = limbus_joint_level(&record[0], &record[1]);
	for (int s = 0; s < n; s++) {
		tilt(&out[s], &record[s], n == 2 ? &record[1 - s] : 0, &eye, &pose_conf);
	}
	free(record);
	return n;
}

const struct unseen_eye *answer_meant(const struct ellipse *got, const struct unseen *u)
{
	int best = 0;
	for (int i = 1; i < u->n; i++)
		if (ellipse_apart(got, &u->eye[i].limbus) / u->eye[i].limbus.a < ellipse_apart(got, &u->eye[best].limbus) / u->eye[best].limbus.a)
			best = i;
	return &u->eye[best];
}
