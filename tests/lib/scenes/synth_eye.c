#include "tests/lib/scenes/synth_eye.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/ellipse_fit.h"
#include "math/rng.h"

const double SYNTH_CORNEA_R = 7.8, SYNTH_LIMBUS_R = 5.85, SYNTH_IRIS_DEPTH = 3.3, SYNTH_INDEX = 1.336;
static const double SCLERA_R = 12, SCLERA[3] = { 0.78, 0.72, 0.68 };
enum { STREAKS = 24, VEINS = 7, LASHES = 90, GLINTS = 3, ANGLES = 1024, RADII = 33 };

struct lash {
	double x0, y0, x1, y1, x2, y2, width;  // quadratic curve, px
};

struct scene {
	const struct synth_eye *eye;
	double R[3][3], t[3], focal, scale, limbus_z, sclera_z;
	float streak[RADII][ANGLES + 1];  // iris texture by radius 0..1.1 and angle
	float *lashes;              // [height][width] cover, 0..1
	double vein[VEINS][4];      // angle, bend, width, strength
	struct lash lash[LASHES];
	int n_lashes;
	double glint[GLINTS][5];    // x, y, half-width, half-height, strength; px
	int n_glints;
	double open, roll, corner;  // lids: upper and lower margins, px
	double light[3];
};

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double smooth(double lo, double hi, double x)
{
	double t = fmin(fmax((x - lo) / (hi - lo), 0), 1);
	return t * t * (3 - 2 * t);
}

/* Lid margins in the eye's own px frame (x along the opening): upper is -, lower +. */
static void margins(const struct scene *s, double x, double *upper, double *lower)
{
	double u = x / s->corner, arch = fmax(1 - u * u, -4);
	/* the upper lid hides three times what the lower does: it stands lower */
	*upper = -(s->open - 0.15 * s->eye->limbus_px) * arch;
	*lower = (s->open + 0.15 * s->eye->limbus_px) * arch;
}

static void to_lid(const struct scene *s, const double px[2], double out[2])
{
	double x = px[0] - s->eye->center[0], y = px[1] - s->eye->center[1], c = cos(s->roll), n = sin(s->roll);
	out[0] = c * x + n * y;
	out[1] = c * y - n * x;
}

/* Positive inside the opening: px to the nearer margin. */
static double opening(const struct scene *s, const double px[2], bool *nearer_upper)
{
	double p[2], upper, lower;
	to_lid(s, px, p);
	margins(s, p[0], &upper, &lower);
	*nearer_upper = p[1] - upper < lower - p[1];
	return fmin(p[1] - upper, lower - p[1]);
}

static void project(const struct scene *s, const double P[3], double px[2])
{
	double c[3];
	for (int i = 0; i < 3; i++)
		c[i] = dot(s->R[i], P) + s->t[i];
	px[0] = s->focal * c[0] / c[2] + s->eye->width / 2.0;
	px[1] = s->focal * c[1] / c[2] + s->eye->height / 2.0;
}

static double covered(const struct scene *s)
{
	int n = 0;
	for (int i = 0; i < 720; i++) {
		double a = 2 * M_PI * i / 720, P[3] = { SYNTH_LIMBUS_R * cos(a), SYNTH_LIMBUS_R * sin(a), s->limbus_z }, px[2];
		bool upper;
		project(s, P, px);
		n += opening(s, px, &upper) < 0;
	}
	return n / 720.0;
}

/* x of the first hit of a ray with a sphere of radius r centred at (0, 0, z); negative: none. */
static double sphere(const double o[3], const double d[3], double r, double z)
{
	double c[3] = { o[0], o[1], o[2] - z }, b = dot(c, d), q = b * b - dot(c, c) + r * r;
	return q > 0 ? -b - sqrt(q) : -1;
}

