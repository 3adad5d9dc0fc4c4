#include "tests/lib/cast/cast_impl.h"

void cast_eye_make(struct cast_eye *e, struct rng *rng)
{
	*e = (struct cast_eye){ .limbus = rng_range(rng, 5.5, 6.2), .aspect = clamp(0.93 + 0.025 * rng_normal(rng), 0.87, 1), .sclera = rng_range(rng, 11.3, 12.4),
		.cornea = rng_range(rng, 7.3, 8.3), .p = rng_range(rng, 0.6, 0.95), .depth = rng_range(rng, 2.9, 3.7), .pupil = rng_range(rng, 1, 3.3),
		.pupil_at = { 0.15 * rng_normal(rng), 0.12 * rng_normal(rng) }, .pupil_squash = 1 + 0.02 * rng_normal(rng), .ramp = rng_range(rng, 0.03, 0.2) };
	const double r = e->limbus;
	e->limbus_at = (e->cornea - sqrt(e->cornea * e->cornea - e->p * r * r)) / e->p;
	const double level = exp(rng_range(rng, log(0.03), log(0.35))), blue = rng_uniform(rng), warm = rng_range(rng, 0.3, 1);
	const double cold[3] = { 0.55, 0.75, 1 }, amber[3] = { 1, 0.58, 0.22 }, moss[3] = { 0.8, 0.95, 0.5 };
	const double *outer = level < 0.07 || blue < 0.35 ? amber : blue < 0.6 ? moss : cold;
	for (int c = 0; c < 3; c++) {
		e->base[c] = level * outer[c] * rng_range(rng, 0.85, 1.1);
		e->tint[c] = level * (warm * amber[c] + (1 - warm) * outer[c]) * rng_range(rng, 0.5, 1.3);
	}
	const double white = rng_range(rng, 0.5, 0.85), yellow = rng_range(rng, 0, 0.25);
	e->white[0] = white;
	e->white[1] = white * (0.97 - 0.3 * yellow);
	e->white[2] = white * (0.95 - yellow);
	e->root_dark = rng_range(rng, 0, 0.75);
	e->collar = rng_range(rng, 0.25, 0.5);
	e->fibre = rng_range(rng, 0.15, 0.9);
	e->crypt = rng_range(rng, 0, 0.8);
	e->vessels = rng_range(rng, 0, 1);
	e->haze = rng_below(rng, 4) ? 0.004 : rng_range(rng, 0.004, 0.02);
	e->seed = (uint32_t)rng_bits(rng);
}

void cast_eye_of_animal(struct cast_eye *e, struct rng *rng)
{
	static const double gold[3] = { 0.4, 0.32, 0.08 };
	e->limbus = rng_range(rng, 9, 10);
	e->aspect = 1;
	e->cornea = rng_range(rng, 10.5, 11);
	e->p = 1;
	e->limbus_at = e->cornea - sqrt(e->cornea * e->cornea - e->limbus * e->limbus);
	e->depth = e->limbus_at;
	e->pupil_squash = rng_below(rng, 4) ? rng_range(rng, 0.15, 0.4) : rng_range(rng, 2.5, 5);
	e->pupil = rng_range(rng, 0.8, 1.8) * (e->pupil_squash > 1 ? 3 : 1);
	for (int c = 0; c < 3; c++) {
		e->base[c] = gold[c] * rng_range(rng, 0.5, 1.2);
		e->white[c] *= 0.3;
	}
}

/* Albedo of the iris at (x, y) of the eye, mm. */
static bool iris_at(double out[3], const struct cast_eye *e, double x, double y)
{
	const double px = x - e->pupil_at[0], py = (y - e->pupil_at[1]) * e->pupil_squash, angle = atan2(y, x);
	const double way = (hypot(px, py) - e->pupil) / fmax(e->limbus - e->pupil, 0.5);
	if (way < 0) {
		for (int c = 0; c < 3; c++)
			out[c] = e->haze;
		return false;
	}
	// Fibres come in bundles that part and join: noise round a circle, so that it closes, pulled by slower noise.
	const double s = clamp(way, 0, 1), wave = 0.12 * cast_noise(9 * cos(angle), 9 * sin(angle) + 3 * s, e->seed) * s, f = 30 + 10 * s;
	const double line = cast_noise(f * cos(angle + wave) + 1.3 * s, f * sin(angle + wave) - 1.1 * s, e->seed + 3);
	const double bundle = cast_cloud(7 * cos(angle + wave), 7 * sin(angle + wave) + 2.5 * s, e->seed + 7, 3);
	const double pit = blend(0.25, 0.6, cast_noise(4 * cos(angle) + 9 * s, 4 * sin(angle) + 9 * s, e->seed + 11)) * bump((s - e->collar - 0.15) / 0.25);
	const double edge = s - e->collar - 0.05 * cast_noise(5 * cos(angle), 5 * sin(angle), e->seed + 13), inner = 1 - blend(-0.06, 0.08, edge);
	const double texture = (1 + e->fibre * (0.8 * line + 0.9 * bundle)) * (1 - 0.7 * e->crypt * pit) * (1 + 0.35 * bump(edge / 0.05));
	const double level = texture * (1 - e->root_dark * blend(0.78, 1, s)) * (1 - 0.5 * bump(s / 0.04));
	for (int c = 0; c < 3; c++)
		out[c] = fmax((e->base[c] + inner * (e->tint[c] - e->base[c])) * level, 0.006);
	return true;
}

