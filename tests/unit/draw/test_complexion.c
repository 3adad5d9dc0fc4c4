/* complexion: skin whose albedo is known, filmed by a ray tracer of its own: a face that is a function z(x, y), met by bisection, with no mesh. */
#include "draw/complexion/complexion.h"

#include "base/mem.h"
#include "character/texture.h"
#include "image/image.h"
#include "tests/lib/unit.h"

enum { WIDE = 720, HIGH = 440, ACROSS = 81, DOWN = 81, SIDE = 640 };
static const double focal = 2500, off = 500;   // px; mm from the camera to the mesh's origin
static const double step_mm = 2;
static const double eye_x = 31, radius = 12;
static const double skin_rgb[3] = { 0.50, 0.31, 0.22 }, white_rgb[3] = { 0.66, 0.60, 0.54 };

/* The face: a dome with a nose. */
static double surface(double x, double y)
{
	const double r = 1 - x * x / (92 * 92) - y * y / (120 * 120);
	const double nose = 16 * exp(-x * x / (2 * 9 * 9) - (y + 28) * (y + 28) / (2 * 16 * 16));
	return (r > 0 ? 78 * sqrt(r) : 0) + nose;
}

static void normal_at(double n[3], double x, double y)
{
	const double h = 1e-3, a = (surface(x + h, y) - surface(x - h, y)) / (2 * h), b = (surface(x, y + h) - surface(x, y - h)) / (2 * h), len = sqrt(1 + a * a + b * b);
	n[0] = -a / len;
	n[1] = -b / len;
	n[2] = 1 / len;
}

static bool in_eye(double x, double y)
{
	const double a = (fabs(x) - eye_x) / 13, b = y / 5;
	return a * a + b * b < 1;
}

static bool in_brow(double x, double y)
{
	const double a = (fabs(x) - eye_x) / 20, b = (y - 20 + 0.006 * (fabs(x) - eye_x) * (fabs(x) - eye_x)) / 3.5;
	return a * a + b * b < 1;
}

/* Its hairs: lines that rise by comb radians to the temple, 1.6 mm apart. */
static const double comb = 0.5;
static double brow_at(double x, double y)
{
	const double across = -sin(comb) * (fabs(x) - eye_x) + cos(comb) * y;
	return in_brow(x, y) ? 0.3 * exp(0.4 * sin(2 * M_PI / 1.6 * across)) : 1;
}

/* Lashes of each lid: straight strokes off its margin, from the inner corner on; n 0: none. */
static struct {
	int n;
	double mm, half;
} lash;

/* The margin at an angle round the opening from its outer corner: place and direction outward. */
static void margin_at(double at[2], double out[2], double angle)
{
	at[0] = 13 * cos(angle);
	at[1] = 5 * sin(angle);
	const double len = hypot(5 * cos(angle), 13 * sin(angle));
	out[0] = 5 * cos(angle) / len;
	out[1] = 13 * sin(angle) / len;
}

/* Share of a pixel of mm at (x, y) that lashes hide. */
static double hidden(double x, double y, double mm)
{
	enum { FINE = SANITISED ? 2 : 4 };
	int in = 0;
	if (!lash.n || hypot(fabs(x) - eye_x, y) > 22)
		return 0;
	for (int k = 0; k < FINE * FINE; k++) {
		const double u = fabs(x) - eye_x + mm * ((k % FINE + 0.5) / FINE - 0.5), v = y + mm * ((k / FINE + 0.5) / FINE - 0.5);
		bool hit = false;
		for (int i = 0; i < 2 * lash.n && !hit; i++) {
			double at[2], out[2];
			margin_at(at, out, (i % 2 ? -1 : 1) * M_PI * (0.95 - 0.9 * (i / 2 + 0.5) / lash.n));
			const double along = (u - at[0]) * out[0] + (v - at[1]) * out[1], aside = (u - at[0]) * out[1] - (v - at[1]) * out[0];
			hit = along > 0 && along < lash.mm && fabs(aside) < lash.half;
		}
		in += hit;
	}
	return (double)in / (FINE * FINE);
}