static void iris_colour(const struct scene *s, double x, double y, double out[3])
{
	const double r = hypot(x, y) / SYNTH_LIMBUS_R, a = atan2(y, x), pupil = s->eye->pupil;
	double u = (a + M_PI) / (2 * M_PI) * ANGLES, w = fmin(r / 1.1, 0.999) * (RADII - 1);
	int i = (int)u < ANGLES ? (int)u : ANGLES - 1, j = (int)w;
	const float *p = &s->streak[j][i], *q = &s->streak[j + 1][i];
	double top = p[0] + (u - i) * (p[1] - p[0]), low = q[0] + (u - i) * (q[1] - q[0]), streak = top + (w - j) * (low - top);
	double v = 1 + s->eye->texture * streak;
	v *= 1 + 0.35 * exp(-pow((r - pupil - 0.16) / 0.07, 2)) - 0.25 * smooth(pupil + 0.16, pupil + 0.22, r) * (r < 0.5);
	v *= 1 - 0.55 * smooth(0.80, 1.0, r);
	v *= smooth(pupil - 0.01, pupil + 0.01, r);
	v *= 1 - 0.8 * smooth(1.02, 1.06, r);
	for (int c = 0; c < 3; c++)
		out[c] = fmax(s->eye->iris[c] * v, 0.004);
}

static void sclera_colour(const struct scene *s, const double n[3], const double P[3], double out[3])
{
	double lit = 1 - s->eye->shading * (0.5 - 0.5 * dot(n, s->light)), a = atan2(P[1], P[0]), r = hypot(P[0], P[1]);
	double red = 0;
	for (int i = 0; i < VEINS; i++) {
		double d = remainder(a - s->vein[i][0] - s->vein[i][1] * sin(0.9 * r + i), 2 * M_PI) * r;
		red += s->vein[i][3] * exp(-pow(d / s->vein[i][2], 2));
	}
	for (int c = 0; c < 3; c++)
		out[c] = SCLERA[c] * lit * (1 - (c ? fmin(red, 0.5) : 0.3 * fmin(red, 0.5)));
}

/* The eyeball along a ray of the eye frame; false: passes by. */
static bool ball_colour(const struct scene *s, const double o[3], const double d[3], double out[3])
{
	const double ramp = s->eye->ramp;
	double t = sphere(o, d, SYNTH_CORNEA_R, SYNTH_CORNEA_R), K[3];
	for (int i = 0; i < 3; i++)
		K[i] = o[i] + t * d[i];
	if (t > 0 && hypot(K[0], K[1]) < SYNTH_LIMBUS_R + ramp && K[2] < SYNTH_CORNEA_R) {
		double n[3] = { K[0] / SYNTH_CORNEA_R, K[1] / SYNTH_CORNEA_R, K[2] / SYNTH_CORNEA_R - 1 };
		double ci = -dot(n, d), eta = 1 / SYNTH_INDEX, ct = sqrt(1 - eta * eta * (1 - ci * ci)), in[3], white[3];
		for (int i = 0; i < 3; i++)
			in[i] = eta * d[i] + (eta * ci - ct) * n[i];
		double u = (SYNTH_IRIS_DEPTH - K[2]) / in[2], opaque = smooth(-ramp, ramp, hypot(K[0], K[1]) - SYNTH_LIMBUS_R);
		iris_colour(s, K[0] + u * in[0], K[1] + u * in[1], out);
		sclera_colour(s, n, K, white);
		for (int c = 0; c < 3; c++)
			out[c] += opaque * (white[c] - out[c]);
		return true;
	}
	t = sphere(o, d, SCLERA_R, s->sclera_z);
	if (!(t > 0))
		return false;
	double P[3], n[3];
	for (int i = 0; i < 3; i++) {
		P[i] = o[i] + t * d[i];
		n[i] = (P[i] - (i == 2 ? s->sclera_z : 0)) / SCLERA_R;
	}
	sclera_colour(s, n, P, out);
	return true;
}

