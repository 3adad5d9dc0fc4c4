#include "ball.h"

#include "math/ellipse_fit.h"
#include "scene.h"

static const float AQUEOUS = 1.336F;

static float range(struct rng *rng, double lo, double hi)
{
	return (float)rng_range(rng, lo, hi);
}

static float dot3(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Two limbi in three are as people's (11.7 mm across, 10.6 to 11 high), the others nearly circles, as on models and in many renderings. */
static float aspect_of(struct rng *rng)
{
	const float circle = (float)fabs(0.01 * rng_normal(rng)), people = (float)(0.93 + 0.028 * rng_normal(rng));
	return rng_below(rng, 3) ? fminf(fmaxf(people, 0.85F), 1) : 1 - circle;
}

struct ball ball_make(struct rng *rng, bool test)
{
	struct rng own = { rng->state ^ 0x632be59bd9b4e019 };
	struct ball b = { .radius = range(rng, 11.5, 12.6), .limbus = range(rng, 5.4, 6.4), .depth = range(rng, -0.3, 0.5) };
	b.aspect = aspect_of(&own);
	b.cornea = range(rng, 7.1, 8.4);
	b.to_limbus = sqrtf(b.radius * b.radius - b.limbus * b.limbus);
	b.to_cornea = b.to_limbus - sqrtf(b.cornea * b.cornea - b.limbus * b.limbus);
	// What is seen is larger by an eighth: 1.5 to 8.5 mm.
	b.pupil = fminf(range(rng, 0, 1) < 0.5 ? range(rng, 0.7, 2.2) : range(rng, 1.2, 3.8), 0.8F * b.limbus);
	b.pupil_at[0] = (float)(0.15 * rng_normal(rng));
	b.pupil_at[1] = (float)(0.12 * rng_normal(rng));
	b.pupil_wave[0] = rng_below(rng, 4) ? range(rng, 0, 0.02) : range(rng, 0.02, 0.07);
	b.pupil_wave[1] = range(rng, 0, 6.28);
	b.haze = rng_below(rng, 3) ? range(rng, 0, 0.008) : range(rng, 0.005, 0.04);
	b.blur = range(rng, 0.05, 0.5);
	b.near_limbus = 3;
	const float white = range(rng, 0.45, 0.85), yellow = range(rng, 0, 0.35);
	b.sclera[0] = white;
	b.sclera[1] = white * (1 - 0.25F * yellow - range(rng, 0, 0.08));
	b.sclera[2] = white * (1 - yellow * 0.8F + range(rng, -0.08, 0.06));
	b.red = range(rng, 0.2, 1);
	const float pink = range(rng, 0.35, 0.75);
	b.canthus[0] = pink;
	b.canthus[1] = pink * range(rng, 0.35, 0.7);
	b.canthus[2] = pink * range(rng, 0.3, 0.65);
	b.vessels = range(rng, 0, 0.9) * range(rng, 0.2, 1);
	b.vessel_scale = range(rng, 5, 12);
	b.at[0] = range(rng, 0, 256);
	b.at[1] = range(rng, 0, 256);
	b.veins = field_of(FIELD_RIDGE, rng_below(rng, FIELD_SEEDS), test);
	b.stain = field_of(FIELD_SMOOTH, rng_below(rng, FIELD_SEEDS), test);
	b.wet = range(rng, 0.05, 0.8);
	b.shine = rng_below(rng, 3) ? range(rng, 0, 0.4) : range(rng, 0.3, 1);
	b.iris = iris_make(rng, test);
	ball_look(&b, 0, 0);
	return b;
}

void ball_look(struct ball *b, float x, float y)
{
	const float r = x * x + y * y, shrink = r > 0.6F ? sqrtf(0.6F / r) : 1;
	b->gaze[0] = x * shrink;
	b->gaze[1] = y * shrink;
	b->gaze[2] = sqrtf(1 - b->gaze[0] * b->gaze[0] - b->gaze[1] * b->gaze[1]);
	const float n = sqrtf(b->gaze[0] * b->gaze[0] + b->gaze[2] * b->gaze[2]);
	b->side[0] = b->gaze[2] / n;
	b->side[1] = 0;
	b->side[2] = -b->gaze[0] / n;
	b->up[0] = b->gaze[1] * b->side[2] - b->gaze[2] * b->side[1];
	b->up[1] = b->gaze[2] * b->side[0] - b->gaze[0] * b->side[2];
	b->up[2] = b->gaze[0] * b->side[1] - b->gaze[1] * b->side[0];
}

static void sclera_at(float albedo[3], const struct ball *b, float x, float y, float from_limbus)
{
	const float side = fminf(fabsf(x) / 12, 1), stain = field_at(b->stain, b->at[0] + 6 * x, b->at[1] + 6 * y);
	float vein = field_at(b->veins, b->at[0] + b->vessel_scale * x * 0.6F, b->at[1] + b->vessel_scale * y + 8 * stain);
	vein = vein > 0.72F ? fminf((vein - 0.72F) * 6, 1) : 0;
	vein *= b->vessels * (0.25F + side) * fminf(from_limbus / b->near_limbus, 1);
	const float pink = b->red * (0.45F * side * side + 0.2F * (stain - 0.5F));
	const float red[3] = { 0.06F, 0.5F, 0.45F };
	for (int c = 0; c < 3; c++)
		albedo[c] = b->sclera[c] * (1 - red[c] * fmaxf(pink, 0)) * (1 - (c ? 0.75F : 0.25F) * vein);
}

/* Radius of the limbus about the gaze towards p, mm. */
static float limbus_towards(const struct ball *b, const float p[3])
{
	const float u = dot3(p, b->side), v = dot3(p, b->up) / b->aspect, w = dot3(p, b->up), rho = sqrtf(u * u + w * w);
	return rho > 1e-6F ? b->limbus * rho / sqrtf(u * u + v * v) : b->limbus;
}

/* Where the ray that enters the cornea at p (normal n) meets the iris plane: radius and angle about the gaze's axis, mm. */
static bool through_cornea(float *radius, float *angle, float at[2], const struct ball *b, const float p[3], const float n[3])
{
	const float eta = 1 / AQUEOUS, k = 1 - eta * eta * (1 - n[2] * n[2]), along = eta * n[2] - sqrtf(k);
	const float d[3] = { along * n[0], along * n[1], along * n[2] - eta };
	const float fall = dot3(d, b->gaze);
	if (fall > -0.05F)
		return false;
	const float t = (b->to_limbus - b->depth - dot3(p, b->gaze)) / fall;
	const float q[3] = { p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2] };
	at[0] = dot3(q, b->side);
	at[1] = dot3(q, b->up);
	*radius = hypotf(at[0], at[1]);
	*angle = atan2f(at[1], at[0]);
	return true;
}

