/* How a head is turned: rotations put together here from axes and angles, and the network on a face of the bundled film, that must not be told otherwise where its
 * picture is mirrored, leans, is small, dark or red.
 */
#include "base/mem.h"
#include "image/video/video.h"
#include "track/head/turn.h"
#include "tests/lib/unit.h"

static const double DEGREE = M_PI / 180;

/* v turned about a unit axis (Rodrigues). */
static void about(double v[3], const double axis[3], double angle)
{
	const double c = cos(angle), s = sin(angle), along = v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2];
	const double out[3] = { c * v[0] + s * (axis[1] * v[2] - axis[2] * v[1]) + (1 - c) * along * axis[0],
		                    c * v[1] + s * (axis[2] * v[0] - axis[0] * v[2]) + (1 - c) * along * axis[1],
		                    c * v[2] + s * (axis[0] * v[1] - axis[1] * v[0]) + (1 - c) * along * axis[2] };
	memcpy(v, out, sizeof out);
}

/* The picture of a point of the head, in the camera: nodded, then turned to its left, faced to the camera, leaning in the picture, and the whole moved to where ray looks. */
static void placed(double v[3], double aside, double nod, double lean, const double ray[3])
{
	const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 }, z[3] = { 0, 0, 1 };
	about(v, x, nod);
	about(v, y, aside);
	about(v, x, M_PI);
	about(v, z, lean);
	about(v, x, -atan2(ray[1], hypot(ray[0], ray[2])));
	about(v, y, atan2(ray[0], ray[2]));
}

static void rotations(void **state)
{
	(void)state;
	for (int k = 0; k < 60; k++) {
		const double angle[TURNS] = { 0.6 * sin(k), 0.5 * sin(1.7 * k) }, lean = 3 * sin(0.6 * k), ray[3] = { 0.5 * sin(2.3 * k), 0.4 * cos(1.1 * k), 0.9 };
		double m[3][3], back[TURNS], lean_back, pose[4][4] = { [3][3] = 1 };
		turn_rotation(m, angle, lean, ray);
		for (int c = 0; c < 3; c++) {
			double v[3] = { c == 0, c == 1, c == 2 };
			placed(v, angle[TURN_ASIDE], angle[TURN_NOD], lean, ray);
			for (int i = 0; i < 3; i++) {
				NEAR(m[i][c], v[i], 1e-12);
				pose[i][c] = m[i][c];
			}
		}
		turn_of(back, &lean_back, (const double(*)[4])pose, ray);
		NEAR(back[TURN_ASIDE], angle[TURN_ASIDE], 1e-12);
		NEAR(back[TURN_NOD], angle[TURN_NOD], 1e-12);
		NEAR(lean_back, lean, 1e-12);
	}
}

struct face {
	int width, height;
	uint8_t *rgb;
	double eye[2][2];
};

/* The bundled film's first picture; middles between its eyes' corners, of which its truth tells. The head faces the camera. */
static struct face first_face(void)
{
	struct video_conf conf = { .threads = 1, .limit_mpx = 10, .limit_frames = 100000 };
	struct video_info info;
	struct video_frame frame;
	struct err err = { 0 };
	bool got;
	struct video *video = video_open(&info, "samples/face/video/face.mp4", &conf, &err);
	if (!video || !video_next(&frame, &got, video, &err) || !got)
		fail_msg("%s", err.msg);
	struct face f = { info.width, info.height, mem_array((size_t)info.width * (size_t)info.height, 3), { { 1004, 368 }, { 290, 368 } } };
	video_frame_rgb(f.rgb, 3 * f.width, &frame, 0, 0, f.width, f.height);
	video_frame_free(&frame);
	video_close(video);
	return f;
}

/* Each pixel from (x, y) of the other picture, bilinear; beyond its border that goes on. */
static struct face drawn(const struct face *of, int width, int height, const double from[2][3])
{
	struct face f = { .width = width, .height = height, .rgb = mem_array((size_t)width * (size_t)height, 3) };
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			for (int c = 0; c < 3; c++) {
				const double u = fmin(fmax(from[0][0] * (x + 0.5) + from[0][1] * (y + 0.5) + from[0][2] - 0.5, 0), of->width - 1.001);
				const double v = fmin(fmax(from[1][0] * (x + 0.5) + from[1][1] * (y + 0.5) + from[1][2] - 0.5, 0), of->height - 1.001);
				const uint8_t *p = of->rgb + 3 * ((long)v * of->width + (long)u) + c, *q = p + 3L * of->width;
				const double a = u - floor(u), b = v - floor(v);
				f.rgb[3 * ((long)y * width + x) + c] = (uint8_t)((1 - b) * ((1 - a) * p[0] + a * p[3]) + b * ((1 - a) * q[0] + a * q[3]) + 0.5);
			}
	const double det = from[0][0] * from[1][1] - from[0][1] * from[1][0];
	for (int e = 0; e < 2; e++) {
		const double u = of->eye[e][0] - from[0][2], v = of->eye[e][1] - from[1][2];
		f.eye[e][0] = (from[1][1] * u - from[0][1] * v) / det;
		f.eye[e][1] = (from[0][0] * v - from[1][0] * u) / det;
	}
	return f;
}

