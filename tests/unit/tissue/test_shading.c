/* Shading of relief: its linear model and the relief that is inferred by it, against photons of another phase function. */
#include "math/rng.h"
#include "tissue/light/iris_light.h"
#include "tissue/relief/bell.h"
#include "tissue/relief/infer.h"
#include "tissue/relief/shading.h"
#include "tests/lib/truth/photon.h"
#include "base/mem.h"
#include "tests/lib/unit.h"

enum { N = 80, ALL = N * N, TISSUES = 4 };
static const double cell = 0.04, extent = N * 0.04 / 2, middle = 0.45, cos_light = 0.85;
/* Melanin of both layers, thickness scale: none of the shared irises'. */
static const double tissues[TISSUES][3] = { { 0.002, 0.002, 0.3 }, { 0.03, 0.008, 0.4 }, { 0.15, 0.03, 0.6 }, { 0.3, 0.1, 0.6 } };
static const char *const names[TISSUES] = { "blue", "green", "brown", "dark" };
static const struct pigment_conf pigment = { .abl_thickness = 0.04, .cos_light = 0.85, .cos_view = 1, .bands = 4, .multiple = true };

static void unknowns(double x[PIGMENT_N], int t)
{
	const double at[PIGMENT_N] = { log(tissues[t][0]), 0.6, log(tissues[t][1]), 0.6, log(tissues[t][2]) };
	memcpy(x, at, sizeof at);
}

/* Random relief, ln thickness about none: octaves from 0.1 mm on, of 0.05 each, and crypts. Periodic enough: its edges are left out. */
static void relief(float *d, uint64_t seed)
{
	struct rng rng = { seed };
	float *part = mem_array(ALL, sizeof *part), *scratch = mem_array(ALL, sizeof *scratch);
	memset(d, 0, ALL * sizeof *d);
	for (int b = 0; b < 3; b++) {
		double sigma = 0.1 * (1 << b) / cell;
		for (int i = 0; i < ALL; i++)
			part[i] = (float)(rng_normal(&rng) * 0.05 * 2 * sqrt(M_PI) * sigma);
		bell_blur(part, N, sigma, 2, scratch);
		for (int i = 0; i < ALL; i++)
			d[i] += part[i];
	}
	for (int k = 0; k < 6; k++) {
		double x = N * rng_uniform(&rng), y = N * rng_uniform(&rng), r = rng_range(&rng, 0.1, 0.2) / cell;
		for (int i = 0; i < ALL; i++)
			d[i] -= (float)(0.4 * exp(-pow((i % N - x) / r, 2) - pow((i / N - y) / r, 2)));
	}
	free(part);
	free(scratch);
}

/* What photons show of stroma middle * exp(d) at 550 nm, light from +x. */
static void photograph(float *light, const float *d, int t, long photons, uint64_t seed)
{
	const double nm = 550, g = 0.8, s = tissue_scattering(nm), scale = tissues[t][2];
	const struct tissue_layer layer[2] = { { tissues[t][0], 0.6 }, { tissues[t][1], 0.6 } };
	float *stroma = mem_array(ALL, sizeof *stroma);
	for (int i = 0; i < ALL; i++)
		stroma[i] = (float)(middle * exp((double)d[i]));
	const struct photon_slab slab = { N, cell, stroma, 0.04, { s / (1 - g), scale * s / (1 - g) },
		{ tissue_absorption(&layer[0], nm), scale * tissue_absorption(&layer[1], nm) }, g, true };
	photon_reflectance(light, &slab, cos_light, photons, 0, seed);
	free(stroma);
}

