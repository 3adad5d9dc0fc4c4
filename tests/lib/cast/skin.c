#include "tests/lib/cast/cast_impl.h"

/* One lid's height over the line between the corners, t from inner (0) to outer (1) corner. */
static double arch(const struct cast_lids *l, int lower, double t)
{
	const double u = pow(t, l->skew[lower]);
	return l->rise[lower] * pow(fmax(4 * u * (1 - u), 0), l->full[lower]);
}

void cast_margins(double at[2], const struct cast_lids *l, double azimuth)
{
	const double t = (azimuth - l->inner[0]) / (l->outer[0] - l->inner[0]), s = clamp(t, 0, 1), line = l->inner[1] + s * (l->outer[1] - l->inner[1]);
	at[0] = line + arch(l, 0, s);
	at[1] = line - arch(l, 1, s);
}

static void angles(double out[2], struct vec p)
{
	out[0] = atan2(p.x, p.z);
	out[1] = asin(clamp(p.y / sqrt(dot(p, p)), -1, 1));
}

double cast_inside(const struct cast_lids *l, struct vec p)
{
	double a[2], m[2];
	angles(a, p);
	const double t = (a[0] - l->inner[0]) / (l->outer[0] - l->inner[0]);
	if (p.z <= 0 || t < 0 || t > 1)
		return -0.2;
	cast_margins(m, l, a[0]);
	// Skin that stands far out before the shell is no opening.
	return fmin(fmin(m[0] - a[1], a[1] - m[1]), 0.08 * (l->shell + 1.6 - sqrt(dot(p, p))));
}

/* How far the skin stands out at (u, v), mm: the lids' shell in a socket below brow and beside the nose. */
static double relief(const struct cast *c, double u, double v, bool fine)
{
	const struct cast_lids *l = &c->lids;
	const double away = u * u + v * v, shell = sqrt(fmax(l->shell * l->shell - away, 0.01));
	const double inward = l->inner[0] < l->outer[0] ? -u : u, azimuth = atan2(u, shell), elevation = asin(clamp(v / l->shell, -1, 1));
	const double face = l->depth + l->brow * bump((v - 17) / 8) + l->nose * bump((inward - 24) / 7) - 0.004 * away
	                    + l->bag * bump((v + 14 - 0.02 * u * u) / 3) * bump(u / 14);
	const double k = 0.7, top = fmax(shell, face);
	double h = top + log(exp((shell - top) * k) + exp((face - top) * k)) / k;
	double m[2];
	cast_margins(m, l, azimuth);
	const double over = (elevation - m[0] - l->crease) * l->shell, wide = 0.5 + l->puff;
	h -= l->crease_deep * bump(over / wide) * bump(u / 13);
	if (over > 0)
		h += l->puff * (1 - exp(-over / 2)) * exp(-over / 9) * bump(u / 16);
	if (!fine)
		return h;
	const struct cast_skin *s = &c->skin;
	h += 0.045 * s->pores * cast_cloud(3.1 * u, 3.1 * v, s->seed, 2);
	h += s->wrinkle * 0.2 * cast_cloud(0.25 * u + 3, 1.1 * v + 0.2 * u, s->seed + 5, 3);
	return h;
}

struct vec cast_relief(const struct cast *c, struct vec d)
{
	double t = (c->lids.shell - c->camera.z) / d.z;
	for (int k = 0; k < 3; k++) {
		const struct vec p = add(c->camera, t, d);
		t -= (p.z - relief(c, p.x, p.y, false)) / d.z * 0.85;
	}
	return add(c->camera, t, d);
}

void cast_skin(double out[3], const struct cast *c, struct vec p, struct vec d)
{
	const struct cast_skin *s = &c->skin;
	const double e = 0.08, h = relief(c, p.x, p.y, true);
	const struct vec n = unit(vec((h - relief(c, p.x + e, p.y, true)) / e, (h - relief(c, p.x, p.y + e, true)) / e, 1));
	double on[3], m[2], a[2];
	cast_light(on, &c->room, n, 1);
	cast_margins(m, &c->lids, atan2(p.x, p.z));
	angles(a, p);
	const double off = fmax(a[1] - m[0], m[1] - a[1]) * c->lids.shell, near = bump(off / 1.1), ring = bump(off / 9);
	const double patch = cast_cloud(0.12 * p.x, 0.12 * p.y, s->seed + 20, 3), mole = blend(0.5 - 0.15 * s->spots, 0.6, cast_cloud(0.8 * p.x, 0.8 * p.y, s->seed + 40, 3));
	const double red = s->red * (0.3 * patch + 0.9 * near + 0.25 * ring);
	double shine = 0;
	for (int k = 0; k < c->room.lamps; k++) {
		const double half = fmax(dot(n, unit(add(c->room.lamp[k].to, -1, d))), 0);
		shine += s->oil * c->room.lamp[k].bright * (pow(half, 18) * 0.3 + pow(half, 80) * 0.5 * near);
	}
	const double fine = 1 + 0.12 * s->pores * cast_noise(5 * p.x, 5 * p.y, s->seed + 50);
	for (int k = 0; k < 3; k++) {
		const double albedo = s->rgb[k] * fine * (1 + 0.3 * patch) * (1 - (k ? 0.35 : 0.08) * clamp(red, -0.5, 1.5)) * (1 - 0.6 * s->spots * mole);
		out[k] = (albedo + shine) * on[k];
	}
}