static struct head_turn seen(struct turn_net *net, const struct face *f)
{
	struct head_turn turn;
	struct err err = { 0 };
	if (!turn_see(&turn, net, f->rgb, f->width, f->height, (const double(*)[2])f->eye, &err))
		fail_msg("%s", err.msg);
	return turn;
}

static void a_face_in_other_pictures(void **state)
{
	(void)state;
	struct turn_net *net;
	struct err err = { 0 };
	assert_true(turn_open(&net, "config/turn.onnx", &err));
	const struct face f = first_face();
	const struct head_turn told = seen(net, &f);
	// it faces the camera; the picture shows neither mouth nor chin
	for (int k = 0; k < TURNS; k++) {
		assert_true(told.sigma[k] > 0.005 && told.sigma[k] < 0.3);
		NEAR(told.angle[k], 0, 3 * told.sigma[k]);
	}
	const double c = cos(0.5), s = sin(0.5);
	const double from[4][2][3] = { { { -1, 0, 1280 }, { 0, 1, 0 } }, { { c, -s, 300 }, { s, c, -300 } }, { { 5, 0, 0 }, { 0, 5, 0 } }, { { 0.84, 0, 102 }, { 0, 0.84, 20 } } };
	for (int k = 0; k < 4; k++) {
		struct face g = drawn(&f, k == 2 ? 256 : 1280, k == 2 ? 144 : 900, from[k]);
		if (k == 0)
			for (int i = 0; i < 2; i++) {
				const double x = g.eye[0][i];
				g.eye[0][i] = g.eye[1][i];
				g.eye[1][i] = x;
			}
		const struct head_turn now = seen(net, &g);
		// two of them show another part of the face
		for (int a = 0; a < TURNS; a++)
			NEAR(now.angle[a], (k == 0 && a == TURN_ASIDE ? -1 : 1) * told.angle[a], k == 0 ? 1e-3 : k == 2 ? 1.5 * DEGREE : now.sigma[a]);
		free(g.rgb);
	}
	struct face dark = drawn(&f, f.width, f.height, (const double[2][3]){ { 1, 0, 0 }, { 0, 1, 0 } });
	for (long i = 0; i < (long)f.width * f.height; i++) {
		dark.rgb[3 * i] = (uint8_t)(0.8 * dark.rgb[3 * i]);
		dark.rgb[3 * i + 1] = (uint8_t)(0.55 * dark.rgb[3 * i + 1]);
		dark.rgb[3 * i + 2] = (uint8_t)(0.4 * dark.rgb[3 * i + 2]);
	}
	const struct head_turn now = seen(net, &dark);
	for (int k = 0; k < TURNS; k++)
		NEAR(now.angle[k], told.angle[k], 1.5 * DEGREE);
	turn_close(net);
	free(f.rgb);
	free(dark.rgb);
}

/* What is read lies in the box that is told, for eyes anywhere. */
static void what_is_read(void **state)
{
	(void)state;
	struct turn_net *net;
	struct err err = { 0 };
	assert_true(turn_open(&net, "config/turn.onnx", &err));
	enum { WIDE = 320, HIGH = 240 };
	uint8_t *rgb = mem_array(WIDE * HIGH, 3), *other = mem_array(WIDE * HIGH, 3);
	const double eyes[4][2][2] = { { { 190, 100 }, { 130, 110 } }, { { 20, 10 }, { -30, 15 } }, { { 100, 200 }, { 160, 40 } }, { { 305, 235 }, { 300, 239 } } };
	for (int k = 0; k < 4; k++) {
		int box[4];
		assert_true(turn_reach(box, eyes[k], WIDE, HIGH));
		assert_true(box[0] >= 0 && box[1] >= 0 && box[2] <= WIDE && box[3] <= HIGH);
		for (int y = 0; y < HIGH; y++)
			for (int x = 0; x < 3 * WIDE; x++) {
				const bool in = x >= 3 * box[0] && x < 3 * box[2] && y >= box[1] && y < box[3];
				rgb[y * 3 * WIDE + x] = (uint8_t)((x * 7 + y * 13) % 251);
				other[y * 3 * WIDE + x] = in ? rgb[y * 3 * WIDE + x] : 255;
			}
		const struct face a = { WIDE, HIGH, rgb, { { eyes[k][0][0], eyes[k][0][1] }, { eyes[k][1][0], eyes[k][1][1] } } };
		struct face b = a;
		b.rgb = other;
		const struct head_turn one = seen(net, &a), two = seen(net, &b);
		assert_true(!memcmp(&one, &two, sizeof one));
	}
	int box[4];
	assert_false(turn_reach(box, (const double[2][2]){ { 5, 5 }, { 5, 5 } }, WIDE, HIGH));
	assert_false(turn_reach(box, (const double[2][2]){ { 9000, 5 }, { 8990, 5 } }, WIDE, HIGH));
	turn_close(net);
	free(rgb);
	free(other);
}

static void files(void **state)
{
	(void)state;
	struct turn_net *net;
	struct err err = { 0 };
	assert_false(turn_open(&net, "config/none.onnx", &err));
	ERR_HAS(err, "config/none.onnx");
	err = (struct err){ 0 };
	assert_false(turn_open(&net, "config/evidence.onnx", &err));  // of another kind
	ERR_HAS(err, "config/evidence.onnx");
	turn_close(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rotations),
		cmocka_unit_test(a_face_in_other_pictures),
		cmocka_unit_test(what_is_read),
		cmocka_unit_test(files),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
