/* The iris of frames of a film, against eyes drawn here by rays of their own: a sphere for a cornea, where the product has a conic of another radius, an iris at
 * another depth, poses that are a little off, lamps mirrored in the cornea, lids, noise. */
#include "base/mem.h"
#include "draw/photo/filmed.h"
#include "math/rng.h"
#include "math/vec.h"
#include "tests/lib/unit.h"

enum { W = 360, H = 240, N = 16, MARGIN = 24 };
static const double away = 600, focal = 7000, R = 7.5, depth = 3.1, limbus = 5.85, globe = 11.8, pupil = 2.1, index_ = 1.336;
static const double white[3] = { 0.66, 0.6, 0.54 };
static const struct eye usual = { .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = 5.85, .limbus_aspect = 1, .iris_depth = 3.3 };

/* Albedo of the iris at (x, y) mm: a brown ring in green, and fibres in closed form. */
static void iris_of(double rgb[3], double x, double y)
{
	const double r = hypot(x, y), a = atan2(y, x), ring = exp(-pow((r - 3) / 0.6, 2)), fibre = exp(0.35 * sin(23 * a + 2 * sin(1.7 * r)) + 0.25 * cos(9 * a - 2.2 * r));
	static const double green[3] = { 0.07, 0.09, 0.04 }, brown[3] = { 0.13, 0.07, 0.025 };
	for (int c = 0; c < 3; c++)
		rgb[c] = r < pupil ? 0.003 : fibre * (green[c] + ring * (brown[c] - green[c]));
}

static uint8_t srgb_of(double linear)
{
	const double v = linear < 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
	return (uint8_t)fmin(fmax(lrint(255 * v), 0), 255);
}

/* A ray o + t d of the eye's frame (apex at 0, z into the eye): what it sees under light of that colour. lamp: directions to two lamps. */
static void ray(double rgb[3], const double o[3], const double d[3], const double lamp[2][3])
{
	const double oc[3] = { o[0], o[1], o[2] - R }, b = vec_dot(oc, d), q = b * b - vec_dot(oc, oc) + R * R, t = -b - sqrt(fmax(q, 0));
	const double k[3] = { o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2] };
	if (q > 0 && hypot(k[0], k[1]) < limbus) {
		double n[3] = { k[0] / R, k[1] / R, (k[2] - R) / R }, mirror[3], in[3];
		const double eta = 1 / index_, ci = -vec_dot(n, d), ct = sqrt(1 - eta * eta * (1 - ci * ci));
		for (int c = 0; c < 3; c++) {
			in[c] = eta * d[c] + (eta * ci - ct) * n[c];
			mirror[c] = d[c] + 2 * ci * n[c];
		}
		const double s = (depth - k[2]) / in[2];
		iris_of(rgb, k[0] + s * in[0], k[1] + s * in[1]);
		for (int l = 0; l < 2; l++)
			for (int c = 0; c < 3 && vec_dot(mirror, lamp[l]) > cos(0.12); c++)
				rgb[c] += l ? 0.25 : 0.9;
		return;
	}
	const double rim = R - sqrt(R * R - limbus * limbus), mid = rim + sqrt(globe * globe - limbus * limbus);
	const double os[3] = { o[0], o[1], o[2] - mid }, bs = vec_dot(os, d);
	const bool hit = bs * bs - vec_dot(os, os) + globe * globe > 0;
	for (int c = 0; c < 3; c++)
		rgb[c] = hit ? white[c] : 0.2;
}

struct frame {
	uint8_t *rgb;
	struct fit fit;
	float upper[MARGIN][2], lower[MARGIN][2];
};

/* cam_from_eye of an eyeball turned so about its centre. */
static void pose(struct fit *fit, double h, double v)
{
	const double mid = R - sqrt(R * R - limbus * limbus) + sqrt(globe * globe - limbus * limbus);
	const double turn[3][3] = { { cos(h), -sin(h) * sin(v), -sin(h) * cos(v) }, { 0, cos(v), -sin(v) }, { sin(h), cos(h) * sin(v), cos(h) * cos(v) } };
	*fit = (struct fit){ .ok = true, .camera = { .focal_px = focal, .center_px = { W / 2.0, H / 2.0 }, .source = CAMERA_CONF }, .width = W, .height = H };
	for (int i = 0; i < 3; i++) {
		memcpy(fit->cam_from_eye[i], turn[i], sizeof turn[i]);
		fit->cam_from_eye[i][3] = -turn[i][2] * mid + (i == 2 ? away : 0);
	}
	fit->cam_from_eye[3][3] = 1;
}