static struct shading shading_of(int t, double slant)
{
	double x[PIGMENT_N];
	unknowns(x, t);
	struct tissue tissue = pigment_tissue(x, &pigment);
	struct tissue_bands bands;
	struct tissue_optics optics;
	struct shading s;
	tissue_bands_make(&bands, pigment.bands, pigment.illuminant);
	tissue_optics_make(&optics, &tissue, &bands);
	shading_make(&s, N, 1 / cell, &tissue, &optics, middle, 1, cos_light);
	double thin[3], thick[3], mean[2] = { slant, 0 }, none[3] = { 0 };
	tissue_reflectance(thin, &optics, middle / 1.02, 1, cos_light);
	tissue_reflectance(thick, &optics, middle * 1.02, 1, cos_light);
	for (int i = 0; i < ALL; i++) {
		s.alpha[i] = (float)(log(thick[1] / thin[1]) / (2 * log(1.02)));
		s.thick[i] = (float)middle;
		shading_slants(s.slant[i], s.scale, mean, none);
	}
	return s;
}

/* Between Gaussians of 0.1 and 0.4 mm, 0.4 mm from the borders: share of b in a (regression), and their correlation. */
static double relate(double *correlation, const float *a, const float *b)
{
	const int edge = (int)(0.4 / cell);
	float *band[2], *wide = mem_array(ALL, sizeof *wide), *scratch = mem_array(ALL, sizeof *scratch);
	double aa = 0, bb = 0, ab = 0;
	for (int k = 0; k < 2; k++) {
		band[k] = mem_array(ALL, sizeof **band);
		memcpy(band[k], k ? b : a, ALL * sizeof **band);
		memcpy(wide, band[k], ALL * sizeof *wide);
		bell_blur(band[k], N, 0.1 / cell, 2, scratch);
		bell_blur(wide, N, 0.4 / cell, 2, scratch);
		for (int i = 0; i < ALL; i++)
			band[k][i] -= wide[i];
	}
	for (int i = 0; i < ALL; i++)
		if (i % N >= edge && i % N < N - edge && i / N >= edge && i / N < N - edge) {
			aa += (double)band[0][i] * (double)band[0][i];
			bb += (double)band[1][i] * (double)band[1][i];
			ab += (double)band[0][i] * (double)band[1][i];
		}
	for (int k = 0; k < 2; k++)
		free(band[k]);
	free(wide);
	free(scratch);
	*correlation = ab / sqrt(aa * bb);
	return ab / bb;
}

/* <A x, y> = <x, A^T y>, to float's rounding; the bell keeps a constant and has the variance that is asked for. */
static void test_transposed(void **state)
{
	struct shading s = shading_of(1, 0.7);
	struct rng rng = { 5 };
	static float x[ALL], y[ALL], ax[ALL], ay[ALL];
	double one = 0, two = 0, size = 0;
	(void)state;
	for (int i = 0; i < ALL; i++) {
		double mean[2] = { 0.4 + 0.002 * (i % N), 0.3 }, spread[3] = { 0.1, 0.03, 0.05 };
		x[i] = (float)rng_normal(&rng);
		y[i] = (float)rng_normal(&rng);
		s.alpha[i] = (float)(0.3 + 0.004 * (i / N));
		shading_slants(s.slant[i], s.scale, mean, spread);
	}
	shading_apply(ax, x, &s);
	shading_transposed(ay, y, &s);
	for (int i = 0; i < ALL; i++) {
		one += (double)ax[i] * (double)y[i];
		two += (double)x[i] * (double)ay[i];
		size += (double)fabsf(ax[i] * y[i]);
	}
	print_message("%.6f, transposed %.6f, of %.1f\n", one, two, size);
	assert_true(fabs(one - two) < 1e-6 * size);
	shading_free(&s);
	for (double sigma = 0.7; sigma < 12; sigma *= 1.7) {
		double sum = 0, square = 0;
		memset(x, 0, sizeof x);
		x[N / 2 * N + N / 2] = 1;
		bell_blur(x, N, sigma, 2, y);
		for (int i = 0; i < ALL; i++) {
			sum += (double)x[i];
			square += (double)x[i] * pow(i % N - N / 2, 2);
		}
		assert_true(fabs(sum - 1) < 1e-4 && fabs(sqrt(square) - sigma) < 0.01 * sigma);
	}
}