static void skin_colour(const struct scene *s, const double px[2], double into, bool upper, double out[3])
{
	double ripple = 0.06 * sin(px[0] * 0.31 + 3 * sin(px[1] * 0.11)) * sin(px[1] * 0.43 + 2 * sin(px[0] * 0.07));
	double a = s->eye->limbus_px, crease = upper ? 0.35 * exp(-pow((into - 0.55 * a) / (0.08 * a), 2)) : 0;
	double rim = exp(-into / (0.06 * a)), lit = (1 + ripple) * (1 - crease) * (1 - 0.3 * s->eye->shading);
	for (int c = 0; c < 3; c++) {
		double pink = s->eye->skin[c] * 0.7 + (c == 0 ? 0.25 : 0.12);
		out[c] = (s->eye->skin[c] + rim * (pink - s->eye->skin[c])) * lit;
	}
}

/* One lash: its distance to a chain of short lines, in its own box. */
static void draw_lash(struct scene *s, const struct lash *l)
{
	const int w = s->eye->width, h = s->eye->height;
	enum { LINES = 10 };
	double x[LINES + 1], y[LINES + 1];
	for (int k = 0; k <= LINES; k++) {
		double t = (double)k / LINES, u = 1 - t;
		x[k] = u * u * l->x0 + 2 * u * t * l->x1 + t * t * l->x2;
		y[k] = u * u * l->y0 + 2 * u * t * l->y1 + t * t * l->y2;
	}
	for (int k = 0; k < LINES; k++)
		for (int v = (int)fmax(fmin(y[k], y[k + 1]) - 4, 0); v < h && v < fmax(y[k], y[k + 1]) + 4; v++)
			for (int u = (int)fmax(fmin(x[k], x[k + 1]) - 4, 0); u < w && u < fmax(x[k], x[k + 1]) + 4; u++) {
				double dx = x[k + 1] - x[k], dy = y[k + 1] - y[k], px = u + 0.5 - x[k], py = v + 0.5 - y[k];
				double t = fmin(fmax((px * dx + py * dy) / (dx * dx + dy * dy), 0), 1);
				double cover = l->width * (1.1 - (k + t) / LINES) + 0.5 - hypot(px - t * dx, py - t * dy);
				float *m = &s->lashes[(long)v * w + u];
				*m = fmaxf(*m, (float)fmin(fmax(cover, 0), 1));
			}
}

static void shade(const struct scene *s, const double px[2], double out[3])
{
	const struct synth_eye *e = s->eye;
	bool upper;
	double open = e->lids ? opening(s, px, &upper) : 1e9, d[3], o[3], a = e->limbus_px;
	memset(out, 0, 3 * sizeof *out);
	if (open < 0) {
		skin_colour(s, px, -open, upper, out);
	} else {
		double cam[3] = { (px[0] - e->width / 2.0) / s->focal, (px[1] - e->height / 2.0) / s->focal, 1 };
		double n = sqrt(dot(cam, cam));
		for (int j = 0; j < 3; j++) {
			d[j] = (s->R[0][j] * cam[0] + s->R[1][j] * cam[1] + s->R[2][j] * cam[2]) / n;
			o[j] = -(s->R[0][j] * s->t[0] + s->R[1][j] * s->t[1] + s->R[2][j] * s->t[2]);
		}
		if (ball_colour(s, o, d, out)) {
			double shadow = e->lids && upper ? 1 - 0.6 * e->shading * exp(-open / (0.12 * a)) : 1;
			for (int c = 0; c < 3; c++)
				out[c] *= shadow;
			for (int i = 0; i < s->n_glints; i++)
				if (fabs(px[0] - s->glint[i][0]) < s->glint[i][2] && fabs(px[1] - s->glint[i][1]) < s->glint[i][3])
					for (int c = 0; c < 3; c++)
						out[c] += s->glint[i][4];
		}
	}
	for (int c = 0; c < 3; c++)
		out[c] *= e->exposure;
}

