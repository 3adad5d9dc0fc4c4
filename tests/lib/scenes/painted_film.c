#include "tests/lib/scenes/painted_film.h"

#include <math.h>
#include <string.h>

#include "math/rng.h"
#include "tests/lib/scenes/painted_eye.h"

const double FILM_SECONDS = 2.5, FILM_SKIN_Z = 12.6, FILM_EYE_X = 31.5;
const double FILM_CANTHUS[2] = { 20.7, 42.3 };

/* mm: the corners' height; the lids' middles above and below them at rest. Millimetres the upper lid rises a radian. */
static const double corner_y = -0.8, rise[2] = { 4.4, 3.2 }, follow = 5;
static const double degree = M_PI / 180;

static const struct {
	double start, to[2];   // s, degrees
} turn[FILM_SACCADES] = { { 0.3, { 10, 2 } }, { 0.6, { -9, 5 } }, { 0.9, { 0, 0 } }, { 1.12, { 2, 0 } } };
/* A slow pursuit after the first blink: 8 degrees in 0.5 s, 30 degrees/s at its fastest. */
static const double pursuit[2] = { 1.65, 2.15 }, pursuit_to = -6;

const struct film_event film_blink[FILM_BLINKS] = { { 1.25, 1.52, 1, 0 }, { 2.2, 2.4, 0.6, 0 } };

static double jerk(double u)
{
	u = fmin(1, fmax(0, u));
	return u * u * u * (10 + u * (6 * u - 15));
}

struct film_event film_saccade(int i)
{
	double from[2] = { i ? turn[i - 1].to[0] : 0, i ? turn[i - 1].to[1] : 0 }, a[3], b[3], dot = 0;
	const double *to[2] = { from, turn[i].to };
	for (int k = 0; k < 2; k++) {
		double *d = k ? b : a, h = to[k][0] * degree, v = to[k][1] * degree;
		d[0] = sin(h) * cos(v), d[1] = sin(v), d[2] = cos(h) * cos(v);
	}
	for (int k = 0; k < 3; k++)
		dot += a[k] * b[k];
	double size = acos(fmin(1, dot)) / degree, duration = 0.021 + 0.0022 * size;
	return (struct film_event){ turn[i].start, turn[i].start + duration, size, 1.875 * size / duration };
}

struct film_state film_at(double t)
{
	struct film_state s = { .head = { 0.8 * sin(2.5 * t), 0.5 * sin(3.1 * t) } };
	double at[2] = { 0, 0 };
	for (int i = 0; i < FILM_SACCADES; i++) {
		struct film_event e = film_saccade(i);
		double u = jerk((t - e.start) / (e.end - e.start));
		for (int k = 0; k < 2; k++)
			at[k] += u * (turn[i].to[k] - (i ? turn[i - 1].to[k] : 0));
	}
	at[0] += (pursuit_to - turn[FILM_SACCADES - 1].to[0]) * jerk((t - pursuit[0]) / (pursuit[1] - pursuit[0]));
	s.gaze[0] = at[0] * degree;
	s.gaze[1] = at[1] * degree;
	s.gaze[2] = 1.5 * degree * sin(4 * t);
	for (int i = 0; i < FILM_BLINKS; i++) {
		// down in a third of the time, a tenth at the bottom, up in the rest
		double u = (t - film_blink[i].start) / (film_blink[i].end - film_blink[i].start);
		s.closure += film_blink[i].size * jerk(u / 0.33) * (1 - jerk((u - 0.43) / 0.57));
	}
	return s;
}

double film_rest_margin(double x, bool lower)
{
	double u = (fabs(x) - FILM_CANTHUS[0]) / (FILM_CANTHUS[1] - FILM_CANTHUS[0]);
	return corner_y + (u > 0 && u < 1 ? (lower ? -rise[1] : rise[0]) * 4 * u * (1 - u) : 0);
}

static double scale(void)
{
	return PAINTED_FOCAL / (PAINTED_FAR - FILM_SKIN_Z);
}