/* Pores: rows of dimples, different on either side, and cheeks that are redder. */
static double pore(double x, double y) { return 0.08 * sin(2.6 * x + 0.7 * sin(0.9 * y)) * cos(2.3 * y + 0.5 * sin(1.1 * x)); }

static void albedo_at(double rgb[3], double x, double y)
{
	const double cheek = 0.06 * exp(-((fabs(x) - 36) * (fabs(x) - 36) + (y + 26) * (y + 26)) / (2 * 10 * 10));
	for (int c = 0; c < 3; c++)
		rgb[c] = skin_rgb[c] * exp(pore(x, y)) * (1 + (c ? -cheek : cheek)) * brow_at(x, y);
}

struct lamp {
	double dir[3], rgb[3], around[3];
};

static const struct lamp left = { { -0.6, 0.4, 0.69 }, { 0.75, 0.70, 0.66 }, { 0.34, 0.36, 0.40 } };
static const struct lamp right = { { 0.62, 0.1, 0.78 }, { 0.62, 0.68, 0.74 }, { 0.42, 0.40, 0.36 } };

static void irradiance(double e[3], const struct lamp *l, const double n[3])
{
	const double facing = fmax(n[0] * l->dir[0] + n[1] * l->dir[1] + n[2] * l->dir[2], 0);
	for (int c = 0; c < 3; c++)
		e[c] = l->around[c] * (0.8 + 0.2 * n[1]) + l->rgb[c] * facing;
}

/* A frame: [HIGH][WIDE][3], and where eyes are open. mirror: as a mirror shows it. */
static uint8_t *film(uint8_t *open, const struct lamp *lamp, double exposure, bool mirror)
{
	uint8_t *rgb = mem_new(3 * WIDE * HIGH, 1);
	for (int j = 0; j < HIGH; j++)
		for (int i = 0; i < WIDE; i++) {
			const double d[3] = { (i + 0.5 - WIDE / 2) / focal, -(j + 0.5 - HIGH / 2) / focal, -1 };
			double low = off - 120, high = off;
			for (int k = 0; k < 40; k++) {
				const double t = 0.5 * (low + high);
				if (off - t > surface(t * d[0], t * d[1]))
					low = t;
				else
					high = t;
			}
			const double x = (mirror ? -1 : 1) * low * d[0], y = low * d[1];
			double n[3], e[3], a[3];
			const double dark = hidden(x, y, low / focal);
			normal_at(n, x, y);
			albedo_at(a, x, y);
			open[(long)j * WIDE + i] = 0;
			irradiance(e, lamp, n);
			if (in_eye(x, y)) {
				const bool iris = hypot(fabs(x) - eye_x, y) < 4.5;
				for (int c = 0; c < 3; c++)  // as bright as it is between lids (complexion.c)
					a[c] = iris ? 0.05 : white_rgb[c] * (0.5 + 0.2 * skin_rgb[c]);
				open[(long)j * WIDE + i] = 1;
			}
			for (int c = 0; c < 3; c++)
				a[c] *= 1 - 0.95 * dark;
			for (int c = 0; c < 3; c++)
				rgb[3 * ((long)j * WIDE + i) + c] = (uint8_t)lrintf(255 * fminf(srgb_from_linear((float)(exposure * a[c] * e[c])), 1));
		}
	return rgb;
}