/* Pupil or iris, lit from the light's side through the cornea. */
static int behind_cornea(float body[3], const struct ball *b, const struct light *light, float r, float angle, const float at[2])
{
	const float dx = at[0] - b->pupil_at[0], dy = at[1] - b->pupil_at[1];
	const float edge = b->pupil * (1 + b->pupil_wave[0] * cosf(3 * angle + b->pupil_wave[1]) + 0.5F * b->pupil_wave[0] * cosf(7 * angle));
	const float from = hypotf(dx, dy) - edge;
	float on[3];
	light_on(on, light, b->gaze, 0.3F);
	if (from < 0) {
		for (int c = 0; c < 3; c++)
			body[c] = b->haze * on[c] * (c == 0 ? 1.1F : 1);
		return EVIDENCE_PUPIL;
	}
	const float share = from / (from + b->limbus - r + 1e-3F);
	iris_albedo(body, &b->iris, share > 1 ? 1 : share, angle);
	// Light that comes from one side is gathered on the other.
	float gather = 1;
	for (int i = 0; i < light->n; i++)
		gather -= 0.06F * (at[0] * light->source[i].dir[0] + at[1] * light->source[i].dir[1]);
	gather = gather < 0.5F ? 0.5F : gather > 1.6F ? 1.6F : gather;
	for (int c = 0; c < 3; c++)
		body[c] *= on[c] * gather;
	return EVIDENCE_IRIS;
}

