/* The aspect of a limbus that is not declared, and the tilt that follows: ellipses projected point by point, of eyes as people's are. */
#include "anatomy/fit.h"
#include "limbus/joint.h"
#include "limbus/tilt.h"
#include "math/ellipse_fit.h"
#include "math/rng.h"
#include "math/vec.h"
#include "tests/lib/unit.h"

static const double DEG = M_PI / 180;
static const double NOISE = 4e-3, HIDDEN = 2e-2;  // sigma of the ellipse's parameters, semi-axes: all of it seen, half of it hidden

static const struct pose_conf people = { .pupil_offset_sigma = 0.15, .depth_sigma = 0.25, .pupil_floor = 0.012, .aspect_mean = 0.925, .aspect_sigma = 0.025,
	.roll_sigma = 4 * M_PI / 180, .tilt_sigma = 30 * M_PI / 180,
	.side_trust = 0.2, .opening = { .arm = 9.7, .sigma = 11 * M_PI / 180, .misled = 0.05 },
	.fellow = { .apart = 6 * M_PI / 180, .apart_sigma = 5 * M_PI / 180, .level_sigma = 2 * M_PI / 180, .squint = 0.03 }, };
static const struct eye unknown = { .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = 5.85, .limbus_aspect = NAN, .iris_depth = 3.3 };

static void axis_of(double z[3], double theta, double phi)
{
	z[0] = sin(theta) * cos(phi);
	z[1] = sin(theta) * sin(phi);
	z[2] = cos(theta);
}

/* What a camera far away sees of the limbus of an eye `place` mm to the right, with noise of so many semi-axes. axis: its z in the camera's frame, towards the photographer's back. */
static void look_at(struct limbus_record *record, const double place[2], const double axis[3], double aspect, double roll, double share, struct rng *noise)
{
	enum { N = 48 };
	struct fit fit = { .camera = { .focal_px = 20000, .center_px = { 800, 600 }, .source = CAMERA_CONF } };
	double R[3][3], p[N][2], q[ELLIPSE_N];
	mat_smallest_rotation(R, (double[3]){ 0, 0, 1 }, axis);
	for (int i = 0; i < 3; i++)
		memcpy(fit.cam_from_eye[i], R[i], sizeof R[i]);
	for (int i = 0; i < 2; i++)
		fit.cam_from_eye[i][3] = place[i];
	fit.cam_from_eye[2][3] = 300;
	fit.cam_from_eye[3][3] = 1;
	for (int i = 0; i < N; i++) {
		const double t = 2 * M_PI * i / N, x = unknown.limbus_radius * cos(t), y = unknown.limbus_radius * aspect * sin(t);
		const double P[3] = { x * cos(roll) - y * sin(roll), x * sin(roll) + y * cos(roll), eye_limbus_depth(&unknown) };
		assert_true(fit_project(p[i], &fit, P));
	}
	*record = (struct limbus_record){ .ok = true, .view.camera = fit.camera };
	assert_true(ellipse_fit_direct(&record->view.limbus, N, p, 0));
	const double sigma = share * record->view.limbus.a;
	ellipse_to_q(q, &record->view.limbus);
	for (int i = 0; i < ELLIPSE_N; i++) {
		q[i] += noise ? sigma * rng_normal(noise) : 0;
		record->view.cov_q[i][i] = sigma * sigma;
	}
	ellipse_from_q(&record->view.limbus, q);
}

static void look(struct limbus_record *record, const double axis[3], double aspect, double roll, double share, struct rng *noise)
{
	look_at(record, (double[2]){ 0 }, axis, aspect, roll, share, noise);
}

static double between(const double pose[4][4], const double axis[3])
{
	double dot = 0;
	for (int i = 0; i < 3; i++)
		dot += pose[i][2] * axis[i];
	return acos(fmin(dot, 1));
}

/* A shape alone tells two poses, to either side: the nearer one's error. */
static double astray(const struct pose *pose, const double axis[3])
{
	return fmin(between(pose->cam_from_eye, axis), between(pose->other_cam_from_eye, axis));
}