static struct mesh face(void)
{
	struct mesh m = { .vertices = mem_new(ACROSS * DOWN, sizeof *m.vertices), .faces = mem_new(2 * ACROSS * DOWN, sizeof *m.faces) };
	for (int j = 0; j < DOWN; j++)
		for (int i = 0; i < ACROSS; i++) {
			const double x = step_mm * (i - ACROSS / 2), y = step_mm * (DOWN / 2 - j);
			float *v = m.vertices[m.n_vertices++];
			v[0] = (float)x;
			v[1] = (float)y;
			v[2] = (float)surface(x, y);
		}
	for (int j = 0; j + 1 < DOWN; j++)
		for (int i = 0; i + 1 < ACROSS; i++) {
			const int32_t a = j * ACROSS + i, b = a + 1, c = a + ACROSS, d = c + 1;
			memcpy(m.faces[m.n_faces++], (int32_t[3]){ a, c, b }, sizeof *m.faces);
			memcpy(m.faces[m.n_faces++], (int32_t[3]){ b, c, d }, sizeof *m.faces);
		}
	return m;
}

static const double eyes[2][3] = { { 31, 0, 58 }, { -31, 0, 58 } };

/* Films a face once and makes its skin. exposure 0: black. shown: where its picture is left as it is, else black. Null: why says so. */
static struct complexion *skin_of(struct complexion_report *r, const struct mesh *m, const struct lamp *lamp, double exposure, bool mirror, int shown, struct err *why)
{
	const struct complexion_conf conf = { SIDE, { white_rgb[0], white_rgb[1], white_rgb[2] }, { 0.52, 0.315, 0.225 }, 0.1 };
	float (*at)[3] = mem_new((size_t)m->n_vertices, sizeof *at);
	uint8_t *open = mem_new(WIDE * HIGH, 1), *rgb = film(open, lamp, exposure, mirror);
	for (int i = 0; i < m->n_vertices; i++) {
		const float *v = m->vertices[i];
		const double z = off - (double)v[2];
		at[i][0] = (float)(WIDE / 2 + focal * (double)v[0] / z);
		at[i][1] = (float)(HIGH / 2 - focal * (double)v[1] / z);
		at[i][2] = (float)z;
	}
	for (long i = 0; i < (long)WIDE * HIGH; i++)
		if (i % WIDE >= shown)
			memset(rgb + 3 * i, 0, 3);
	enum { POINTS = 24 };
	float lids[4 * POINTS][2];
	for (int k = 0; k < 4 * POINTS; k++) {
		double p[2], out[2];
		margin_at(p, out, (k / POINTS % 2 ? -1 : 1) * M_PI * (k % POINTS) / (POINTS - 1));
		const double x = (k / POINTS < 2 ? eye_x : -eye_x) + p[0], z = off - surface(x, p[1]);
		lids[k][0] = (float)(WIDE / 2 + focal * x / z);
		lids[k][1] = (float)(HIGH / 2 - focal * p[1] / z);
	}
	struct complexion *c = complexion_new(m, eyes, radius, &conf);
	complexion_add(c, &(struct complexion_view){ rgb, WIDE, HIGH, (const float(*)[3])at, focal, open, (const float(*)[2])lids, POINTS, 0 });
	const bool ok = complexion_make(c, r, why);
	free(rgb);
	free(open);
	free(at);
	if (!ok)
		complexion_free(c);
	return ok ? c : 0;
}

/* Points of skin that the film shows well, off brows and lids. */
static bool well(double x, double y)
{
	double n[3];
	normal_at(n, x, y);
	for (int k = 0; k < 9; k++)
		if (in_brow(x + 3 * (k % 3 - 1), y + 3 * (k / 3 - 1)))
			return false;
	return fabs(x) < 56 && y < 30 && y > -30 && hypot(fabs(x) - eye_x, y) > 18 && n[2] > 0.6;
}

static void look_at(float rgb[3], const struct complexion *c, double x, double y)
{
	complexion_at(rgb, c, (const float[3]){ (float)x, (float)y, (float)surface(x, y) });
}