/* A frame by light of that colour, the eye turned by h and v; opening: mm between the lids. The pose that is told is off by `wrong` radians. */
static struct frame frame_of(double h, double v, double opening, const double light[3], double wrong, struct rng *rng)
{
	struct frame f = { .rgb = mem_new((size_t)3 * W * H, 1) };
	const double px = focal / away;
	pose(&f.fit, h, v);
	double head[2][3] = { { -0.35, -0.4, -0.84 }, { 0.3, -0.1, -0.95 } }, lamp[2][3];
	for (int l = 0; l < 2; l++) {
		vec_unit(head[l], head[l]);
		for (int k = 0; k < 3; k++)
			lamp[l][k] = f.fit.cam_from_eye[0][k] * head[l][0] + f.fit.cam_from_eye[1][k] * head[l][1] + f.fit.cam_from_eye[2][k] * head[l][2];
	}
	for (int i = 0; i < MARGIN; i++) {
		const double t = 2 * i / (MARGIN - 1.0) - 1;
		f.upper[i][0] = f.lower[i][0] = (float)(W / 2.0 + 14 * px * t);
		f.upper[i][1] = (float)(H / 2.0 - 0.45 * opening * px * (1 - t * t));
		f.lower[i][1] = (float)(H / 2.0 + 0.55 * opening * px * (1 - t * t));
	}
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			const double t = (x + 0.5 - W / 2.0) / (14 * px), top = H / 2.0 - 0.45 * opening * px * (1 - t * t), low = H / 2.0 + 0.55 * opening * px * (1 - t * t);
			double sum[3] = { 0 };
			for (int k = 0; k < 4; k++) {
				double rgb[3] = { 0.35, 0.2, 0.13 }, o[3], d[3], in_cam[3] = { (x + 0.25 + k % 2 * 0.5 - W / 2.0) / focal, (y + 0.25 + k / 2 * 0.5 - H / 2.0) / focal, 1 };
				if (fabs(t) < 1 && y + 0.5 > top && y + 0.5 < low) {
					vec_unit(in_cam, in_cam);
					for (int c = 0; c < 3; c++) {
						o[c] = d[c] = 0;
						for (int i = 0; i < 3; i++) {
							o[c] -= f.fit.cam_from_eye[i][c] * f.fit.cam_from_eye[i][3];
							d[c] += f.fit.cam_from_eye[i][c] * in_cam[i];
						}
					}
					ray(rgb, o, d, (const double(*)[3])lamp);
				}
				for (int c = 0; c < 3; c++)
					sum[c] += rgb[c] / 4;
			}
			for (int c = 0; c < 3; c++)
				f.rgb[3 * (y * W + x) + c] = (uint8_t)fmin(fmax(srgb_of(light[c] * sum[c]) + 1.5 * rng_normal(rng), 0), 255);
		}
	pose(&f.fit, h + wrong * rng_normal(rng), v + wrong * rng_normal(rng));
	return f;
}

static bool make(struct scene_seen *seen, struct filmed_report *report, const double light[3], double opening, int n, struct err *err)
{
	struct filmed *film = filmed_new(&usual, globe, white);
	struct rng rng = { 5 };
	for (int i = 0; i < n; i++) {
		struct frame f = frame_of(0.22 * sin(2.4 * i), 0.14 * cos(3.7 * i), opening, light, 0.006, &rng);
		filmed_add(film, &(struct filmed_view){ f.rgb, &f.fit, (const float(*)[2])f.upper, (const float(*)[2])f.lower, MARGIN });
		free(f.rgb);
	}
	const bool ok = filmed_make(seen, report, film, err);
	filmed_free(film);
	return ok;
}

static void place(double at[2], const struct scene_seen *s, int i)
{
	at[0] = (i % SEEN_SIDE + 0.5) * 2 * s->extent / SEEN_SIDE - s->extent;
	at[1] = (i / SEEN_SIDE + 0.5) * 2 * s->extent / SEEN_SIDE - s->extent;
}

struct likeness {
	double offset[3], rms, correlation, share, brightest;
};