/* Slants of that mean and covariance. */
static void test_slants(void **state)
{
	const double mean[2] = { 0.5, -0.2 }, covariance[3] = { 0.2, 0.05, 0.1 };
	float s[SHADING_SLANTS][2];
	double m[2] = { 0 }, c[3] = { 0 };
	(void)state;
	shading_slants(s, 10, mean, covariance);
	for (int k = 0; k < SHADING_SLANTS; k++)
		for (int i = 0; i < 2; i++)
			m[i] += (double)s[k][i] / 10 / SHADING_SLANTS;
	for (int k = 0; k < SHADING_SLANTS; k++) {
		double u = (double)s[k][0] / 10 - m[0], v = (double)s[k][1] / 10 - m[1];
		c[0] += u * u / SHADING_SLANTS;
		c[1] += u * v / SHADING_SLANTS;
		c[2] += v * v / SHADING_SLANTS;
	}
	for (int i = 0; i < 3; i++)
		assert_true(fabs(c[i] - covariance[i]) < 1e-5 && (i > 1 || fabs(m[i] - mean[i]) < 1e-6));
}

/* Photons' pictures of one relief, under one light. */
static float truth[ALL], photo[TISSUES][ALL];

static int photographs(void **state)
{
	(void)state;
	relief(truth, 11);
#pragma omp parallel for schedule(dynamic)
	for (int t = 0; t < TISSUES; t += SANITISED ? 2 : 1)
		photograph(photo[t], truth, t, 3000000, 3);
	return 0;
}

/* The model's shading against photons, 5 % of noise a cell: of what photons show it explains more where it knows from where light comes. */
static void test_response(void **state)
{
	static float light[ALL], told[ALL], even[ALL];
	(void)state;
	for (int t = 0; t < TISSUES; t += SANITISED ? 2 : 1) {
		struct shading s = shading_of(t, sqrt(1 - cos_light * cos_light) / cos_light), flat = shading_of(t, 0);
		double mean = 0, like, like_even;
		for (int i = 0; i < ALL; i++)
			mean += (double)photo[t][i] / ALL;
		for (int i = 0; i < ALL; i++)
			light[i] = logf(fmaxf(photo[t][i] / (float)mean, 0.05f));
		shading_apply(told, truth, &s);
		shading_apply(even, truth, &flat);
		double share = relate(&like, light, told), share_even = relate(&like_even, light, even);
		print_message("%s: photons show %.2f of the shading, correlation %.3f; light from above %.2f, %.3f\n", names[t], share, like, share_even, like_even);
		assert_true(share > 0.75 && share < 1.35);
		assert_true(like > 0.8 && like > like_even + 0.02);
		shading_free(&s);
		shading_free(&flat);
	}
}

/* A texture of one picture, with no course; the light on it. */
static void captured(struct image *clean, struct image *thickness, struct image *lit, const float *light)
{
	*clean = image_new(N, N, 4);
	*thickness = image_new(N, N, 1);
	*lit = image_new(8, 8, IRIS_LIT);
	for (int i = 0; i < ALL; i++) {
		for (int c = 0; c < 3; c++)
			clean->px[4 * i + c] = fmaxf(light[i], 1e-4f);
		clean->px[4 * i + 3] = 1;
		thickness->px[i] = (float)middle;
	}
	for (int i = 0; i < 64; i++) {
		const float at[IRIS_LIT] = { 1, 1, 1, (float)cos_light, (float)(sqrt(1 - cos_light * cos_light) / cos_light) };
		memcpy(lit->px + IRIS_LIT * i, at, sizeof at);
	}
}

static const double white[3] = { 1, 1, 1 };
static const struct relief_conf conf = { .relief_sigma = 0.1, .low = 0.1, .high = 1 };
static const struct infer_conf how = { .finest = 0.05, .most = 0.2, .response_error = 0.35, .light_error = 0.006, .edge = 0.5 };
static const struct pupil point = { 0, 0, 0.001 };