/* Error of ln albedo over the face: rms of what is left with its mean taken off, and that mean; and the correlation of its pores. */
static void judge(double rms[3], double mean[3], double *alike, const struct complexion *c, bool mirror)
{
	double n = 0, sum[3] = { 0 }, sum2[3] = { 0 }, ab = 0, aa = 0, bb = 0;
	for (double y = -30; y < 30; y += 0.9)
		for (double x = -56; x < 56; x += 0.9) {
			double want[3];
			float got[3], near[3];
			if (!well(x, y))
				continue;
			albedo_at(want, mirror ? -x : x, y);
			look_at(got, c, x, y);
			for (int k = 0; k < 3; k++) {
				const double e = log((double)got[k] / want[k]);
				sum[k] += e;
				sum2[k] += e * e;
			}
			n++;
			// Pores against a point half a wave of theirs off.
			look_at(near, c, x + 1.2, y);
			const double a = log((double)(got[1] / near[1])), b = pore(mirror ? -x : x, y) - pore(mirror ? -x - 1.2 : x + 1.2, y);
			ab += a * b;
			aa += a * a;
			bb += b * b;
		}
	assert_true(n > 1000);
	for (int k = 0; k < 3; k++) {
		mean[k] = sum[k] / n;
		rms[k] = sqrt(fmax(sum2[k] / n - mean[k] * mean[k], 0));
	}
	*alike = ab / sqrt(aa * bb);
}

/* The light is off: of two lamps that fall off to a third of their light across the face, and of other colours, the same albedo is left. */
static void test_two_lights(void **state)
{
	(void)state;
	struct mesh m = face();
	struct complexion_report r[2];
	struct err why = { 0 };
	struct complexion *c[2] = { skin_of(&r[0], &m, &left, 0.8, false, WIDE, &why), skin_of(&r[1], &m, &right, 0.5, false, WIDE, &why) };
	assert_non_null(c[0]);
	assert_non_null(c[1]);
	for (int i = 0; i < 2; i++) {
		double rms[3], mean[3], alike;
		judge(rms, mean, &alike, c[i], false);
		printf("light %d: albedo off by %.3f %.3f %.3f in ln, scale by %.3f %.3f %.3f, pores alike %.3f; seen %.2f; light from %.2f %.2f %.2f\n", i, rms[0], rms[1], rms[2],
		       mean[0], mean[1], mean[2], alike, r[i].seen, r[i].light[0], r[i].light[1], r[i].light[2]);
		assert_true(r[i].white);
		for (int k = 0; k < 3; k++) {
			NEAR(rms[k], 0, 0.05);
			NEAR(mean[k], 0, 0.10);
		}
		assert_true(alike > 0.85);
		assert_true(i ? r[i].light[0] > 0.3 : r[i].light[0] < -0.3);
	}
	double n = 0, sum = 0;
	for (double y = -30; y < 30; y += 1.1)
		for (double x = -56; x < 56; x += 1.1) {
			float a[3], b[3];
			if (!well(x, y))
				continue;
			look_at(a, c[0], x, y);
			look_at(b, c[1], x, y);
			for (int k = 0; k < 3; k++, n++)
				sum += pow(log((double)(a[k] / b[k])), 2);
		}
	printf("two lights: %.3f apart in ln\n", sqrt(sum / n));
	NEAR(sqrt(sum / n), 0, 0.06);
	complexion_free(c[0]);
	complexion_free(c[1]);
	mesh_free(&m);
}

/* A mirrored film gives the mirrored skin. */
static void test_mirror(void **state)
{
	(void)state;
	struct mesh m = face();
	struct complexion_report r;
	struct err why = { 0 };
	struct complexion *a = skin_of(&r, &m, &left, 0.8, false, WIDE, &why), *b = skin_of(&r, &m, &left, 0.8, true, WIDE, &why);
	assert_non_null(a);
	assert_non_null(b);
	double worst = 0, sum = 0, n = 0;
	for (double y = -40; y < 60; y += 1.3)
		for (double x = -60; x < 60; x += 1.3, n++) {
			float p[3], q[3];
			look_at(p, a, x, y);
			look_at(q, b, -x, y);
			for (int k = 0; k < 3; k++) {
				worst = fmax(worst, fabs(log((double)(p[k] / q[k]))));
				sum += fabs(log((double)(p[k] / q[k]))) / 3;
			}
		}
	printf("mirror: %.4f in the mean, %.3f at worst\n", sum / n, worst);
	NEAR(sum / n, 0, 0.01);
	complexion_free(a);
	complexion_free(b);
	mesh_free(&m);
}