static void grow_lashes(struct scene *s, struct rng *rng)
{
	const struct synth_eye *e = s->eye;
	const double a = e->limbus_px;
	s->n_lashes = e->lids ? (int)(e->lashes * LASHES) : 0;
	for (int i = 0; i < s->n_lashes; i++) {
		bool up = rng_uniform(rng) < 0.7;
		double x = rng_range(rng, -0.9, 0.9) * s->corner, upper, lower;
		margins(s, x, &upper, &lower);
		double y = up ? upper : lower, length = a * rng_range(rng, 0.25, up ? 0.9 : 0.4), lean = 0.6 * x / s->corner + rng_range(rng, -0.2, 0.2);
		/* most grow away from the eye; some hang over it */
		double away = (up ? -1 : 1) * (rng_uniform(rng) < 0.2 ? -0.5 : 1);
		double c = cos(s->roll), n = sin(s->roll), bx = x + 0.3 * lean * length, by = y + 0.5 * away * length,
		       tx = x + lean * length, ty = y + 0.8 * away * length;
		s->lash[i] = (struct lash){ e->center[0] + c * x - n * y, e->center[1] + n * x + c * y,
			                    e->center[0] + c * bx - n * by, e->center[1] + n * bx + c * by,
			                    e->center[0] + c * tx - n * ty, e->center[1] + n * tx + c * ty,
			                    a * rng_range(rng, 0.006, 0.014) };
		draw_lash(s, &s->lash[i]);
	}
}

static void dress(struct scene *s, struct rng *rng)
{
	const struct synth_eye *e = s->eye;
	const double a = e->limbus_px;
	for (int i = 0; i < STREAKS; i++) {
		double frequency = 3 + rng_below(rng, 70), phase = rng_range(rng, 0, 2 * M_PI), twist = rng_range(rng, -6, 6);
		double height = rng_range(rng, 0.3, 1) / sqrt(STREAKS);
		for (int r = 0; r < RADII; r++)
			for (int k = 0; k <= ANGLES; k++)
				s->streak[r][k] += (float)(height * sin(frequency * 2 * M_PI * k / ANGLES + phase + twist * 1.1 * r / (RADII - 1)));
	}
	for (int i = 0; i < VEINS; i++) {
		s->vein[i][0] = rng_range(rng, -M_PI, M_PI);
		s->vein[i][1] = rng_range(rng, -0.15, 0.15);
		s->vein[i][2] = rng_range(rng, 0.04, 0.12);
		s->vein[i][3] = rng_range(rng, 0.05, 0.4);
	}
	s->n_glints = (int)lround(e->glints * GLINTS);
	for (int i = 0; i < s->n_glints; i++) {
		double angle = rng_range(rng, 0, 2 * M_PI), at = a * rng_range(rng, 0.1, 1.0);
		s->glint[i][0] = e->center[0] + at * cos(angle);
		s->glint[i][1] = e->center[1] + at * sin(angle);
		s->glint[i][2] = a * rng_range(rng, 0.02, 0.14);
		s->glint[i][3] = a * rng_range(rng, 0.02, 0.2);
		s->glint[i][4] = rng_range(rng, 0.15, 1.5);
	}
	s->roll = rng_range(rng, -0.2, 0.2);
	s->corner = a * rng_range(rng, 1.9, 2.4);
	double lo = 0.05 * a, hi = 3 * a;
	for (int i = 0; i < 40; i++) {
		s->open = (lo + hi) / 2;
		if (covered(s) > e->occlusion)
			lo = s->open;
		else
			hi = s->open;
	}
	grow_lashes(s, rng);
}