/* Infers; got: ln thickness about the middle; off: its error in sigmas, less what is wider than the octaves, which the sigma is not of. */
static void infer(float *got, float *off, struct infer_fit *fit, const float *light, int t)
{
	struct image clean, thickness, lit, out;
	struct err err = { 0 };
	double x[PIGMENT_N];
	unknowns(x, t);
	captured(&clean, &thickness, &lit, light);
	assert_true(relief_infer(&out, fit, &clean, &thickness, &lit, extent, &point, 6, white, x, &pigment, &conf, &how, &err));
	float *wide = mem_array(ALL, sizeof *wide), *scratch = mem_array(ALL, sizeof *scratch);
	for (int i = 0; i < ALL; i++) {
		got[i] = logf(out.px[2 * i] / (float)middle);
		wide[i] = got[i] - truth[i];
	}
	bell_blur(wide, N, 0.8 / cell, 2, scratch);
	for (int i = 0; i < ALL; i++)
		off[i] = (got[i] - truth[i] - wide[i]) / (out.px[2 * i + 1] / out.px[2 * i]);
	free(wide);
	free(scratch);
	image_free(&out);
	image_free(&clean);
	image_free(&thickness);
	image_free(&lit);
}

/* Relief from photons' pictures: its place, its amplitude, and its own sigma. */
static void test_inferred(void **state)
{
	static float got[ALL], off[ALL];
	(void)state;
	for (int t = 0; t < TISSUES; t += SANITISED ? 2 : 1) {
		struct infer_fit fit;
		double like, one = 0, in = 0;
		infer(got, off, &fit, photo[t], t);
		double share = relate(&like, got, truth);
		for (int i = 0; i < ALL; i++)
			if (i % N >= 10 && i % N < N - 10 && i / N >= 10 && i / N < N - 10) {
				one += fabs((double)off[i]) < 1;
				in++;
			}
		print_message("%s: correlation %.3f, regression %.2f, within a sigma %.2f; noise %.3f, octaves %.3f %.3f %.3f %.3f\n", names[t], like, share, one / in,
		              fit.noise, fit.rms[0], fit.rms[1], fit.rms[2], fit.rms[3]);
		assert_true(like > 0.8);
		assert_true(share > 0.6 && share < 1.3);
		assert_true(one / in > 0.5 && one / in < 0.9);
	}
}

/* Where all contrast is noise there is no relief. */
static void test_none(void **state)
{
	static float noise[ALL], got[ALL], off[ALL];
	struct rng rng = { 9 };
	struct infer_fit fit;
	double square = 0;
	(void)state;
	for (int i = 0; i < ALL; i++)
		noise[i] = (float)(0.2 * exp(0.15 * rng_normal(&rng)));
	infer(got, off, &fit, noise, 1);
	for (int i = 0; i < ALL; i++)
		square += (double)got[i] * (double)got[i] / ALL;
	print_message("noise alone of %.3f: relief of %.4f\n", fit.noise, sqrt(square));
	assert_true(fabs(fit.noise - 0.15 * cell / (1.25 * how.finest)) < 0.02 && sqrt(square) < 0.02);  // a texel of the fit is several cells
}

static void test_refused(void **state)
{
	struct image clean, thickness, lit, out = { 0 };
	struct infer_fit fit;
	struct err err = { 0 };
	double x[PIGMENT_N];
	(void)state;
	unknowns(x, 0);
	captured(&clean, &thickness, &lit, photo[0]);
	for (int i = 0; i < ALL; i++)
		clean.px[4 * i + 3] = 0;
	assert_false(relief_infer(&out, &fit, &clean, &thickness, &lit, extent, &point, 6, white, x, &pigment, &conf, &how, &err));
	ERR_HAS(err, "too few");
	image_free(&clean);
	image_free(&thickness);
	image_free(&lit);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_transposed), cmocka_unit_test(test_slants), cmocka_unit_test(test_response), cmocka_unit_test(test_inferred),
		cmocka_unit_test(test_none), cmocka_unit_test(test_refused),
	};
	return cmocka_run_group_tests(tests, photographs, 0);
}
