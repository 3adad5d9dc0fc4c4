/* Strips: where rays cross an ellipse, the likeliest ellipse of chances made by hand, a damaged network, eyes of another renderer, mirrored. */
#include "base/file.h"
#include "base/mem.h"
#include "limbus/strip_net.h"
#include "math/rng.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const char *const net_path = "config/strip.onnx";
static const struct strip_conf conf = { 6, 30, 100, 0.02, 0.3, 0.3, 4, { 0.5, 0.5 }, { 0.3, 0.1 } };

static void test_crossing(void **state)
{
	(void)state;
	const struct ellipse e = { 300, 200, 80, 66, 0.6 }, other = { 306, 193, 91, 74, 1.1 };
	for (int j = 0; j < STRIP_RAYS; j += 5) {
		double p[2], t;
		strip_place(p, &e, j, 1);
		assert_true(fabs(ellipse_distance(&t, &e, p)) < 1e-9);
		strip_place(p, &e, j, strip_crossing(&e, j, &other));
		assert_true(fabs(ellipse_distance(&t, &other, p)) < 1e-9);
	}
	// the first ray of a circle runs along +x, a quarter on along +y
	const struct ellipse circle = { 0, 0, 10, 10, 0 };
	double p[2];
	strip_place(p, &circle, STRIP_RAYS / 4, 0.5);
	assert_true(fabs(p[0]) < 1e-12 && fabs(p[1] - 5) < 1e-12);
	const struct ellipse far = { 100, 100, 10, 10, 0 };
	assert_true(isnan(strip_crossing(&circle, 0, &far)));
}

/* A flat evidence: the pixels tell nothing. */
static struct region_map flat_map(float *sum)
{
	return (struct region_map){ 2, 1, 0, 0, 1e6, sum };
}

/* Rays from `from` to `to` say where `truth` is, with a Gaussian error; of every tenth of them a collarette is taken for it. */
static void tell(struct strip *s, const struct ellipse *truth, int from, int to, struct rng *rng)
{
	for (int i = 0; i < STRIP_PIXELS; i++)
		s->row[i / STRIP_RAYS][i % STRIP_RAYS] = 1.0F / STRIP_ROWS;
	for (int j = from; j < to; j++) {
		const double at = (j % 10 == 3 ? 0.82 : 1) * strip_crossing(&s->e, j % STRIP_RAYS, truth) + 0.3 * STRIP_STEP * rng_normal(rng);
		double sum = 0;
		for (int i = 0; i < STRIP_ROWS; i++)
			sum += s->row[i][j % STRIP_RAYS] = (float)exp(-0.5 * pow((STRIP_FROM + (i + 0.5) * STRIP_STEP - at) / STRIP_STEP, 2));
		for (int i = 0; i < STRIP_ROWS; i++)
			s->row[i][j % STRIP_RAYS] /= (float)sum;
		s->seen[j % STRIP_RAYS] = 0.95F;
	}
}

static void check_fit(int from, int to, double within)
{
	static const double sigma[ELLIPSE_N] = { 20, 20, 20, 8, 8 };
	const struct ellipse truth = { 306, 194, 91, 86, 0.4 };
	float sum[3] = { 0 };
	const struct region_map map = flat_map(sum);
	struct strip *s = mem_new(1, sizeof *s);
	struct rng rng = { 11 };
	*s = (struct strip){ .e = { 300, 200, 84, 84, 0 }, .conf = conf };
	tell(s, &truth, from, to, &rng);
	struct ellipse e = s->e;
	struct ellipse_fit fit;
	double q[ELLIPSE_N], true_q[ELLIPSE_N];
	assert_true(strip_fit(&e, &fit, s, &map, sigma));
	ellipse_to_q(q, &e);
	ellipse_to_q(true_q, &truth);
	for (int i = 0; i < ELLIPSE_N; i++) {
		assert_true(fabs(q[i] - true_q[i]) < within);
		assert_true(fabs(q[i] - true_q[i]) < 4 * sqrt(fit.cov_q[i][i]));
	}
	assert_true(strip_worth(s, &truth) > strip_worth(s, &s->e));
	const struct strip_accord right = strip_accord_of(s, &truth), wrong = strip_accord_of(s, &s->e);
	assert_true(right.on > 0.8 && right.off < 0.15 && right.scatter < 0.01);
	assert_true(wrong.on < 0.5 && fabs(right.seen - 0.95 * (to - from) / STRIP_RAYS) < 1e-3);
	free(s);
}

static void test_fit(void **state)
{
	(void)state;
	check_fit(0, STRIP_RAYS, 0.4);
	check_fit(-20 + STRIP_RAYS, 84 + STRIP_RAYS, 0.9);
}

static void test_nothing_seen(void **state)
{
	(void)state;
	static const double sigma[ELLIPSE_N] = { 20, 20, 20, 8, 8 };
	float sum[3] = { 0 };
	const struct region_map map = flat_map(sum);
	struct strip *s = mem_new(1, sizeof *s);
	*s = (struct strip){ .e = { 300, 200, 84, 84, 0 }, .conf = conf };
	tell(s, &s->e, 0, 0, 0);
	struct ellipse e = s->e;
	struct ellipse_fit fit;
	assert_false(strip_fit(&e, &fit, s, &map, sigma));
	free(s);
}