/* An eye as painted_eye.h has it: px of its own picture, whose middle is this one's. */
static struct painted_eye eye_of(const struct film_state *s, double side)
{
	struct painted_eye eye = { .center = { side * FILM_EYE_X + s->head[0], s->head[1], 0 }, .iris = { 96, 74, 50 }, .skin = { 196, 142, 118 } };
	double px = scale(), open = rise[0] + follow * s->gaze[1];
	memcpy(eye.gaze, s->gaze, sizeof eye.gaze);
	// from left to right in the picture
	for (int c = 0; c < 2; c++) {
		eye.canthus[c][0] = 0.5 * PAINTED_W + px * (side * FILM_CANTHUS[side > 0 ? c : !c] + s->head[0]);
		eye.canthus[c][1] = 0.5 * PAINTED_H - px * (corner_y + s->head[1]);
	}
	eye.rise[1] = px * rise[1];
	eye.rise[0] = px * ((1 - s->closure) * open - s->closure * (rise[1] + 0.05));
	return eye;
}

/* 0..1 at a corner of a lattice. */
static double hash(int x, int y)
{
	uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u;
	h = (h ^ h >> 15) * 0x2c1b3c6du;
	h = (h ^ h >> 12) * 0x297a2d39u;
	return (h ^ h >> 15) / 4294967296.0;
}

/* Blotches of so many px, -0.5 .. 0.5. */
static double blotch(double x, double y, double size)
{
	int i = (int)floor(x / size), j = (int)floor(y / size);
	double u = x / size - i, v = y / size - j;
	u = u * u * (3 - 2 * u);
	v = v * v * (3 - 2 * v);
	return (1 - v) * ((1 - u) * hash(i, j) + u * hash(i + 1, j)) + v * ((1 - u) * hash(i, j + 1) + u * hash(i + 1, j + 1)) - 0.5;
}

/* The skin's own pattern, which the head carries along. Lashes begin a little outside the margins and move with them; the upper lid is a little darker. */
static void paint(double out[3], const struct painted_eye *eye, double x, double y, const double moved[2])
{
	double up = painted_eye_lid(eye, 0, x), low = painted_eye_lid(eye, 1, x);
	if (y > up && y < low) {
		painted_eye_globe(out, eye, x, y);
		return;
	}
	bool beyond = isnan(up), lower = !beyond && y > 0.5 * (up + low);
	double away = beyond ? 100 : lower ? y - low : up - y, u = x - moved[0], v = y - moved[1];
	double lash = away > 6 && away < (lower ? 14 : 22) && fmod(u + 0.4 * away + 1000, 5) < 1.2 ? 0.4 : 1;
	double pores = 1 + 0.22 * blotch(u, v, 4) + 0.16 * blotch(u + 300, v, 9);
	for (int c = 0; c < 3; c++)
		out[c] = eye->skin[c] * pores * lash;
}

/* Near a margin or within the opening, where a pixel is not of one colour. */
static bool is_fine(const struct painted_eye *eye, double x, double y)
{
	double up = painted_eye_lid(eye, 0, x), low = painted_eye_lid(eye, 1, x);
	return y > up - 25 && y < low + 17;
}

void film_draw(uint8_t *rgb, double t, uint64_t seed)
{
	enum { SUB = 2, NOISE = 4096 };
	struct film_state s = film_at(t);
	const struct painted_eye eyes[2] = { eye_of(&s, -1), eye_of(&s, 1) };
	const double moved[2] = { scale() * s.head[0], -scale() * s.head[1] };
	struct rng rng = { seed };
	double noise[NOISE];
	for (int i = 0; i < NOISE; i++)
		noise[i] = 1.5 * rng_normal(&rng);
	for (int y = 0; y < FILM_H; y++)
		for (int x = 0; x < FILM_W; x++) {
			const struct painted_eye *eye = &eyes[x >= FILM_W / 2];
			double sum[3] = { 0 }, one[3], left = x - 0.5 * (FILM_W - PAINTED_W), top = y - 0.5 * (FILM_H - PAINTED_H), grain = noise[rng_bits(&rng) % NOISE];
			int sub = is_fine(eye, left + 0.5, top + 0.5) ? SUB : 1;
			for (int k = 0; k < sub * sub; k++) {
				paint(one, eye, left + (k % sub + 0.5) / sub, top + (double)(k / sub + 0.5) / sub, moved);
				for (int c = 0; c < 3; c++)
					sum[c] += one[c] / (sub * sub);
			}
			for (int c = 0; c < 3; c++)
				rgb[3 * (y * FILM_W + x) + c] = (uint8_t)fmin(255, fmax(0, sum[c] + grain + 0.5));
		}
}