static void sclera_at(double out[3], const struct cast_eye *e, struct vec q)
{
	const double a = atan2(q.y, q.x), r = hypot(q.x, q.y), far = blend(e->limbus, 11, r);
	double red = 0;
	for (int k = 0; k < 2; k++) {
		const double v = fabs(cast_cloud((5 + 4 * k) * a + 0.3 * k, 0.35 * r, e->seed + 30 + (uint32_t)k, 3));
		red += (1 - blend(0.01, 0.05, v)) * (k ? 0.4 : 0.6);
	}
	red = clamp(e->vessels * (red * far + 0.25 * far * far), 0, 1);
	const double patch = 1 + 0.06 * cast_cloud(0.5 * q.x, 0.5 * q.y, e->seed + 40, 3);
	for (int c = 0; c < 3; c++)
		out[c] = e->white[c] * patch * (1 - (c == 0 ? 0.12 : c == 1 ? 0.5 : 0.45) * red);
}

/* Distance along o + t d (eye's own axes, z into the eye from the apex, y stretched by 1 / aspect) to the cornea within the limbus, or to
 * the sclera; negative: none. */
static double to_cornea(const struct cast_eye *e, struct vec o, struct vec d)
{
	const double a = d.x * d.x + d.y * d.y + e->p * d.z * d.z, b = o.x * d.x + o.y * d.y + e->p * o.z * d.z - e->cornea * d.z;
	const double k = o.x * o.x + o.y * o.y + e->p * o.z * o.z - 2 * e->cornea * o.z, q = b * b - a * k;
	if (q < 0)
		return -1;
	const double t = (-b - sqrt(q)) / a;
	return o.z + t * d.z <= e->limbus_at ? t : -1;
}

static double to_sclera(const struct cast_eye *e, struct vec o, struct vec d)
{
	const double mid = e->limbus_at + sqrt(e->sclera * e->sclera - e->limbus * e->limbus);
	const struct vec m = vec(o.x, o.y, o.z - mid);
	const double a = dot(d, d), b = dot(m, d), q = b * b - a * (dot(m, m) - e->sclera * e->sclera);
	return q < 0 ? -1 : (-b - sqrt(q)) / a;
}

/* Share of the first lamp's light that passes below the upper lid to p. */
static double lit_at(const struct cast *c, struct vec p)
{
	const struct vec to = c->room.lamp[0].to;
	const double b = dot(p, to), q = b * b - dot(p, p) + c->lids.shell * c->lids.shell;
	if (q <= 0)
		return 1;
	const double in = cast_inside(&c->lids, add(p, -b + sqrt(q), to));
	return blend(-0.4 * c->room.lamp[0].half[1] - 0.03, 0.4 * c->room.lamp[0].half[1] + 0.03, in);
}

struct local { struct vec o, d, s, sd; };  // of the eye's axes; s, sd: stretched

static struct local localise(const struct cast_eye *e, struct vec o, struct vec d)
{
	const struct vec r = add(o, -1, e->apex);
	struct local l = { .o = vec(dot(r, e->x), dot(r, e->y), -dot(r, e->axis)), .d = vec(dot(d, e->x), dot(d, e->y), -dot(d, e->axis)) };
	l.s = vec(l.o.x, l.o.y / e->aspect, l.o.z);
	l.sd = vec(l.d.x, l.d.y / e->aspect, l.d.z);
	return l;
}

static struct vec to_head(const struct cast_eye *e, struct vec v)
{
	return add(add(scaled(e->x, v.x), v.y, e->y), -v.z, e->axis);
}

/* Where the ray that enters the cornea at k (normal n, direction d; eye's axes) meets the plane of the iris. */
static void on_iris(double at[2], const struct cast_eye *e, struct vec k, struct vec n, struct vec d)
{
	const double eta = 1 / 1.336, ci = -dot(n, d), ct = sqrt(1 - eta * eta * (1 - ci * ci));
	const struct vec in = add(scaled(d, eta), eta * ci - ct, n);
	const double t = (e->depth - k.z) / in.z;
	at[0] = k.x + t * in.x;
	at[1] = k.y + t * in.y;
}

/* Iris or pupil behind the cornea at k, lit. */
static void below(double out[3], const struct cast *c, struct vec k, struct vec n, struct vec d, double lit)
{
	const struct cast_eye *e = &c->eye;
	double at[2];
	on_iris(at, e, k, n, d);
	const double x = at[0], y = at[1];
	double on[3];
	iris_at(out, e, x, y);
	cast_light(on, &c->room, e->axis, lit);
	const struct vec to = c->room.lamp[0].to;
	const double gather = clamp(1 - 0.07 * c->room.lamp[0].bright * (x * dot(to, e->x) + y * dot(to, e->y)), 0.6, 1.5);
	for (int i = 0; i < 3; i++)
		out[i] *= on[i] * gather;
}

