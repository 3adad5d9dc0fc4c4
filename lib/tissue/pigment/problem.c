#include "tissue/pigment/problem.h"

#include <math.h>
#include <string.h>

static const double lowest[PIGMENT_N] = { -11.5, 0, -11.5, 0, -4.6, -3, -0.7, -0.7, 0 };
static const double highest[PIGMENT_N] = { -0.5, 1, -0.5, 1, 1.6, 3, 0.7, 0.7, 0.2 };

enum { COMMON = PIGMENT_N, OFFSETS };

static void unknown(struct pigment_problem *p, int j, double mean, double sigma, double lower, double upper)
{
	p->mean[j] = mean;
	p->sigma[j] = sigma;
	p->lower[j] = lower;
	p->upper[j] = upper;
}

void pigment_problem_make(struct pigment_problem *p, const struct pigment_classes *classes, const struct pigment_conf *c)
{
	*p = (struct pigment_problem){ .classes = classes, .conf = c, .n = PIGMENT_N };
	tissue_bands_make(&p->bands, c->bands, c->illuminant);
	for (int j = 0; j < PIGMENT_N; j++)
		unknown(p, j, c->prior[j][0], c->prior[j][1], lowest[j], highest[j]);
	if (classes->rings) {
		unknown(p, COMMON, 0, c->profile_error, -1, 1);
		for (int r = 0; r < classes->rings; r++) {
			unknown(p, OFFSETS + r, 0, c->ring_error, -1, 1);
			unknown(p, OFFSETS + classes->rings + r, c->prior_spread[0], c->prior_spread[1], -6, 0);
		}
		p->n += 1 + 2 * classes->rings;
		for (int r = 0; r < classes->rings && c->melanin_ring > 0; r++)
			unknown(p, p->n++, 0, c->melanin_ring, -6, 6);
	}
	p->m = 3 * classes->n + p->n;
}

int pigment_problem_rings_at(const struct pigment_problem *p)
{
	return p->classes->rings && p->conf->melanin_ring > 0 ? OFFSETS + 2 * p->classes->rings : -1;
}

double pigment_problem_beyond(const struct pigment_problem *p, const double x[], int r)
{
	return p->classes->rings ? x[COMMON] + x[OFFSETS + r] : 0;
}

double pigment_problem_melanin(const struct pigment_problem *p, const double x[], int r)
{
	int at = pigment_problem_rings_at(p), rings = p->classes->rings;
	double mean = 0;
	if (at < 0)
		return 0;
	for (int i = 0; i < rings; i++)
		mean += x[at + i] / rings;
	return x[at + r] - mean;
}

double pigment_problem_thickness(const struct pigment_problem *p, const double x[], int i)
{
	const struct pigment_class *class = &p->classes->of[i];
	if (!p->classes->rings)
		return class->thickness;
	double spread = exp(x[OFFSETS + p->classes->rings + class->ring]);
	return class->thickness * exp(pigment_problem_beyond(p, x, class->ring) + spread * class->z);
}

/* Relative error of a channel from noise alone; the model's own errors are added where residuals are formed. */
static double noise(const struct pigment_class *class, int k, const struct pigment_conf *c)
{
	double sampling = class->spread[k] / sqrt(class->texels);
	return sqrt(sampling * sampling + c->floor * c->floor) / fmax(class->rgb[k], c->floor);
}

void pigment_class_residuals(double r[3], const struct pigment_class *class, const double rgb[3], const struct pigment_conf *c)
{
	double floor = fmax(c->floor / 4, 1e-6), d[3], s[3];
	for (int k = 0; k < 3; k++) {
		d[k] = log(fmax(rgb[k], floor) / fmax(class->rgb[k], floor));
		s[k] = noise(class, k, c);
	}
	r[0] = d[1] / hypot(c->light_error, s[1]);
	r[1] = (d[0] - d[1]) / hypot(c->model_error, s[0]);
	r[2] = (d[2] - d[1]) / hypot(c->model_error, s[2]);
}