/* Axis tilted by theta towards phi against the ray to the limbus' centre; columns of R are the eye's axes. */
static void place(struct scene *s)
{
	const struct synth_eye *e = s->eye;
	s->limbus_z = SYNTH_CORNEA_R - sqrt(SYNTH_CORNEA_R * SYNTH_CORNEA_R - SYNTH_LIMBUS_R * SYNTH_LIMBUS_R);
	s->sclera_z = s->limbus_z + sqrt(SCLERA_R * SCLERA_R - SYNTH_LIMBUS_R * SYNTH_LIMBUS_R);
	s->focal = e->limbus_px * e->distance / SYNTH_LIMBUS_R;
	double sight[3] = { (e->center[0] - e->width / 2.0) / s->focal, (e->center[1] - e->height / 2.0) / s->focal, 1 };
	double n = sqrt(dot(sight, sight)), x[3] = { 1, 0, 0 }, y[3], z[3];
	for (int i = 0; i < 3; i++)
		sight[i] /= n;
	double k = dot(x, sight), m = sqrt(1 - k * k);
	for (int i = 0; i < 3; i++)
		x[i] = (x[i] - k * sight[i]) / m;
	y[0] = sight[1] * x[2] - sight[2] * x[1];
	y[1] = sight[2] * x[0] - sight[0] * x[2];
	y[2] = sight[0] * x[1] - sight[1] * x[0];
	double side[3];
	for (int i = 0; i < 3; i++)
		side[i] = cos(e->phi) * x[i] + sin(e->phi) * y[i];
	for (int i = 0; i < 3; i++)
		z[i] = cos(e->theta) * sight[i] + sin(e->theta) * side[i];
	double ex[3] = { 1, 0, 0 };
	k = dot(ex, z);
	m = sqrt(1 - k * k);
	for (int i = 0; i < 3; i++) {
		s->R[i][0] = (ex[i] - k * z[i]) / m;
		s->R[i][2] = z[i];
	}
	for (int i = 0; i < 3; i++) {
		int a = (i + 1) % 3, b = (i + 2) % 3;
		s->R[i][1] = z[a] * s->R[b][0] - z[b] * s->R[a][0];
		s->t[i] = e->distance * sight[i] - s->limbus_z * z[i];
	}
}

static void blur_rows(float *out, const float *in, int w, int h, double sigma)
{
	enum { MAX_TAPS = 64 };
	const int n = fmin(ceil(3 * sigma), MAX_TAPS);
	float g[MAX_TAPS + 1], total = 0;
	for (int k = 0; k <= n; k++) {
		g[k] = (float)exp(-0.5 * k * k / (sigma * sigma));
		total += k ? 2 * g[k] : g[k];
	}
#pragma omp parallel for
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			float sum[3] = { 0 };
			for (int k = -n; k <= n; k++) {
				int at = x + k < 0 ? 0 : x + k >= w ? w - 1 : x + k;
				for (int c = 0; c < 3; c++)
					sum[c] += g[abs(k)] * in[3 * ((long)y * w + at) + c];
			}
			for (int c = 0; c < 3; c++)
				out[3 * ((long)x * h + y) + c] = sum[c] / total;  // transposed
		}
}