static void pose_of(struct pose *pose, struct limbus_joint *joint, int n, const struct limbus_record records[n])
{
	struct err err = { 0 };
	assert_true(limbus_joint(joint, n, records, &unknown, &people, &err));
	assert_true(limbus_joint_pose(pose, joint, &records[0], 0, &unknown, &err));
}

/* The start of the search is the answer where the camera is far away: any tilt, any aspect. */
static void the_start_is_in_closed_form(void **state)
{
	(void)state;
	for (double aspect = 0.85; aspect < 1.06; aspect += 0.05)
		for (double theta = 2; theta <= 50; theta += 12)
			for (double phi = 5; phi < 180; phi += 25) {
				struct limbus_record record;
				double axis[3], tilt, across;
				axis_of(axis, theta * DEG, phi * DEG);
				look(&record, axis, aspect, 0, NOISE, 0);
				struct ellipse e = record.view.limbus;
				const double center[2] = { 800 - e.cx, 600 - e.cy };
				e.cx = e.cy = 0;
				limbus_tilt(&tilt, &across, &e, center, 20000, aspect, 0);
				NEAR(tilt, theta * DEG, 1.2 * DEG);
				NEAR(theta * sin(across - phi * DEG), 0, 1.2);
			}
}

/* A round limbus that is tilted up looks like an oval one that is tilted aside. The brightness of its iris says up: not for sure. */
static void both_hills_are_told(void **state)
{
	(void)state;
	for (int sure = 0; sure < 2; sure++) {
		struct limbus_record record;
		struct limbus_joint joint;
		struct pose pose;
		double axis[3];
		axis_of(axis, 10 * DEG, 80 * DEG);
		look(&record, axis, 1, 0, NOISE, 0);
		record.view.lean[1] = (sure ? 60 : 12) / people.side_trust;  // half of that, of what counts, is what a tilt up is likelier than one aside
		pose_of(&pose, &joint, 1, &record);
		NEAR(joint.aspect.likeliest, 1, 0.03);
		assert_true(sure ? joint.aspect.elsewhere < 0.01 : joint.aspect.elsewhere > 0.03 && joint.aspect.elsewhere < 0.6);
		assert_true(sure || aspect_spread(&joint.aspect) > joint.aspect.sigma);
		for (int i = 0; i < ASPECT_RIVALS && !sure; i++)
			assert_true(joint.aspect.rival[i] < 0.985);
		assert_true(between(pose.cam_from_eye, axis) < 2 * pose.theta_sigma && pose.theta_sigma < (sure ? 5 : 12) * DEG);
	}
}

/* People's eyes, looking anywhere within 30 degrees of the lens: sigmas hold. */
static void sigmas_hold(void **state)
{
	(void)state;
	enum { EYES = 120 };
	struct rng rng = { 11 };
	int within[2] = { 0 };
	for (int i = 0; i < EYES; i++) {
		struct limbus_record record;
		struct limbus_joint joint;
		struct pose pose;
		double axis[3];
		const double theta = 30 * DEG * sqrt(rng_uniform(&rng)), phi = 2 * M_PI * rng_uniform(&rng);
		const double aspect = people.aspect_mean + people.aspect_sigma * rng_normal(&rng), roll = people.roll_sigma * rng_normal(&rng);
		axis_of(axis, theta, phi);
		look(&record, axis, aspect, roll, NOISE, &rng);
		pose_of(&pose, &joint, 1, &record);
		for (int k = 0; k < 2; k++)
			within[k] += astray(&pose, axis) < (k + 1) * pose.theta_sigma;
	}
	if (within[0] < 0.55 * EYES || within[1] < 0.92 * EYES)
		fail_msg("of %d axes %d lie within a sigma, %d within two", EYES, within[0], within[1]);
}

/* People who look into the lens, as near to it as their optical axes are to their sight, lids over half of the limbus: nothing tells the two sides from each other. The
 * answer is nearer to the truth than either pose, and says how near. */
