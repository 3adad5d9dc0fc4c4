#include "export/outside.h"

#include <math.h>

#include "draw/eye/look.h"
#include "draw/smooth.h"
#include "math/vec.h"

double export_rho(const struct scene *s, double x, double y)
{
	return hypot(x / s->limbus[0], y / s->limbus[1]);
}

void export_front(double at[3], const struct scene *s, double x, double y)
{
	double r2 = x * x + y * y, R = s->conf.sclera_radius, r = sqrt(r2);
	double round = s->sclera_z - sqrt(fmax(R * R - r2, 0)), clear = r < cornea_edge(&s->cornea) ? cornea_depth(&s->cornea, r) : round;
	at[0] = x;
	at[1] = y;
	at[2] = fmin(clear, round);
}

void export_normal(double normal[3], const struct scene *s, const double at[3])
{
	double round[3] = { at[0], at[1], at[2] - s->sclera_z }, front[3] = { at[0], at[1], s->cornea.p * at[2] - s->cornea.R };
	double blend = at[2] < s->sclera_z ? smooth((float)LOOK_SEAM_FROM, (float)LOOK_SEAM_TO, (float)export_rho(s, at[0], at[1])) : 1;
	vec_unit(round, round);
	vec_unit(front, front);
	for (int i = 0; i < 3; i++)
		normal[i] = front[i] + blend * (round[i] - front[i]);
	vec_unit(normal, normal);
}

static double half_width(const struct scene *s)
{
	return 0.5 * s->conf.limbus_width / s->limbus[0];
}

double export_white(const struct scene *s, double rho)
{
	return smooth((float)(1 - half_width(s)), (float)(1 + half_width(s)), (float)rho);
}

double export_seam(const struct scene *s)
{
	return 1 + half_width(s);
}