/* Fresnel's reflection, less where `rough`: there the film is uneven and does not glare at grazing angles. */
static void mirror(float out[3], const struct light *light, const float n[3], float strength, bool rough)
{
	const float r[3] = { 2 * n[2] * n[0], 2 * n[2] * n[1], 2 * n[2] * n[2] - 1 };
	light_mirrored(out, light, r);
	const float graze = 1 - n[2], fresnel = 0.022F + (rough ? 0.05F : 0.9F) * graze * graze * graze * graze * graze;
	for (int c = 0; c < 3; c++)
		out[c] *= strength * fresnel;
}

/* mm by which a ragged limbus lies nearer to the gaze at (x, y). */
static float strays(const struct ball *b, float x, float y)
{
	const float coarse = field_at(b->stain, b->at[1] + 9 * x, b->at[0] + 9 * y), fine = field_at(b->stain, b->at[0] - 31 * y, b->at[1] + 31 * x);
	return b->ragged * (coarse + 0.7F * fine - 0.85F);
}

/* Share of the sclera at `from` mm beyond the limbus. */
static float ramp(const struct ball *b, float x, float y, float from)
{
	float width = b->blur;
	if (b->ragged > 0) {
		from += strays(b, x, y);
		width *= 0.5F + field_at(b->stain, b->at[1] - 14 * y, b->at[0] + 14 * x);
	}
	return 1 / (1 + expf(-1.7F * from / width));
}

/* The white part, blended into `under` (the iris) towards the limbus. */
static void white(struct ball_point *out, const struct ball *b, const struct light *light, float x, float y, const float n[3], float from,
                  float share)
{
	float albedo[3], on[3];
	sclera_at(albedo, b, x, y, fmaxf(from, 0));
	light_on(on, light, n, 0.45F);
	for (int c = 0; c < 3; c++)
		out->body[c] += share * (albedo[c] * on[c] - out->body[c]);
}

void ball_at(struct ball_point *out, const struct ball *b, const struct light *light, float x, float y)
{
	const float cx = x - b->to_cornea * b->gaze[0], cy = y - b->to_cornea * b->gaze[1], rr = b->cornea * b->cornea - cx * cx - cy * cy;
	*out = (struct ball_point){ .label = EVIDENCE_SCLERA };
	if (rr > 0) {
		const float z = sqrtf(rr), p[3] = { x, y, b->to_cornea * b->gaze[2] + z }, n[3] = { cx / b->cornea, cy / b->cornea, z / b->cornea };
		const float a = dot3(p, b->gaze);
		if (a > b->to_limbus) {
			float r = 0, angle = 0, at[2];
			const float from = sqrtf(fmaxf(dot3(p, p) - a * a, 0)) - limbus_towards(b, p);
			const float m = 1 / sqrtf(dot3(p, p)), flat[3] = { p[0] * m, p[1] * m, p[2] * m };
			if (through_cornea(&r, &angle, at, b, p, n) && (b->even || r < b->limbus * 1.02F))
				out->label = behind_cornea(out->body, b, light, r, angle, at);
			white(out, b, light, x, y, b->even ? flat : n, from, out->label == EVIDENCE_SCLERA ? 1 : ramp(b, x, y, from));
			mirror(out->mirror, light, n, 1, false);
			if (from > 0)
				out->label = EVIDENCE_SCLERA;
			return;
		}
	}
	const float s = b->radius * b->radius - x * x - y * y;
	const float z = sqrtf(fmaxf(s, 4)), m = 1 / sqrtf(x * x + y * y + z * z), p[3] = { x, y, z };
	float n[3] = { x * m, y * m, z * m };
	const float a = dot3(p, b->gaze), from = sqrtf(fmaxf(dot3(p, p) - a * a, 0)) - limbus_towards(b, p);
	if (b->even && a > 0 && from < 4 * b->blur + b->ragged) {
		const float angle = atan2f(dot3(p, b->up), dot3(p, b->side)), at[2] = { b->limbus * cosf(angle), b->limbus * sinf(angle) };
		behind_cornea(out->body, b, light, b->limbus, angle, at);
		white(out, b, light, x, y, n, from, ramp(b, x, y, from));
	} else if (!b->even && b->gaze[2] > 0.5F && from < 4 * b->blur) {
		const float dark = 0.35F + 0.65F / (1 + expf(-1.7F * (from - 0.3F * b->blur) / b->blur));
		white(out, b, light, x, y, n, from, 1);
		for (int c = 0; c < 3; c++)
			out->body[c] *= dark;
	} else {
		white(out, b, light, x, y, n, from, 1);
	}
	n[0] += b->wet * (field_at(b->stain, 9 * x, 9 * y) - 0.5F);
	n[1] += b->wet * (field_at(b->stain, 9 * y + 80, 9 * x) - 0.5F);
	const float l = 1 / sqrtf(dot3(n, n));
	for (int c = 0; c < 3; c++)
		n[c] *= l;
	mirror(out->mirror, light, n, b->shine, true);
}