static void who_looks_into_the_lens_is_not_turned_aside(void **state)
{
	(void)state;
	enum { EYES = 120 };
	struct rng rng = { 5 };
	double square[2] = { 0 };
	int front = 0, within = 0;
	for (int i = 0; i < EYES; i++) {
		struct limbus_record record;
		struct limbus_joint joint;
		struct pose pose, alone;
		struct err err = { 0 };
		double axis[3];
		axis_of(axis, 6 * DEG * sqrt(rng_uniform(&rng)), 2 * M_PI * rng_uniform(&rng));
		const double aspect = people.aspect_mean + people.aspect_sigma * rng_normal(&rng), roll = people.roll_sigma * rng_normal(&rng);
		look(&record, axis, aspect, roll, HIDDEN, &rng);
		pose_of(&pose, &joint, 1, &record);
		assert_true(limbus_pose(&alone, &record.view, &unknown, &joint.pose, &err));
		const double off = between(pose.cam_from_eye, axis);
		square[0] += pow(off, 2) / EYES;
		square[1] += pow(between(alone.cam_from_eye, axis), 2) / EYES;
		front += pose.theta < 2 * pose.theta_sigma;
		within += off < 2 * pose.theta_sigma;
	}
	if (front < 0.9 * EYES || within < 0.9 * EYES || square[0] > 0.5 * square[1])
		fail_msg("of %d eyes %d are within two sigmas of the front, %d of the truth; %.1f degrees off, by the likelier pose %.1f", EYES, front, within,
		         sqrt(square[0]) / DEG, sqrt(square[1]) / DEG);
}

/* An eye that looks far aside has a side, though nothing tells which. */
static void who_looks_aside_is(void **state)
{
	(void)state;
	for (double theta = 20; theta <= 40; theta += 10) {
		struct limbus_record record;
		struct limbus_joint joint;
		struct pose pose;
		double axis[3];
		axis_of(axis, theta * DEG, 15 * DEG);
		look(&record, axis, people.aspect_mean, 0, NOISE, 0);
		pose_of(&pose, &joint, 1, &record);
		assert_true(pose.theta > 0.6 * theta * DEG && astray(&pose, axis) < 2 * pose.theta_sigma);
	}
}

/* Faces, heads held up to 25 degrees aslant, lids over half of each limbus; nothing but the corners of the lids of one of the two eyes, and that both look the same way, tells the sides.
 * People's axes lie outside of their sight, which meets anywhere beyond 0.5 m. */
static void both_eyes_of_a_face_tell_more(void **state)
{
	(void)state;
	enum { FACES = 100 };
	struct rng rng = { 23 };
	double square[2] = { 0 };
	int within = 0, wrong[2] = { 0 }, aside = 0;
	for (int i = 0; i < FACES; i++) {
		struct limbus_record record[2];
		struct limbus_joint joint[2];
		struct fellow_tilt tilt;
		struct pose pose[2];
		struct err err = { 0 };
		const double level = 50 * DEG * (rng_uniform(&rng) - 0.5), theta = 25 * DEG * sqrt(rng_uniform(&rng)), phi = 2 * M_PI * rng_uniform(&rng);
		const double aspect = people.aspect_mean + people.aspect_sigma * rng_normal(&rng), apart = (10 - 7 * rng_uniform(&rng) + 2 * rng_normal(&rng)) * DEG;
		double axis[2][3];
		for (int s = 0; s < 2; s++) {
			const double sign = s ? -1 : 1, place[2] = { sign * 31 * cos(level), sign * 31 * sin(level) };
			const double x = theta * cos(phi) - sign * apart / 2 * cos(level), y = theta * sin(phi) - sign * apart / 2 * sin(level);
			axis_of(axis[s], hypot(x, y), atan2(y, x));
			look_at(&record[s], place, axis[s], aspect, level, HIDDEN, &rng);
			record[s].view.level = level;
		}
		// z goes into the eye: it looks to the other side. Corners 14 mm to both sides of where it turns about, 10 mm behind its limbus.
		const double moved = -10 * (axis[0][0] * cos(level) + axis[0][1] * sin(level));
		record[0].view.reach[0] = (14 + moved) / unknown.limbus_radius;
		record[0].view.reach[1] = (14 - moved) / unknown.limbus_radius;
		for (int s = 0; s < 2; s++)
			assert_true(limbus_joint(&joint[s], 1, &record[s], &unknown, &people, &err));
		assert_true(limbus_joint_tilt(&tilt, &joint[0], &record[0], &unknown, &err));
		assert_true(limbus_joint_pose(&pose[0], &joint[1], &record[1], 0, &unknown, &err) && limbus_joint_pose(&pose[1], &joint[1], &record[1], &tilt, &unknown, &err));
		const bool far = hypot(axis[1][0], axis[1][1]) > 8 * DEG && fabs(theta * cos(phi - level)) > 8 * DEG;
		aside += far;
		for (int k = 0; k < 2; k++) {
			const double off = between(pose[k].cam_from_eye, axis[1]);
			square[k] += off * off / FACES;
			wrong[k] += far && pose[k].cam_from_eye[0][2] * axis[1][0] + pose[k].cam_from_eye[1][2] * axis[1][1] < 0;
			within += k && off < 2 * pose[k].theta_sigma;
		}
	}
	if (wrong[1] > 0.1 * aside || wrong[0] < 0.3 * aside || square[1] > 0.5 * square[0] || within < 0.8 * FACES)  // of a plane, 0.865 lie within two of each of its sigmas
		fail_msg("of %d eyes that look aside %d are turned to the wrong side, alone %d; %.1f degrees off, alone %.1f; %d of %d within two sigmas", aside, wrong[1], wrong[0],
		         sqrt(square[1]) / DEG, sqrt(square[0]) / DEG, within, FACES);
}

