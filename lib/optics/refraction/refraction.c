#include "optics/refraction/refraction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/simd.h"
#include "optics/lightpath/path.h"
#include "optics/refraction/poly.h"
#include "optics/refraction/table.h"

const char *const refraction_methods[] = { "auto", "newton", "polynomial", "table_linear", "table_nearest", 0 };
_Static_assert(COUNT(refraction_methods) == REFRACTION_METHODS + 1, "a name for each method");

enum { BLOCK = 512, PROBE = 20000 };

void refraction_free(struct refraction *f)
{
	free(f->data);
	*f = (struct refraction){ 0 };
}

long refraction_bytes(const struct refraction *f)
{
	return f->method == REFRACTION_NEWTON ? 0 : f->n_data * (f->method == REFRACTION_POLYNOMIAL ? 2 : 3) * sizeof(float);
}

static bool is_table(const struct refraction *f)
{
	return f->method == REFRACTION_TABLE_LINEAR || f->method == REFRACTION_TABLE_NEAREST;
}

/* Whether the polynomial or the table covers all of these problems: P inside the edge, w_z at most `most`. */
SIMD_CLONES static bool all_within(int n, const float *px, const float *py, const float *wz, float edge2, float most)
{
	int out = 0;
#pragma omp simd reduction(| : out)
	for (int i = 0; i < n; i++)
		out |= !(px[i] * px[i] + py[i] * py[i] <= edge2) | !(wz[i] <= most);
	return !out;
}

static bool covered(const struct refraction *f, int n, const float *px, const float *py, const float *wz)
{
	float edge = 1.02f * (float)f->radius;
	return all_within(n, px, py, wz, edge * edge, is_table(f) ? 0 : REFRACTION_BEHIND);
}

static void judge(const struct refraction *f, int n, const float *wx, const float *wy, const float *wz, const float *kx,
                  const float *ky, const float *kz, unsigned char *status)
{
	float rim2 = f->cornea.rim * f->cornea.rim, R = f->cornea.R, p = f->cornea.p;
	for (int i = 0; i < n; i++) {
		float cos_i = wx[i] * kx[i] + wy[i] * ky[i] + wz[i] * (p * kz[i] - R);
		status[i] = cos_i < 0                                     ? LIGHTPATH_GRAZING
		            : kx[i] * kx[i] + ky[i] * ky[i] > rim2 ? LIGHTPATH_BEYOND_RIM
		                                                   : LIGHTPATH_OK;
	}
}

/* Evaluates at most BLOCK problems. */
static struct lightpath_again evaluate(const struct refraction *f, int n, const float *px, const float *py, const float *pz,
                     const float *wx, const float *wy, const float *wz, float *kx, float *ky, float *kz,
                     unsigned char *status)
{
	float qx[BLOCK], qy[BLOCK], qz[BLOCK];
	bool good = f->method != REFRACTION_NEWTON && covered(f, n, px, py, wz);
	if (good && is_table(f)) {
		refraction_look_up(f, n, px, py, wx, wy, wz, kx, ky, kz);
		judge(f, n, wx, wy, wz, kx, ky, kz, status);
		return (struct lightpath_again){ 0 };
	}
	if (good)
		refraction_start(f, n, px, py, wx, wy, wz, qx, qy, qz);
	// From the closed-form start a block needs three steps.
	int steps = good || f->method == REFRACTION_NEWTON ? f->steps : 3;
	return lightpath_batch_from(n, good ? qx : 0, good ? qy : 0, good ? qz : 0, px, py, pz, wx, wy, wz, kx, ky, kz, status,
	                            &f->cornea, steps, f->error_mm);
}

void refraction_batch(const struct refraction *f, int n, const float *px, const float *py, const float *pz,
                      const float *wx, const float *wy, const float *wz, float *kx, float *ky, float *kz, float *gain,
                      unsigned char *status)
{
	unsigned char own[BLOCK];
	for (int i = 0; i < n; i += BLOCK) {
		int m = n - i < BLOCK ? n - i : BLOCK;
		unsigned char *of = status ? status + i : own;
		evaluate(f, m, px + i, py + i, pz + i, wx + i, wy + i, wz + i, kx + i, ky + i, kz + i, of);
		if (!gain)
			continue;
		lightpath_gain_batch(m, px + i, py + i, pz + i, wx + i, wy + i, wz + i, kx + i, ky + i, kz + i, gain + i,
		                     &f->cornea);
		for (int j = 0; j < m; j++)
			gain[i + j] = of[j] == LIGHTPATH_OK ? gain[i + j] : 0;
	}
}

/* Points of the iris and directions of the hemisphere, spread by a low-discrepancy sequence, and the K that the solver in double
 * finds. */
struct probe {
	float px[PROBE], py[PROBE], pz[PROBE], wx[PROBE], wy[PROBE], wz[PROBE], kx[PROBE], ky[PROBE], kz[PROBE];
	double K[PROBE][3];
	unsigned char status[PROBE], truth[PROBE];
};