/* Optics of every ring that differs, or of the iris. */
struct all_optics {
	struct tissue_optics of[PIGMENT_RINGS_MAX];
};

/* Reflectance of the tissue alone in every class. optics: of these unknowns. */
static void reflect(double rgb[][3], const struct pigment_problem *p, const struct all_optics *optics, const double *x)
{
	bool one = pigment_problem_rings_at(p) < 0;
	for (int i = 0; i < p->classes->n; i++)
		tissue_reflectance(rgb[i], &optics->of[one ? 0 : p->classes->of[i].ring], pigment_problem_thickness(p, x, i), p->conf->cos_view,
		                   p->conf->cos_light);
}

/* The expensive part, but for layers that the memo knows. */
static void optics_at(struct all_optics *optics, const struct pigment_problem *p, const double *x, struct tissue_memo *memo)
{
	int n = pigment_problem_rings_at(p) < 0 ? 1 : p->classes->rings;
	for (int r = 0; r < n; r++) {
		struct tissue tissue = pigment_tissue_beyond(x, pigment_problem_melanin(p, x, r), p->conf);
		tissue_optics_make_again(&optics->of[r], &tissue, &p->bands, memo);
	}
}

/* Classes, then priors. */
static void compare(double r[], const struct pigment_problem *p, const double *x, double rgb[][3])
{
	for (int i = 0; i < p->classes->n; i++, r += 3) {
		double seen[3];
		pigment_photograph(seen, rgb[i], x);
		pigment_class_residuals(r, &p->classes->of[i], seen, p->conf);
	}
	for (int j = 0; j < p->n; j++)
		*r++ = (x[j] - p->mean[j]) / p->sigma[j];
}

/* Columns of the rings' melanin: a class knows that of its own ring, whose column is that of the whole iris' melanin. */
static void ring_columns(const struct pigment_problem *p, double *J)
{
	int first = pigment_problem_rings_at(p), rings = p->classes->rings, rows = 3 * p->classes->n;
	for (int r = 0; r < rings; r++) {
		for (int i = 0; i < p->m; i++) {
			double own = i < rows ? (p->classes->of[i / 3].ring == r) - 1.0 / rings : 0;
			J[i * p->n + first + r] = i < rows ? own * J[i * p->n + PIGMENT_ABL_MELANIN] : i == rows + first + r ? 1 / p->sigma[first + r] : 0;
		}
	}
}

/* Central differences; the unknowns that are not the tissue's reuse its optics. */
bool pigment_residuals(void *ctx, const double *x, double *r, double *J)
{
	const double h = 1e-5;  // unknowns are of order 1: truncation and rounding are both about 1e-10
	const struct pigment_problem *p = ctx;
	struct all_optics here, there;
	struct tissue_memo memo;
	int rings = pigment_problem_rings_at(p), n = rings < 0 ? p->n : rings;
	double rgb[PIGMENT_CLASSES_MAX][3], side[2][PROBLEM_M_MAX], at[PROBLEM_N_MAX];
	memo.n = 0;
	optics_at(&here, p, x, &memo);
	const int known = memo.n;
	reflect(rgb, p, &here, x);
	compare(r, p, x, rgb);
	memcpy(at, x, (size_t)p->n * sizeof *at);
	for (int j = 0; J && j < n; j++) {
		bool tissue = j <= PIGMENT_SCALE;
		for (int s = 0; s < 2; s++) {
			at[j] = x[j] + (s ? h : -h);
			memo.n = known;
			if (tissue)
				optics_at(&there, p, at, &memo);
			reflect(rgb, p, tissue ? &there : &here, at);
			compare(side[s], p, at, rgb);
		}
		at[j] = x[j];
		for (int i = 0; i < p->m; i++)
			J[i * p->n + j] = (side[1][i] - side[0][i]) / (2 * h);
	}
	if (J && rings >= 0)
		ring_columns(p, J);
	return true;
}