static void test_files(void **state)
{
	(void)state;
	struct strip_net *net;
	struct err err = { 0 };
	assert_false(strip_open(&net, "config/none.onnx", &err));
	assert_non_null(strstr(err.msg, "config/none.onnx"));
	// a network of another kind
	err = (struct err){ 0 };
	assert_false(strip_open(&net, "config/evidence.onnx", &err));
	assert_non_null(strstr(err.msg, "config/evidence.onnx"));
	strip_close(0);
}

/* Cut short, a bit changed behind gzip's header, and with something behind it. */
static void test_damaged(void **state)
{
	(void)state;
	enum { HEADER = 10 };
	struct strip_net *net;
	struct err err = { 0 };
	char *data;
	size_t size;
	assert_true(file_read(&data, &size, net_path, 1 << 22, &err));
	struct rng rng = { 11 };
	for (int i = 0; i < 40; i++) {
		const size_t cut = i < 8 ? (size_t)i * size / 8 : i == 8 ? size + 1 : size, at = HEADER + (size_t)rng_below(&rng, (int)size - HEADER);
		const char bit = (char)(1 << rng_below(&rng, 8));
		data[at] ^= bit;
		const char *path = scratch_write("damaged.onnx", data, cut);
		data[at] ^= bit;
		err = (struct err){ 0 };
		assert_false(strip_open(&net, path, &err));
		ERR_HAS(err, "damaged");
		assert_null(strchr(err.msg, '\n'));
	}
	free(data);
}

struct world { struct evidence_net *evidence; struct strip_net *net; };

static struct world open_nets(void)
{
	struct world w;
	struct err err = { 0 };
	if (!evidence_open(&w.evidence, "config/evidence.onnx", &err) || !strip_open(&w.net, net_path, &err))
		fail_msg("%s", err.msg);
	return w;
}

/* The likeliest ellipse from a start that is OFF of the radius to the right (side 1) or left (-1) and as much too large. */
static struct ellipse answer(const struct world *w, const struct photo *photo, const struct ellipse *truth, int side)
{
	static const double OFF = 0.08;
	struct ellipse e = { truth->cx + side * OFF * truth->a, truth->cy, (1 + OFF) * truth->a, (1 + OFF) * truth->a, 0 };
	struct evidence evidence;
	struct ellipse_fit fit;
	struct err err = { 0 };
	struct strip *s = mem_new(1, sizeof *s);
	assert_true(evidence_window(&evidence, w->evidence, photo, e.cx, e.cy, e.a, &err));
	struct region_map map = region_map_make(&evidence);
	const double sigma[ELLIPSE_N] = { 0.1 * e.a, 0.1 * e.a, 0.1 * e.a, 0.05 * e.a, 0.05 * e.a };
	for (int k = 0; k < 3; k++) {
		assert_true(strip_read(s, w->net, photo, &evidence, &e, STRIP_MIRRORED, &conf, &err));
		assert_true(strip_fit(&e, &fit, s, &map, sigma));
	}
	free(s);
	region_map_free(&map);
	evidence_free(&evidence);
	return e;
}

static double apart(const struct ellipse *e, const struct ellipse *f)
{
	return fmax(hypot(e->cx - f->cx, e->cy - f->cy), fmax(fabs(e->a - f->a), fabs(e->b - f->b))) / f->a;
}

/* Eyes of a renderer that training never saw, and their mirror images. */
static void test_other_renderer(void **state)
{
	(void)state;
	struct world w = open_nets();
	int right = 0, n = 0;
	for (int i = 5; i < SYNTH_GRID; i += SANITISED ? 96 : 24, n++) {
		struct synth_eye eye = synth_eye_grid(i);
		struct synth_truth truth;
		struct photo photo = synth_eye_render(&eye, &truth), other = photo;
		const struct ellipse e = answer(&w, &photo, &truth.limbus, 1);
		right += apart(&e, &truth.limbus) < 0.03;
		other.rgb = mem_array((size_t)photo.width * (size_t)photo.height * 3, sizeof *other.rgb);
		for (int y = 0; y < photo.height; y++)
			for (int x = 0; x < 3 * photo.width; x++)
				other.rgb[3L * y * photo.width + x] = photo.rgb[3L * (y * photo.width + photo.width - 1 - x / 3) + x % 3];
		struct ellipse meant = truth.limbus;
		meant.cx = photo.width - meant.cx;
		struct ellipse turned = answer(&w, &other, &meant, -1);
		turned.cx = photo.width - turned.cx;
		turned.angle = M_PI - turned.angle;
		assert_true(apart(&turned, &e) < 0.01);
		free(other.rgb);
		photo_free(&photo);
	}
	assert_true(right >= 0.7 * n);
	strip_close(w.net);
	evidence_close(w.evidence);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_crossing), cmocka_unit_test(test_fit), cmocka_unit_test(test_nothing_seen),
		                            cmocka_unit_test(test_files), SCRATCH_TEST(test_damaged), cmocka_unit_test(test_other_renderer) };
	return cmocka_run_group_tests(tests, 0, 0);
}
