/* An eye in its portrait: where rays meet it, as a sphere with a spherical cornea, which is as near as shades and what hides what need it. */
#include <math.h>

#include "draw/face/impl.h"
#include "math/vec.h"

static const double rim = 0.95;  // of the limbus: what is seen of the iris further out has the light of there

void portrait_eye_axes(double axes[3][3], const struct portrait *p, int side)
{
	for (int i = 0; i < 3; i++) {
		axes[i][0] = p->target_from_globe[side][i][0];
		axes[i][1] = -p->target_from_globe[side][i][1];
		axes[i][2] = -p->target_from_globe[side][i][2];
	}
}

double portrait_eye_scale(const struct portrait *p, int side)
{
	return p->rig->globe[side].radius / p->eye[side]->conf.sclera_radius;
}

double portrait_eye_cap(const struct scene *s)
{
	const double r = s->limbus[0], z = s->limbus_depth;
	return (r * r + z * z) / (2 * z);
}

/* Nearest root of |o + t d - c| = r that lies on the cap beyond depth `from` along the axis. */
static double ball_hit(const double o[3], const double d[3], double cz, double r, double above)
{
	double q[3] = { o[0], o[1], o[2] - cz }, b = vec_dot(q, d), disc = b * b - vec_dot(q, q) + r * r;
	if (disc < 0)
		return INFINITY;
	double t = -b - sqrt(disc);
	return t > 0 && o[2] + t * d[2] <= above ? t : INFINITY;
}

float portrait_eye_hit(const struct portrait *p, int side, const float origin[3], const float dir[3])
{
	const struct scene *s = p->eye[side];
	double axes[3][3], o[3], d[3], scale = portrait_eye_scale(p, side), from[3], along[3] = { dir[0], dir[1], dir[2] };
	portrait_eye_axes(axes, p, side);
	for (int c = 0; c < 3; c++)
		from[c] = (origin[c] - p->rig->globe[side].center[c]) / scale;
	mat_tvec(o, axes, from);
	mat_tvec(d, axes, along);
	o[2] += s->sclera_z;  // the eye's frame begins at the corneal apex
	double R = portrait_eye_cap(s);
	double t = fmin(ball_hit(o, d, s->sclera_z, s->conf.sclera_radius, INFINITY), ball_hit(o, d, R, R, s->limbus_depth));
	return (float)(t * scale);
}

bool portrait_eye_bend(double in[3], double *cosine, const double d[3], const double n[3], double index)
{
	const double c = vec_dot(d, n);
	*cosine = c;
	for (int i = 0; i < 3; i++)
		in[i] = (d[i] - c * n[i]) / index;
	vec_add(in, in, sqrt(fmax(1 - vec_dot(in, in), 0)), n);
	return c > 0;
}

bool portrait_eye_meet(struct portrait_eye_spot *spot, const struct portrait *p, int side, const float origin[3], const float dir[3])
{
	double axes[3][3], from[3], o[3], d[3], x[3], n[3];
	const struct scene *scene = p->eye[side];
	const double along[3] = { dir[0], dir[1], dir[2] }, *center = p->rig->globe[side].center, scale = portrait_eye_scale(p, side);
	const float t = portrait_eye_hit(p, side, origin, dir);
	if (!isfinite(t))
		return false;
	portrait_eye_axes(axes, p, side);
	for (int c = 0; c < 3; c++) {
		spot->at[c] = origin[c] + t * dir[c];
		from[c] = ((double)spot->at[c] - center[c]) / scale;
	}
	mat_tvec(o, axes, from);
	mat_tvec(d, axes, along);
	o[2] += scene->sclera_z;
	const double wide = scene->conf.limbus_width / scene->limbus[0], rho = hypot(o[0] / scene->limbus[0], o[1] / scene->limbus[1]);
	spot->white = o[2] < scene->sclera_z ? (float)fmin(fmax((rho - 1 + 0.5 * wide) / fmax(wide, 1e-6), 0), 1) : 1;
	if (spot->white < 1) {
		double in[3], cosine, out;
		vec_add(x, o, -1, (double[]){ 0, 0, portrait_eye_cap(scene) });
		vec_unit(n, x);
		portrait_eye_bend(in, &cosine, (double[]){ -d[0], -d[1], -d[2] }, n, scene->eye.index);
		vec_add(spot->within, o, (scene->eye.iris_depth - o[2]) / -in[2], (double[]){ -in[0], -in[1], -in[2] });
		out = hypot(spot->within[0] / scene->limbus[0], spot->within[1] / scene->limbus[1]) / rim;
		for (int c = 0; c < 2; c++)
			spot->within[c] /= fmax(out, 1);
	}
	if (spot->white > 0.5f) {
		vec_add(x, o, -1, (double[]){ 0, 0, scene->sclera_z });
		vec_unit(n, x);
	}
	mat_vec(n, axes, n);
	for (int c = 0; c < 3; c++)
		spot->normal[c] = (float)n[c];
	return true;
}

