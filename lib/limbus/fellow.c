#include "limbus/fellow.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"

/* Tilts on a square grid, x outwards along the line through both eyes, SIDE cells a way; as many aspects as a Gaussian's fifth moments need. */
enum { SIDE = 121, CELLS = SIDE * SIDE, ASPECTS = 3 };
static const double ASPECT_AT[ASPECTS] = { -1.7320508075688772, 0, 1.7320508075688772 }, ASPECT_WEIGHT[ASPECTS] = { 1.0 / 6, 2.0 / 3, 1.0 / 6 };
static const double REACH = 4, WIDEST = 1.3;  // sigmas; rad

struct plane {
	double step;          // rad
	double (*tilt)[2];    // [CELLS], in the picture's axes
};

/* How far from the front the tilt may be. */
static double reach_of(const struct fellow_tilt *t)
{
	const double mean = (t->cov[0][0] + t->cov[1][1]) / 2, largest = mean + hypot((t->cov[0][0] - t->cov[1][1]) / 2, t->cov[0][1]);
	return sqrt(t->seen * t->seen + REACH * (sqrt(largest) + hypot(t->shift[0], t->shift[1])));
}

/* Standard deviation of its length on its own side. */
static double own_sigma(const struct fellow_tilt *t)
{
	const double c = cos(2 * t->towards), s = sin(2 * t->towards);
	return sqrt(c * c * t->cov[0][0] + 2 * c * s * t->cov[0][1] + s * s * t->cov[1][1] + pow(c * t->shift[0] + s * t->shift[1], 2)) / (2 * t->seen);
}

static struct plane plane_new(const struct fellow_tilt *eye, const struct fellow_tilt *other, const double out[2])
{
	struct plane p = { .step = fmin(fmax(reach_of(eye), reach_of(other)), WIDEST) / (SIDE / 2), .tilt = mem_new(CELLS, sizeof *p.tilt) };
	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++) {
			const double x = (i - SIDE / 2) * p.step, y = (j - SIDE / 2) * p.step;
			p.tilt[j * SIDE + i][0] = x * out[0] - y * out[1];
			p.tilt[j * SIDE + i][1] = x * out[1] + y * out[0];
		}
	return p;
}

/* Likelihood of each tilt of one eye under an aspect that is so many sigmas off, times its prior. */
static void likelihood(double *like, const struct plane *p, const struct fellow_tilt *t, double aspect, const struct opening_conf *opening)
{
	const bool opened = opening_known(t->reach, opening);
	const double u = t->seen * t->seen, side[2] = { cos(t->towards), sin(t->towards) };
	const double at[2] = { u * cos(2 * t->towards) + aspect * t->shift[0], u * sin(2 * t->towards) + aspect * t->shift[1] };
	// a cell's own width, so that none is missed
	const double cell = pow(2 * t->seen * p->step, 2) / 12 + pow(p->step, 4) / 12;
	const double xx = t->cov[0][0] + cell, yy = t->cov[1][1] + cell, xy = t->cov[0][1], det = xx * yy - xy * xy;
	for (int i = 0; i < CELLS; i++) {
		const double x = p->tilt[i][0], y = p->tilt[i][1], a = x * x - y * y - at[0], b = 2 * x * y - at[1];
		const double aside = fmax(fmin((x * side[0] + y * side[1]) / t->seen, 1), -1), prior = t->prior > 0 ? (x * x + y * y) / (t->prior * t->prior) : 0;
		like[i] = exp(-0.5 * ((yy * a * a - 2 * xy * a * b + xx * b * b) / det + prior + t->margin * (1 - aside)));
		if (opened)
			like[i] *= opening_likelihood(t->reach, -(x * cos(t->level) + y * sin(t->level)), t->radius, opening);
	}
}

static double sum_of(const double *weight)
{
	double sum = 0;
	for (int i = 0; i < CELLS; i++)
		sum += weight[i];
	return sum;
}

static void kernel_of(double kernel[2 * SIDE - 1], double off, double sigma, double step)
{
	const double wide = hypot(sigma, step / sqrt(12));
	for (int d = 0; d < 2 * SIDE - 1; d++)
		kernel[d] = exp(-0.5 * pow(((d - (SIDE - 1)) * step - off) / wide, 2)) * step / (wide * sqrt(2 * M_PI));
}

/* What the other eye's tilts say of this one's: spread by a Gaussian along each of the grid's axes, about what they differ by. */
static void spread(double *said, double *work, const double *other, const struct plane *p, const double off[2], const double sigma[2])
{
	double along[2 * SIDE - 1], across[2 * SIDE - 1];
	kernel_of(along, off[0], sigma[0], p->step);
	kernel_of(across, off[1], sigma[1], p->step);
	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++) {
			double sum = 0;
			for (int k = 0; k < SIDE; k++)
				sum += other[j * SIDE + k] * along[i - k + SIDE - 1];
			work[j * SIDE + i] = sum;
		}
	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++)
			said[j * SIDE + i] = 0;
	for (int j = 0; j < SIDE; j++)
		for (int k = 0; k < SIDE; k++)
			for (int i = 0; i < SIDE; i++)
				said[j * SIDE + i] += across[j - k + SIDE - 1] * work[k * SIDE + i];
}