static struct probe *probe_new(const struct cornea *cornea, double depth, double radius)
{
	struct probe *probe = mem_new(1, sizeof *probe);
	for (int i = 0; i < PROBE; i++) {
		// The R4 sequence: steps of the generalised golden ratio in four dimensions (Roberts 2018).
		double u[4], g = 1.1673039782614187;
		for (int k = 0; k < 4; k++)
			u[k] = fmod(0.5 + (i + 1) * pow(g, -k - 1), 1);
		double r = radius * sqrt(u[0]), a = 2 * M_PI * u[1], z = -u[2], q = sqrt(1 - z * z), b = 2 * M_PI * u[3];
		probe->px[i] = r * cos(a);
		probe->py[i] = r * sin(a);
		probe->pz[i] = depth;
		probe->wx[i] = q * cos(b);
		probe->wy[i] = q * sin(b);
		probe->wz[i] = z;
	}
#pragma omp parallel for
	for (int i = 0; i < PROBE; i++) {
		double P[3] = { probe->px[i], probe->py[i], probe->pz[i] };
		double w[3] = { probe->wx[i], probe->wy[i], probe->wz[i] };
		probe->truth[i] = path_shortest(probe->K[i], &(struct path){ cornea, P, 0, w });
	}
	return probe;
}

/* Measures f->worst_mm and f->mean_mm on the probe. Returns how many of its evaluations took more steps, or double precision. */
static struct lightpath_again measure(struct refraction *f, struct probe *p)
{
	struct lightpath_again again = { 0 };
	long n = 0;
	double sum = 0, worst = 0;
	for (int i = 0; i < PROBE; i += BLOCK) {
		int m = PROBE - i < BLOCK ? PROBE - i : BLOCK;
		struct lightpath_again more = evaluate(f, m, p->px + i, p->py + i, p->pz + i, p->wx + i, p->wy + i, p->wz + i, p->kx + i,
		                                       p->ky + i, p->kz + i, p->status + i);
		again.longer += more.longer;
		again.in_double += more.in_double;
	}
	for (int i = 0; i < PROBE; i++) {
		if (p->truth[i] != LIGHTPATH_OK)
			continue;
		double e = hypot(hypot(p->kx[i] - p->K[i][0], p->ky[i] - p->K[i][1]), p->kz[i] - p->K[i][2]);
		sum += e;
		worst = fmax(worst, e);
		n++;
	}
	f->worst_mm = worst;
	f->mean_mm = n ? sum / n : 0;
	return again;
}

/* Nanoseconds of one evaluation. The figures were measured with AVX2 (bench_refraction) and are fixed, so that the choice is the
 * same on every machine. Most problems that need double precision end in the scalar solver. */
static double cost(const struct refraction *f, struct lightpath_again again)
{
	double start = f->method == REFRACTION_POLYNOMIAL ? 2.5 + 0.06 * refraction_monomials(f->degree) : 3.4;
	return start + 2.25 * f->steps + (15.0 * (double)again.longer + 1000.0 * (double)again.in_double) / PROBE;
}

/* Chooses the cheapest start and number of steps within the tolerance, among those of the method. */
static void choose(struct refraction *f, struct probe *probe, int method)
{
	struct refraction best = { 0 };
	double least = INFINITY;
	for (int degree = 0; degree <= REFRACTION_MAX_DEGREE; degree++) {
		f->method = degree ? REFRACTION_POLYNOMIAL : REFRACTION_NEWTON;
		f->degree = degree;
		if (method != REFRACTION_AUTO && method != f->method)
			continue;
		if (degree && !refraction_fit(f))
			continue;
		for (f->steps = degree ? 0 : 1; f->steps <= 5; f->steps++) {
			double price = cost(f, measure(f, probe));
			// 2e-5 mm is the precision of float.
			if (f->worst_mm <= fmax(f->error_mm, 2e-5) && price < least) {
				least = price;
				free(best.data);
				best = *f;
				best.data = mem_new(f->n_data + 1, sizeof *f->data);
				if (f->n_data)
					memcpy(best.data, f->data, f->n_data * sizeof *f->data);
			}
		}
	}
	free(f->data);
	if (!best.steps && !best.degree) {
		// Nothing is within the tolerance on this cornea: the closed-form start with steps to spare.
		best = *f;
		best.method = REFRACTION_NEWTON;
		best.steps = 6;
		best.degree = 0;
		best.data = 0;
		measure(&best, probe);
	}
	*f = best;
	if (f->method == REFRACTION_NEWTON)
		f->n_data = 0;
}

void refraction_make(struct refraction *f, const struct cornea *cornea, const struct refraction_conf *conf)
{
	*f = (struct refraction){ .cornea = *cornea, .depth = conf->depth, .radius = conf->radius, .error_mm = conf->error_mm,
		                  .method = conf->method, .points = conf->points };
	f->cornea.two_surface = false;
	struct probe *probe = probe_new(&f->cornea, f->depth, f->radius);
	if (is_table(f)) {
		f->thetas = f->phis = lround(sqrt(conf->directions));
		refraction_tabulate(f);
		measure(f, probe);
	} else {
		choose(f, probe, conf->method);
	}
	free(probe);
}