static struct vec cornea_normal(const struct cast_eye *e, struct vec s)
{
	return unit(vec(s.x, s.y / e->aspect, e->p * s.z - e->cornea));
}

bool cast_meets_pupil(const struct cast *c, struct vec d)
{
	const struct cast_eye *e = &c->eye;
	const struct local l = localise(e, c->camera, d);
	const double t = to_cornea(e, l.s, l.sd);
	double at[2];
	if (t < 0)
		return false;
	on_iris(at, e, add(l.o, t, l.d), cornea_normal(e, add(l.s, t, l.sd)), l.d);
	return hypot(at[0] - e->pupil_at[0], (at[1] - e->pupil_at[1]) * e->pupil_squash) < e->pupil;
}

static double eyeball(double out[3], const struct cast *c, struct vec at, const struct local *l, double t, bool cornea)
{
	const struct cast_eye *e = &c->eye;
	const struct vec k = add(l->o, t, l->d), s = add(l->s, t, l->sd);
	const double mid = e->limbus_at + sqrt(e->sclera * e->sclera - e->limbus * e->limbus), from = hypot(s.x, s.y) - e->limbus;
	const struct vec round = unit(vec(s.x, s.y / e->aspect, s.z - mid)), n = cornea ? cornea_normal(e, s) : round;
	const double lit = lit_at(c, at), share = 0.5 + 0.5 * tanh(from / e->ramp), inside = cast_inside(&c->lids, at);
	double white[3], on[3], dark[3];
	sclera_at(white, e, k);
	cast_light(on, &c->room, to_head(e, round), lit);
	if (share < 0.999)
		below(dark, c, cornea ? k : vec(e->limbus * s.x / hypot(s.x, s.y), e->limbus * k.y / hypot(s.x, s.y), e->limbus_at), n, l->d, lit);
	// Lids take light away from what lies deep between them; the inner corner is pink.
	const double open = 0.35 + 0.65 * blend(-0.03, 0.13, inside), away = fabs(atan2(at.x, at.z) - c->lids.inner[0]), pink = 1 - blend(0.1, 0.2, away);
	const double flesh[3] = { 0.5, 0.24, 0.2 };
	for (int i = 0; i < 3; i++) {
		white[i] = (white[i] + pink * (flesh[i] - white[i])) * on[i];
		out[i] = (share < 0.999 ? dark[i] + share * (white[i] - dark[i]) : white[i]) * open;
	}
	struct vec m = to_head(e, n), d = to_head(e, l->d);
	if (!cornea)
		m = unit(add(m, 0.08, vec(cast_noise(at.x, at.y, e->seed + 60), cast_noise(at.x, at.y, e->seed + 61), 0)));
	double glow[3];
	cast_mirror(glow, &c->room, add(d, -2 * dot(d, m), m));
	const double graze = 1 - clamp(-dot(d, m), 0, 1), fresnel = 0.024 + (cornea ? 0.9 : 0.1) * pow(graze, 5), clear = blend(-0.05, 0.1, inside);
	double sum = 0, all = 0;
	for (int i = 0; i < 3; i++) {
		sum += glow[i] * fresnel * clear;
		out[i] += glow[i] * fresnel * clear;
		all += out[i];
	}
	// The tears' edge on the lower lid.
	double margin[2];
	cast_margins(margin, &c->lids, atan2(at.x, at.z));
	const double rim = bump((asin(clamp(at.y / sqrt(dot(at, at)), -1, 1)) - margin[1] - 0.012) / 0.008);
	for (int i = 0; i < 3; i++)
		out[i] += 0.1 * rim * on[i];
	return sum / fmax(all, 1e-9);
}

enum cast_hit cast_trace(double out[3], struct cast_seen *seen, const struct cast *c, struct vec d)
{
	const struct vec p = cast_relief(c, d);
	*seen = (struct cast_seen){ .inside = cast_inside(&c->lids, p) };
	if (seen->inside <= 0) {
		cast_skin(out, c, p, d);
		return CAST_SKIN;
	}
	const struct local l = localise(&c->eye, c->camera, d);
	double t = to_cornea(&c->eye, l.s, l.sd);
	const bool cornea = t > 0;
	if (!cornea)
		t = to_sclera(&c->eye, l.s, l.sd);
	const struct vec at = add(c->camera, t, d);
	if (t < 0 || cast_inside(&c->lids, at) < -0.02) {
		// The thickness of a lid: moist, pink.
		double on[3];
		cast_light(on, &c->room, unit(vec(0.2 * p.x, p.y > 0 ? -3 : 8, 10)), 1);
		for (int i = 0; i < 3; i++)
			out[i] = (0.4 * c->skin.rgb[i] + (i ? 0.12 : 0.27)) * on[i];
		return CAST_RIM;
	}
	seen->mirrored = eyeball(out, c, at, &l, t, cornea);
	return cornea ? CAST_IRIS : CAST_SCLERA;
}