static void circle_seen(float e[5], const struct ball *b, float along, float radius, const float off[2])
{
	e[0] = along * b->gaze[0] + off[0] * b->side[0] + off[1] * b->up[0];
	e[1] = along * b->gaze[1] + off[0] * b->side[1] + off[1] * b->up[1];
	e[2] = radius;
	e[3] = radius * b->gaze[2];
	e[4] = atan2f(b->gaze[1], b->gaze[0]) + 1.57079633F;
}

/* Where the middle of the limbus's ramp is seen, at an angle about the gaze. */
static void outline_at(double p[2], const struct ball *b, double angle)
{
	enum { ROUNDS = 12 };
	const float co = (float)cos(angle), si = (float)sin(angle), limbus = b->limbus / hypotf(co, si / b->aspect);
	float from = 0, x = 0, y = 0;
	for (int i = 0; i < ROUNDS; i++) {
		const float rho = limbus + from, round = rho < b->limbus ? b->cornea : b->radius;
		const float along = (rho < b->limbus ? b->to_cornea : 0) + sqrtf(round * round - rho * rho);
		const float c = rho * co, s = rho * si;
		x = along * b->gaze[0] + c * b->side[0] + s * b->up[0];
		y = along * b->gaze[1] + c * b->side[1] + s * b->up[1];
		from += 0.5F * (-(b->ragged > 0 ? strays(b, x, y) : 0) - from);
	}
	p[0] = x;
	p[1] = y;
}

void ball_limbus(float e[5], const struct ball *b)
{
	enum { PLACES = 120 };
	double p[PLACES][2];
	struct ellipse seen;
	circle_seen(e, b, b->to_limbus, b->limbus, (const float[2]){ 0, 0 });
	if (!(b->ragged > 0) && b->aspect == 1)
		return;
	for (int i = 0; i < PLACES; i++)
		outline_at(p[i], b, 2 * M_PI * i / PLACES);
	if (ellipse_fit_direct(&seen, PLACES, p, 0)) {
		const double q[5] = { seen.cx, seen.cy, seen.a, seen.b, seen.angle };
		for (int i = 0; i < 5; i++)
			e[i] = (float)q[i];
	}
}

void ball_pupil(float e[5], const struct ball *b)
{
	circle_seen(e, b, b->to_limbus - b->depth + 0.55F, 1.13F * b->pupil, b->pupil_at);
}