/* Mean of ln of green over a disc of 2 mm: pores are left out of it. */
static double smooth_at(const struct complexion *c, double x, double y)
{
	double sum = 0;
	int n = 0;
	for (int j = -4; j <= 4; j++)
		for (int i = -4; i <= 4; i++)
			if (i * i + j * j <= 16) {
				float rgb[3];
				look_at(rgb, c, x + 0.5 * i, y + 0.5 * j);
				sum += log((double)rgb[1]);
				n++;
			}
	return sum / n;
}

/* Where the film ends, half of the face is missing, or a brow is left out, nothing shows it: no step, and no dark brow. */
static void test_seams(void **state)
{
	(void)state;
	struct mesh m = face();
	struct complexion_report r;
	struct err why = { 0 };
	for (int half = 0; half < 2; half++) {
		struct complexion *c = skin_of(&r, &m, &left, 0.8, false, half ? WIDE * 62 / 100 : WIDE, &why);
		assert_non_null(c);
		double step = 0, darkest = 0;
		for (double y = -36; y < 50; y += 2)
			for (double x = -60; x < 60; x += 1) {
				const bool nose = fabs(x) < 18 && y < -8;  // its flanks are steep: what is left there is light, not a seam
				if (hypot(fabs(x) - eye_x, y) < 16 || fabs(y - 20) < 9 || nose)
					continue;
				const double rise = surface(x + 2, y) - surface(x, y), along = hypot(2, rise);  // mm of skin
				step = fmax(step, fabs(smooth_at(c, x + 2, y) - smooth_at(c, x, y)) * 2 / along);
			}
		for (double x = 16; x < 46; x += 1)
			darkest = fmin(darkest, smooth_at(c, x, 20 - 0.006 * (x - eye_x) * (x - eye_x)) - log(skin_rgb[1]));
		printf("%s: seen %.2f, mirrored %.2f, largest step %.3f, brow %.3f\n", half ? "part of the film" : "film", r.seen, r.mirrored, step, darkest);
		assert_true(half ? r.mirrored > 0.1 : r.mirrored < 0.2);
		NEAR(step, 0, 0.03);
		NEAR(darkest, 0, 0.12);
		if (half) {  // pores of the other half, mirrored
			double ab = 0, aa = 0, bb = 0;
			for (double y = -26; y < 10; y += 0.7)
				for (double x = 42; x < 52; x += 0.7) {
					float p[3], q[3];
					if (!well(x, y))
						continue;
					look_at(p, c, x, y);
					look_at(q, c, x + 1.2, y);
					const double a = log((double)(p[1] / q[1])), b = pore(-x, y) - pore(-x - 1.2, y);
					ab += a * b;
					aa += a * a;
					bb += b * b;
				}
			assert_true(ab / sqrt(aa * bb) > 0.6);
		}
		complexion_free(c);
	}
	mesh_free(&m);
}

/* rms of ln of a texture's green about its mean, in a square round a place. */
static double grain_of(const uint8_t *px, int side, const float uv[2])
{
	enum { HALF = 10 };
	const int x0 = (int)(uv[0] * (float)side), y0 = (int)(uv[1] * (float)side);
	double sum = 0, sum2 = 0, n = 0;
	for (int y = y0 - HALF; y < y0 + HALF; y++)
		for (int x = x0 - HALF; x < x0 + HALF; x++, n++) {
			const double d = log((double)linear_from_srgb((float)px[4 * ((long)y * side + x) + 1] / 255));
			sum += d;
			sum2 += d * d;
		}
	return sqrt(sum2 / n - sum / n * sum / n);
}