static double encode(double v)
{
	v = fmin(fmax(v, 0), 1);
	return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static void develop(struct photo *photo, float *linear, const struct synth_eye *e, struct rng *rng)
{
	const int w = e->width, h = e->height;
	if (e->blur > 0.1) {
		float *t = malloc(3 * sizeof *t * (size_t)w * (size_t)h);
		blur_rows(t, linear, w, h, e->blur);
		blur_rows(linear, t, h, w, e->blur);
		free(t);
	}
	photo->rgb = malloc(3 * sizeof *photo->rgb * (size_t)w * (size_t)h);
	for (long i = 0; i < 3L * w * h; i++) {
		double v = encode(linear[i]) + e->noise * rng_normal(rng);
		photo->rgb[i] = (uint16_t)(257 * lround(255 * fmin(fmax(v, 0), 1)));
	}
}

/* The conic through the projected circle: five of its points are enough; more, for the mean of rounding. */
static void tell(struct synth_truth *truth, const struct scene *s)
{
	enum { N = 64 };
	double p[N][2];
	for (int i = 0; i < N; i++) {
		double a = 2 * M_PI * i / N, P[3] = { SYNTH_LIMBUS_R * cos(a), SYNTH_LIMBUS_R * sin(a), s->limbus_z };
		project(s, P, p[i]);
	}
	ellipse_fit_direct(&truth->limbus, N, p, 0);
	truth->occlusion = s->eye->lids ? covered(s) : 0;
	truth->focal_px = s->focal;
	for (int i = 0; i < 3; i++) {
		truth->axis[i] = s->R[i][2];
		truth->apex[i] = s->t[i];
	}
}

struct photo synth_eye_render(const struct synth_eye *e, struct synth_truth *truth)
{
	struct rng rng = { e->seed };
	struct scene *s = calloc(1, sizeof *s);
	*s = (struct scene){ .eye = e, .light = { cos(e->light) * 0.7, sin(e->light) * 0.7, -0.7 } };
	s->lashes = calloc((size_t)e->width * (size_t)e->height, sizeof *s->lashes);
	struct photo photo = { .width = e->width, .height = e->height, .bits = 8, .kind = PHOTO_PNG,
		               .exif = { .orientation = 1, .focal_px = NAN, .focal_mm = NAN, .focal_35mm = NAN } };
	place(s);
	dress(s, &rng);
	tell(truth, s);
	float *linear = malloc(3 * sizeof *linear * (size_t)e->width * (size_t)e->height);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < e->height; y++)
		for (int x = 0; x < e->width; x++) {
			double sum[3] = { 0 };
			for (int k = 0; k < SYNTH_SAMPLES * SYNTH_SAMPLES; k++) {
				double c[3], px[2] = { x + (k % SYNTH_SAMPLES + 0.5) / SYNTH_SAMPLES,
					               y + ((double)(k / SYNTH_SAMPLES) + 0.5) / SYNTH_SAMPLES };
				shade(s, px, c);
				for (int i = 0; i < 3; i++)
					sum[i] += c[i];
			}
			double lash = s->lashes[(long)y * e->width + x];
			for (int i = 0; i < 3; i++) {
				double v = sum[i] / (SYNTH_SAMPLES * SYNTH_SAMPLES);
				linear[3 * ((long)y * e->width + x) + i] = (float)(v + lash * (0.015 * e->exposure - v));
			}
		}
	develop(&photo, linear, e, &rng);
	free(linear);
	free(s->lashes);
	free(s);
	return photo;
}

struct synth_eye synth_eye_grid(int index)
{
	static const double irises[6][3] = { { 0.20, 0.30, 0.42 }, { 0.045, 0.022, 0.012 }, { 0.14, 0.17, 0.07 },
		                             { 0.16, 0.08, 0.03 }, { 0.24, 0.25, 0.26 }, { 0.09, 0.045, 0.02 } };
	static const double skins[4][3] = { { 0.60, 0.40, 0.32 }, { 0.36, 0.20, 0.13 }, { 0.10, 0.05, 0.035 }, { 0.72, 0.52, 0.44 } };
	const int level = index / (SYNTH_GRID / SYNTH_LEVELS), which = index % (SYNTH_GRID / SYNTH_LEVELS);
	struct rng rng = { 0x5eed0000ull + (uint64_t)which };
	struct synth_eye e = { .seed = 77 + (uint64_t)index, .width = 640, .height = 480, .lids = true };
	e.limbus_px = rng_range(&rng, 60, 150);
	e.center[0] = rng_range(&rng, 220, 420);
	e.center[1] = rng_range(&rng, 190, 290);
	e.theta = rng_range(&rng, 0, 0.7);
	e.phi = rng_range(&rng, 0, 2 * M_PI);
	e.distance = rng_range(&rng, 60, 300);
	memcpy(e.iris, irises[which % 6], sizeof e.iris);
	memcpy(e.skin, skins[which / 6 % 4], sizeof e.skin);
	e.texture = rng_range(&rng, 0.15, 0.7);
	e.ramp = rng_range(&rng, 0.05, 0.4);
	e.pupil = rng_range(&rng, 0.22, 0.55);
	e.occlusion = 0.15 * level;
	e.lashes = rng_range(&rng, 0.1, 1);
	e.glints = rng_range(&rng, 0, 1);
	e.light = rng_range(&rng, 0, 2 * M_PI);
	e.shading = rng_range(&rng, 0, 0.8);
	e.exposure = rng_range(&rng, 0.5, 1.1);
	e.blur = rng_range(&rng, 0.3, 2.5);
	e.noise = rng_range(&rng, 0.002, 0.03);
	return e;
}