/* A picture that stands otherwise, and its mirror image, say the same of both eyes; so does either eye of the other. */
static void faces_have_no_side(void **state)
{
	(void)state;
	struct fellow_said said[4];
	struct fellow_tilt a = { .seen = 14 * DEG, .towards = 20 * DEG, .margin = 0.5, .prior = 30 * DEG, .place = { 31, 2, 600 }, .radius = 5.85, .reach = { 2, 1.6 } },
	                   b = { .seen = 9 * DEG, .towards = 195 * DEG, .margin = 0.2, .prior = 30 * DEG, .place = { -31, 1, 600 }, .radius = 5.85 };
	for (int i = 0; i < 2; i++)
		a.cov[i][i] = b.cov[i][i] = pow(0.02, 2);
	assert_true(fellow_tilt_of(&said[0], &a, &b, &people.fellow, &people.opening) && fellow_tilt_of(&said[1], &b, &a, &people.fellow, &people.opening));
	struct fellow_tilt *both[2] = { &a, &b };
	for (int i = 0; i < 2; i++) {
		both[i]->towards = M_PI - both[i]->towards;
		both[i]->place[0] *= -1;
		const double reach = both[i]->reach[0];
		both[i]->reach[0] = both[i]->reach[1];
		both[i]->reach[1] = reach;
	}
	assert_true(fellow_tilt_of(&said[2], &a, &b, &people.fellow, &people.opening) && fellow_tilt_of(&said[3], &b, &a, &people.fellow, &people.opening));
	for (int i = 0; i < 2; i++) {
		NEAR(said[2 + i].hill[0], -said[i].hill[0], 1e-9);
		NEAR(said[2 + i].hill[1], said[i].hill[1], 1e-9);
		NEAR(said[2 + i].margin, said[i].margin, 1e-9);
		NEAR(said[2 + i].hill_sigma, said[i].hill_sigma, 1e-9);
	}
	// both look the same way: one of them is turned over
	assert_true(said[0].turned != said[1].turned);
	a.place[0] = b.place[0];
	a.place[1] = b.place[1];
	assert_false(fellow_tilt_of(&said[0], &a, &b, &people.fellow, &people.opening));
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(the_start_is_in_closed_form), cmocka_unit_test(both_hills_are_told),
		cmocka_unit_test(sigmas_hold), cmocka_unit_test(who_looks_into_the_lens_is_not_turned_aside), cmocka_unit_test(who_looks_aside_is),
		cmocka_unit_test(both_eyes_of_a_face_tell_more), cmocka_unit_test(faces_have_no_side) };
	return cmocka_run_group_tests(tests, 0, 0);
}