/* A character that wears it: what was not filmed has grain as strong as what was, and its textures and coordinates are whole. */
static void test_wear(void **state)
{
	(void)state;
	struct mesh m = face();
	struct complexion_report r;
	struct err why = { 0 };
	struct complexion *c = skin_of(&r, &m, &left, 0.8, false, WIDE, &why);
	assert_non_null(c);
	float (*normal)[3] = mesh_normals(&m), *margin = mem_new((size_t)m.n_vertices, sizeof *margin);
	struct complexion_wearer w = { m.n_vertices, m.n_faces, (const int32_t(*)[3])m.faces, (const float(*)[3])m.vertices, (const float(*)[3])normal,
		                           (const float(*)[3])m.vertices, 0, margin, { { 31, 0, 58 }, { -31, 0, 58 } }, { { 1 }, { 0, 1 }, { 0, 0, 1 } } };
	struct look l;
	assert_true(complexion_wear(&l, c, &w, &why));
	assert_int_equal(l.n_textures, 2);
	assert_int_equal(l.n_faces, m.n_faces);
	for (int f = 0; f < l.n_faces; f++)
		for (int k = 0; k < 3; k++) {
			assert_in_range(l.corner[f][k], 0, l.n_wedges - 1);
			assert_int_equal(l.point[l.corner[f][k]], m.faces[f][k]);
		}
	for (int i = 0; i < l.n_wedges; i++)
		assert_true(l.uv[i][0] >= 0 && l.uv[i][0] <= 1 && l.uv[i][1] >= 0 && l.uv[i][1] <= 1);
	int wide, high;
	uint8_t *px = look_texture_pixels(&wide, &high, &l.texture[0], 4096, &why), *bumps = look_texture_pixels(&wide, &high, &l.texture[1], 4096, &why);
	assert_non_null(px);
	assert_non_null(bumps);
	assert_int_equal(wide, SIDE);
	// Between the brows, and the forehead above the frame.
	float seen[2], above[2];
	const struct complexion_chart chart = complexion_chart_of(eyes, w.head_from_rest, 1);
	complexion_chart_at(seen, &chart, (const float[3]){ 0, 26, (float)surface(0, 26) });
	complexion_chart_at(above, &chart, (const float[3]){ 0, 66, (float)surface(0, 66) });
	const double a = grain_of(px, SIDE, seen), b = grain_of(px, SIDE, above);
	printf("grain %.4f where it was filmed, %.4f where not\n", a, b);
	assert_true(a > 0.02 && b > 0.5 * a && b < 1.5 * a);
	double tilt = 0, n = 0;
	for (long i = 0; i < (long)SIDE * SIDE; i++) {
		const double t[3] = { bumps[4 * i] / 127.5 - 1, bumps[4 * i + 1] / 127.5 - 1, bumps[4 * i + 2] / 127.5 - 1 };
		assert_true(t[2] > 0.6);  // bounded: JPEG's own errors in it
		const double x = i % SIDE - 0.5 * SIDE, y = (double)(i / SIDE) - 0.5 * SIDE;
		if (hypot(x, y) < 0.2 * SIDE) {
			tilt += t[0] * t[0] + t[1] * t[1];
			n += 2;
		}
	}
	printf("bumps: rms slope %.3f\n", sqrt(tilt / n));
	assert_true(sqrt(tilt / n) > 0.04 && sqrt(tilt / n) < 0.2);
	free(px);
	free(bumps);
	free(normal);
	free(margin);
	look_free(&l);
	complexion_free(c);
	mesh_free(&m);
}

static struct hair_film bare;  // without lashes

static struct hair_film hair_of(int n, double mm, double half, double exposure, bool mirror)
{
	struct mesh m = face();
	struct complexion_report r;
	struct err why = { 0 };
	lash.n = n;
	lash.mm = mm;
	lash.half = half;
	struct complexion *c = skin_of(&r, &m, &left, exposure, mirror, WIDE, &why);
	lash.n = 0;
	assert_non_null(c);
	const struct hair_film film = *complexion_hair(c);
	complexion_free(c);
	mesh_free(&m);
	return film;
}