/* Of what is seen between pupil and limbus: each colour's mean error of ln, the rest's rms, the correlation of green, the share seen, the largest error of a texel. */
static struct likeness compare(const struct scene_seen *s)
{
	double n = 0, all = 0, sum[3] = { 0 }, a = 0, b = 0, aa = 0, bb = 0, ab = 0, off = 0;
	struct likeness out = { .brightest = -INFINITY };
	for (int i = 0; i < SEEN_SIDE * SEEN_SIDE; i++) {
		double at[2], rgb[3];
		place(at, s, i);
		const double r = hypot(at[0], at[1]);
		if (r < 2.5 || r > 5.3)
			continue;
		all++;
		if (s->weight[i] < 0.5f)
			continue;
		iris_of(rgb, at[0], at[1]);
		const double got = (double)s->ln[i][1], want = log(rgb[1]);
		n++;
		for (int c = 0; c < 3; c++)
			sum[c] += (double)s->ln[i][c] - log(rgb[c]);
		a += got;
		b += want;
		aa += got * got;
		bb += want * want;
		ab += got * want;
		off += (got - want) * (got - want);
		out.brightest = fmax(out.brightest, got - want);
	}
	for (int c = 0; c < 3; c++)
		out.offset[c] = sum[c] / n;
	out.rms = sqrt(off / n - out.offset[1] * out.offset[1]);
	out.correlation = (ab / n - a / n * b / n) / sqrt((aa / n - a / n * a / n) * (bb / n - b / n * b / n));
	out.share = n / all;
	return out;
}

/* Colours, fibres and pupil are those of the eye, in white light and in a lamp's; lamps that the cornea mirrors are not among them. */
static void as_it_is(void **state)
{
	(void)state;
	static const double light[][3] = { { 1, 1, 1 }, { 1.1, 0.75, 0.4 }, { 0.4, 0.42, 0.5 } };
	for (int i = 0; i < (SANITISED ? 1 : 3); i++) {
		struct scene_seen s;
		struct filmed_report r;
		struct err err = { 0 };
		if (!make(&s, &r, light[i], 11, SANITISED ? 5 : N, &err))
			fail_msg("%s", err.msg);
		const struct likeness l = compare(&s);
		printf("light %d: ln off by %.3f %.3f %.3f, rms %.3f, correlation %.3f, seen %.2f, brightest %.2f, pupil %.2f\n", i, l.offset[0], l.offset[1], l.offset[2], l.rms,
		       l.correlation, l.share, l.brightest, s.pupil);
		for (int c = 0; c < 3; c++)
			NEAR(l.offset[c], 0, 0.12);
		NEAR(l.offset[0] - l.offset[1], 0, 0.06);
		NEAR(l.offset[2] - l.offset[1], 0, 0.06);
		assert_true(l.rms < 0.2 && l.correlation > (SANITISED ? 0.7 : 0.85) && l.share > 0.8 && l.brightest < 1.2);
		NEAR(s.pupil, pupil, 0.2);
		NEAR(r.px, 2 * limbus * focal / away, 8);
		scene_seen_free(&s);
	}
}

/* What is not seen goes on as what is. */
static void completed(void **state)
{
	(void)state;
	struct scene_seen s;
	struct filmed_report r;
	struct err err = { 0 };
	assert_true(make(&s, &r, (double[]){ 1, 1, 1 }, 9, 6, &err));
	float *drawn = mem_new(SEEN_SIDE * SEEN_SIDE, sizeof *drawn), *weight = mem_new(SEEN_SIDE * SEEN_SIDE, sizeof *weight);
	memcpy(weight, s.weight, SEEN_SIDE * SEEN_SIDE * sizeof *weight);
	scene_seen_fill(&s, drawn);
	double mean[2] = { 0 }, n[2] = { 0 };
	for (int i = 0; i < SEEN_SIDE * SEEN_SIDE; i++) {
		double at[2];
		place(at, &s, i);
		const double rad = hypot(at[0], at[1]);
		for (int c = 0; c < 3; c++)
			assert_true(isfinite(s.ln[i][c]));
		if (rad > 2.6 && rad < 5.2) {
			const bool seen = weight[i] > 0.5f;
			mean[seen] += (double)s.ln[i][1];
			n[seen]++;
		}
	}
	assert_true(n[0] > 5000 && n[1] > 5000);
	NEAR(mean[0] / n[0], mean[1] / n[1], 0.25);
	free(drawn);
	free(weight);
	scene_seen_free(&s);
}

/* Lids that leave hardly any iris, and no frame at all, are refused with their reason. */
static void refused(void **state)
{
	(void)state;
	struct scene_seen s;
	struct filmed_report r;
	struct err err = { 0 }, none = { 0 };
	assert_false(make(&s, &r, (double[]){ 1, 1, 1 }, 2.2, 4, &err));
	assert_true(err_is(&err));
	assert_false(make(&s, &r, (double[]){ 1, 1, 1 }, 11, 0, &none));
	ERR_HAS(none, "no frame shows an iris");
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(as_it_is), cmocka_unit_test(completed), cmocka_unit_test(refused) };
	return cmocka_run_group_tests(tests, 0, 0);
}
