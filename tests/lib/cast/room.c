#include "tests/lib/cast/cast_impl.h"

static double corner(int x, int y, uint32_t seed)
{
	uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ seed * 0xcb1ab31fu;
	h ^= h >> 15;
	h *= 0x2c1b3c6du;
	h ^= h >> 12;
	h *= 0x297a2d39u;
	h ^= h >> 15;
	return h / 2147483648.0 - 1;
}

double cast_noise(double x, double y, uint32_t seed)
{
	const double fx = floor(x), fy = floor(y);
	double u = x - fx, v = y - fy;
	const int i = (int)fx, j = (int)fy;
	u = u * u * (3 - 2 * u);
	v = v * v * (3 - 2 * v);
	const double a = corner(i, j, seed), b = corner(i + 1, j, seed), c = corner(i, j + 1, seed), d = corner(i + 1, j + 1, seed);
	return a + u * (b - a) + v * (c - a + u * (a - b - c + d));
}

double cast_cloud(double x, double y, uint32_t seed, int octaves)
{
	double sum = 0, size = 0.5;
	for (int k = 0; k < octaves; k++, size *= 0.5) {
		sum += size * cast_noise(x, y, seed + (uint32_t)k);
		const double t = 1.6 * x + 1.2 * y;
		y = 1.6 * y - 1.2 * x;
		x = t;
	}
	return sum;
}

/* CIE daylight and lamps, roughly: red and blue against green by the temperature. */
static void colour(double rgb[3], double kelvin)
{
	const double m = 1e6 / kelvin - 1e6 / 6500;
	rgb[0] = exp(0.0026 * m);
	rgb[1] = 1;
	rgb[2] = exp(-0.0052 * m);
}

void cast_lamps(struct cast_room *r, struct rng *rng)
{
	const double kelvin = rng_below(rng, 3) ? rng_range(rng, 4500, 7500) : rng_range(rng, 2600, 3600);
	r->lamps = 1 + rng_below(rng, LAMPS);
	r->seed = (uint32_t)rng_bits(rng);
	for (int k = 0; k < r->lamps; k++) {
		struct lamp *l = &r->lamp[k];
		const double high = k ? rng_range(rng, -0.3, 0.7) : rng_range(rng, 0, 0.8);
		l->to = unit(vec(rng_range(rng, -0.9, 0.9), high, rng_range(rng, 0.5, 1)));
		l->side = unit(cross(vec(0.1 * rng_normal(rng), 1, 0), l->to));
		l->up = cross(l->to, l->side);
		l->half[0] = rng_range(rng, 0.03, 0.35);
		l->half[1] = l->half[0] * rng_range(rng, 0.5, 2);
		l->panes = rng_below(rng, 4);  // 0 round, 1 one pane, more: a window
		l->bright = (k ? rng_range(rng, 0.1, 0.5) : rng_range(rng, 0.5, 1));
		colour(l->rgb, kelvin * (k ? rng_range(rng, 0.85, 1.2) : 1));
	}
	const double fill = rng_range(rng, 0.1, 0.6);
	double tone[3];
	colour(tone, kelvin);
	for (int c = 0; c < 3; c++)
		r->ambient[c] = fill * tone[c] * rng_range(rng, 0.95, 1.05);
	r->floor = rng_range(rng, 0.05, 0.4);
	r->wall = rng_range(rng, 0.2, 1.2);
	r->skyline = rng_range(rng, -0.4, 0.5);
}

void cast_light(double out[3], const struct cast_room *r, struct vec n, double lit)
{
	for (int c = 0; c < 3; c++)
		out[c] = r->ambient[c] * (0.75 + 0.25 * n.y);
	for (int k = 0; k < r->lamps; k++) {
		const struct lamp *l = &r->lamp[k];
		const double soft = 0.15, e = l->bright * fmax(dot(n, l->to) + soft, 0) / (1 + soft) * (k ? 1 : lit);
		for (int c = 0; c < 3; c++)
			out[c] += e * l->rgb[c];
	}
}

void cast_mirror(double out[3], const struct cast_room *r, struct vec d)
{
	const double sky = blend(r->skyline - 0.05, r->skyline + 0.05, d.y + 0.1 * cast_noise(4 * d.x, 1, r->seed));
	const double level = (r->floor + sky * (r->wall - r->floor)) * (1 + 0.7 * cast_cloud(6 * d.x, 6 * d.y, r->seed + 9, 3));
	for (int c = 0; c < 3; c++)
		out[c] = r->ambient[c] * fmax(level, 0);
	for (int k = 0; k < r->lamps; k++) {
		const struct lamp *l = &r->lamp[k];
		const double ahead = dot(d, l->to);
		if (ahead < 0.2)
			continue;
		const double s = dot(d, l->side) / ahead / l->half[0], t = dot(d, l->up) / ahead / l->half[1], edge = 0.06;
		double in = l->panes ? fmin(1 - fabs(s), 1 - fabs(t)) : 1 - hypot(s, t);
		if (l->panes > 1)
			in = fmin(in, fmin(fabs(fmod(fabs(s) * l->panes, 1) - 0.5 * (l->panes & 1)), fabs(t)) - 0.05);
		const double hit = blend(0, edge, in), area = 4 * l->half[0] * l->half[1];
		for (int c = 0; c < 3; c++)
			out[c] += hit * l->rgb[c] * fmin(l->bright * 2 / area, 60);
	}
}