/* Lashes: strokes off the margins reach half their length in the mean; twice as many hide twice as much; without any hardly anything is hidden. */
static void test_lashes(void **state)
{
	(void)state;
	bare = hair_of(0, 0, 0, 0.8, false);
	const struct hair_film some = hair_of(20, 4, 0.1, 0.8, false), many = hair_of(40, 4, 0.1, 0.5, false);
	const struct hair_film longer = hair_of(20, 6, 0.1, 0.8, true);
	for (int k = HAIR_UPPER; k <= HAIR_LOWER; k++) {
		printf("lashes, %s: %.3f mm2 on a mm, %.2f mm off; twice as many %.3f, %.2f; longer %.3f, %.2f; none %.3f\n", k ? "lower" : "upper", some.lid[k].area,
		       some.lid[k].reach, many.lid[k].area, many.lid[k].reach, longer.lid[k].area, longer.lid[k].reach, bare.lid[k].area);
		NEAR(some.lid[k].reach, 2, 0.25);
		NEAR(many.lid[k].reach, 2, 0.25);
		NEAR(longer.lid[k].reach, 3, 0.35);
		NEAR(many.lid[k].area / some.lid[k].area, 2, 0.4);
		NEAR(longer.lid[k].area / some.lid[k].area, 1.5, 0.2);
		assert_true(bare.lid[k].area < 0.2 * some.lid[k].area);
	}
}

/* Brows: as large and as dark as they are, and combed the way of their lines; on either side alike. */
static void test_brows(void **state)
{
	(void)state;
	const struct hair_film film = bare;
	for (int s = 0; s < 2; s++) {
		double area = 0, beyond = 0, off = 0;
		assert_true(film.brow[s]);
		for (int j = 0; j < HAIR_CELLS_Y; j++)
			for (int i = 0; i < HAIR_CELLS_X; i++) {
				const double x = eye_x + HAIR_FROM_X + HAIR_CELL * i, y = HAIR_FROM_Y + HAIR_CELL * j, share = HAIR_CELL * HAIR_CELL * (double)film.cover[s][j][i];
				bool near = false;
				for (int k = 0; k < 9; k++)
					near = near || in_brow(x + k % 3 - 1, y + k / 3 - 1);
				area += share;
				beyond += near ? 0 : share;
				off += share * fabs((double)film.way[s][j][i] - comb);
			}
		// Two lines in three are as dark as hair alone.
		printf("brow %d: hides %.0f mm2 of %.0f, %.1f beyond it; combed %.2f rad off in the mean; albedo %.3f %.3f %.3f\n", s, area, M_PI * 20 * 3.5, beyond, off / area,
		       film.rgb[0], film.rgb[1], film.rgb[2]);
		NEAR(area / (M_PI * 20 * 3.5), 0.8, 0.15);
		assert_true(beyond < 0.02 * area);
		assert_true(off / area < 0.2);
	}
	for (int c = 0; c < 3; c++)
		NEAR(film.rgb[c] / (0.3 * skin_rgb[c]), 0.8, 0.25);
}

/* What cannot be used is refused in a sentence. */
static void test_bad(void **state)
{
	(void)state;
	struct mesh m = face();
	struct complexion_report r;
	struct err dark = { 0 }, bright = { 0 }, little = { 0 };
	assert_null(skin_of(&r, &m, &left, 0.0005, false, WIDE, &dark));
	ERR_HAS(dark, "face");
	assert_null(skin_of(&r, &m, &left, 30, false, WIDE, &bright));
	ERR_HAS(bright, "face");
	assert_null(skin_of(&r, &m, &left, 0.8, false, WIDE / 5, &little));
	assert_true(err_is(&little));
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_two_lights), cmocka_unit_test(test_mirror), cmocka_unit_test(test_seams),
		cmocka_unit_test(test_wear), cmocka_unit_test(test_bad), cmocka_unit_test(test_lashes), cmocka_unit_test(test_brows),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