/* Mean of the tilts, and root mean square of what they are off it: in length, or along it where that is more. */
static void mean_of(double mean[2], double *sigma, const double *weight, const struct plane *p, const double side[2])
{
	double sum = 0, one[2] = { 0 }, length_off = 0, along_off = 0;
	for (int i = 0; i < CELLS; i++) {
		sum += weight[i];
		one[0] += weight[i] * p->tilt[i][0];
		one[1] += weight[i] * p->tilt[i][1];
	}
	mean[0] = one[0] / sum;
	mean[1] = one[1] / sum;
	const double length = hypot(mean[0], mean[1]);
	const double unit[2] = { length > 1e-6 ? mean[0] / length : side[0], length > 1e-6 ? mean[1] / length : side[1] };
	for (int i = 0; i < CELLS; i++) {
		length_off += weight[i] * pow(hypot(p->tilt[i][0], p->tilt[i][1]) - length, 2);
		along_off += weight[i] * pow(p->tilt[i][0] * unit[0] + p->tilt[i][1] * unit[1] - length, 2);
	}
	*sigma = sqrt(fmax(length_off, along_off) / sum);
}

/* Of each tilt of this eye: by its own picture and by the other's, over all aspects; sums to 1. False: none is possible. */
static bool posterior(double *post, const struct plane *p, const struct fellow_tilt *eye, const struct fellow_tilt *other, const double off[2],
                      const struct fellow_conf *conf, const struct opening_conf *opening)
{
	double *like = mem_new(CELLS, sizeof *like), *theirs = mem_new(CELLS, sizeof *theirs), *said = mem_new(CELLS, sizeof *said), *work = mem_new(CELLS, sizeof *work);
	for (int a = 0; a < ASPECTS; a++) {
		likelihood(like, p, eye, ASPECT_AT[a], opening);
		likelihood(theirs, p, other, ASPECT_AT[a], opening);
		spread(said, work, theirs, p, off, (double[2]){ conf->apart_sigma, conf->level_sigma });
		// an eye that has nothing to do with the other: its tilts are as likely as before
		const double alone = conf->squint * sum_of(theirs) * pow(p->step, 2) / (2 * M_PI * fmax(pow(eye->prior, 2), 1e-4));
		for (int i = 0; i < CELLS; i++)
			post[i] += ASPECT_WEIGHT[a] * like[i] * ((1 - conf->squint) * said[i] + alone);
	}
	const double total = sum_of(post);
	for (int i = 0; i < CELLS && total > 0; i++)
		post[i] /= total;
	free(like);
	free(theirs);
	free(said);
	free(work);
	return total > 0;
}

/* Which share of a tilt's cell lies to a side. */
static double beside(const double tilt[2], const double side[2])
{
	const double to = tilt[0] * side[0] + tilt[1] * side[1];
	return to > 1e-9 ? 1 : to < -1e-9 ? 0 : 0.5;
}

/* What a posterior says; it is left with the likelier side alone. */
static void conclude(struct fellow_said *said, double *post, const struct plane *p, double towards)
{
	double side[2] = { cos(towards), sin(towards) }, mass = 0;
	mean_of(said->all, &said->all_sigma, post, p, side);
	for (int i = 0; i < CELLS; i++)
		mass += post[i] * beside(p->tilt[i], side);
	said->turned = mass < 0.5;
	said->margin = log(fmax(mass, 1 - mass)) - log(fmax(fmin(mass, 1 - mass), 1e-12));
	for (int i = 0; i < 2 && said->turned; i++)
		side[i] = -side[i];
	for (int i = 0; i < CELLS; i++)
		post[i] *= beside(p->tilt[i], side);
	mean_of(said->hill, &said->hill_sigma, post, p, side);
}

bool fellow_tilt_of(struct fellow_said *said, const struct fellow_tilt *eye, const struct fellow_tilt *other, const struct fellow_conf *conf,
                    const struct opening_conf *opening)
{
	double out[2] = { eye->place[0] - other->place[0], eye->place[1] - other->place[1] }, sight[3], sight_other[3];
	const double length = hypot(out[0], out[1]);
	if (!(length > 0) || !(eye->seen > 0) || !(other->seen > 0))
		return false;
	out[0] /= length;
	out[1] /= length;
	vec_unit(sight, eye->place);
	vec_unit(sight_other, other->place);
	// The axes differ by `apart`; the tilts by how differently the camera lies to both eyes less that.
	const double lies[2] = { sight_other[0] - sight[0], sight_other[1] - sight[1] };
	const double off[2] = { lies[0] * out[0] + lies[1] * out[1] - conf->apart, lies[1] * out[0] - lies[0] * out[1] };
	struct plane plane = plane_new(eye, other, out);
	double *post = mem_new(CELLS, sizeof *post);
	const bool any = posterior(post, &plane, eye, other, off, conf, opening);
	if (any)
		conclude(said, post, &plane, eye->towards);
	said->resolved = own_sigma(eye) > plane.step;
	free(post);
	free(plane.tilt);
	return any;
}
