/* The light's colour by the sclera; and how what covers of an iris hide is filled, against painted irises whose truth lies under the covers, in the filled
 * region alone. How well covers are found: bench_occluded.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_inpaint.h"
#include "draw/eye/fill.h"
#include "image/colour.h"
#include "image/plane.h"
#include "limbus/evidence.h"
#include "math/rng.h"
#include "tests/evidence/light.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/iris.h"
#include "tissue/light/pale.h"

static const struct bench_time untimed = { NAN, NAN, NAN };

/* ---- white --------------------------------------------------------------------------------------------------------- */
static const float kelvins[] = { 2800, 3500, 5000, 8000 };
enum { KELVINS = 4, WHITES = 3, LIDDED_MOST = 8, BY_EVIDENCE = 1 };

/* Angle between two colours, degrees: of the light, whatever its strength. */
static double colour_angle(const double a[3], const float b[3])
{
	double ab = 0, aa = 0, bb = 0;
	for (int c = 0; c < 3; c++) {
		ab += a[c] * b[c];
		aa += a[c] * a[c];
		bb += b[c] * b[c];
	}
	return acos(fmin(1, ab / sqrt(aa * bb))) * 180 / M_PI;
}

/* The photograph as the same camera takes it in light of another colour, its balance kept. Truth: a white surface is that colour then. */
static void relight(struct photo *photo, const float light[3])
{
	float most = fmaxf(light[0], fmaxf(light[1], light[2]));
	for (long i = 0; i < 3L * photo->width * photo->height; i++) {
		float v = linear_from_srgb((float)photo->rgb[i] / 65535) * light[i % 3] / most;
		photo->rgb[i] = (uint16_t)(255 * srgb_from_linear(v) + 0.5f) * 257;
	}
}

/* By the palest that lies beside the iris; white where there is too little of it. */
static void palest_of(double rgb[3], const struct photo *photo, const struct fit *fit, const struct eye *eye, const struct pale_conf *conf,
                      const double sclera[3])
{
	static struct pale sample[PALE_MAX];
	int n = pale_find(sample, photo, fit, eye, 0, conf);
	for (int c = 0; c < 3; c++) {
		rgb[c] = n ? 0 : 1;
		for (int i = 0; i < n; i++)
			rgb[c] += sample[i].rgb[c] / sclera[c] / n;
	}
}

static bool white_errors(double angle[WHITES], struct evidence_net *net, const struct truth *truth, const float light[3])
{
	const struct balance_conf conf = iris_balance_conf();
	const struct pale_conf pale = { .inner = 1.1, .outer = 1.5, .redness = 0.2, .reddest = 0.45, .dark = 0.3, .sure = 0.6 };  // as config/pigment.conf
	struct photo photo;
	struct evidence evidence = { 0 };
	struct fit fit = truth_fit(truth);
	struct err err = { 0 };
	if (!photo_load(&photo, truth->photo, 100, &err))
		return false;
	relight(&photo, light);
	bool ok = evidence_window(&evidence, net, &photo, fit.limbus.cx, fit.limbus.cy, fit.limbus.a, &err);
	if (ok) {
		struct balance white = balance_sclera(&photo, &fit, &evidence, &conf);
		double palest[3];
		palest_of(palest, &photo, &fit, &truth->eye, &pale, conf.sclera);
		angle[0] = colour_angle(palest, light);
		angle[BY_EVIDENCE] = colour_angle(white.rgb, light);
		angle[2] = colour_angle(balance_none().rgb, light);
	}
	evidence_free(&evidence);
	photo_free(&photo);
	return ok;
}

/* Rendered captures with lids: their light is white. */
static void whites(struct evidence_net *net)
{
	static const char *const methods[WHITES] = { "palest beside the iris", "sclera by evidence", "none (the camera's)" };
	double angle[KELVINS][LIDDED_MOST][WHITES], worst = 0;
	char *dirs[32];
	int n = truth_captures(dirs, 32), m = 0;
	for (int i = 0; i < n; i++) {
		struct truth truth;
		struct err err = { 0 };
		bool ok = m < LIDDED_MOST && truth_load(&truth, dirs[i], &err) && truth.covered > 0;
		for (int k = 0; k < KELVINS && ok; k++) {
			float light[3];
			light_colour(light, kelvins[k]);
			ok = white_errors(angle[k][m], net, &truth, light);
		}
		m += ok;
		free(dirs[i]);
	}
	for (int k = 0; k < KELVINS && m; k++)
		for (int method = 0; method < WHITES; method++) {
			double mean_angle = 0;
			char setting[64];
			for (int i = 0; i < m; i++)
				mean_angle += angle[k][i][method] / m;
			snprintf(setting, sizeof setting, "captures with lids, in light of %.0f K", kelvins[k]);
			bench_row("white", methods[method], setting, untimed, "photograph", mean_angle, "deg", "angle to the light's colour, mean");
			if (method == BY_EVIDENCE)
				worst = fmax(worst, mean_angle);
		}
	if (m)
		bench_goal("white by evidence, 2800 to 8000 K, worst mean", "<= 3 deg", worst, "deg", worst <= 3);
}

/* ---- filling ------------------------------------------------------------------------------------------------------- */
enum { METHODS = 4, COVERS = 3 };
static const char *const method_names[METHODS] = { "strips of the iris", "mirrored rings", "Telea (OpenCV)", "Navier-Stokes (OpenCV)" };
static const char *const cover_names[COVERS] = { "lids", "lashes", "a window's reflection" };

struct fill {
	struct image original, work;
	uint8_t *hidden, *rgb8, *work8;
	double extent;
	struct truth truth;
	int method;
};

static void run_fill(void *ctx)
{
	struct fill *f = ctx;
	int size = f->original.width;
	long n = (long)size * size;
	struct err err = { 0 };
	struct eye eye = f->truth.eye;
	double pupil[3] = { 0, 0, f->truth.pupil_radius };
	for (long i = 0; i < n; i++)
		for (int c = 0; c < 4; c++)
			f->work.px[4 * i + c] = f->hidden[i] ? 0 : f->original.px[4 * i + c];
	eye.limbus_radius = f->truth.iris_radius;
	if (f->method == 0) {
		struct unrefract_texture texture = { .rgbw = f->work, .extent = f->extent, .pupil = { 0, 0, f->truth.pupil_radius } };
		unrefract_fill(&texture, &eye);
	} else if (f->method == 1) {
		scene_fill(f->work.px, size, f->extent, pupil);
	} else {
		memcpy(f->work8, f->rgb8, (size_t)n * 3);
		cv_inpaint(f->work8, f->hidden, size, size, 5, f->method == 2 ? CV_INPAINT_TELEA : CV_INPAINT_NAVIER_STOKES, &err);
		for (long i = 0; i < n; i++)
			for (int c = 0; c < 3 && f->hidden[i]; c++)
				f->work.px[4 * i + c] = linear_from_srgb(f->work8[3 * i + c] / 255.0f);
	}
}

/* Two lids' edges; strokes of 0.1 mm that hang into the iris; a window with a cross, 2.4 x 2 mm. Only the iris is hidden. */
static void cover(struct fill *f, int which)
{
	int size = f->original.width;
	double mm = 2 * f->extent / size, R = f->truth.iris_radius;
	for (int row = 0; row < size; row++)
		for (int col = 0; col < size; col++) {
			double x = (col + 0.5) * mm - f->extent, y = (row + 0.5) * mm - f->extent;
			bool in = false;
			for (int k = 0; k < 24 && which == 1; k++) {
				double from = R * (-0.95 + 1.9 * k / 23), bend = 0.15 * sin(5.0 * k), length = R * (0.45 + 0.25 * sin(3.0 * k)), down = y + R;
				in |= down > 0 && down < length && fabs(x - from - bend * down * down / R) < 0.05 + 0.05 * (1 - down / length);
			}
			in |= which == 0 && (y < -0.42 * R + 0.2 * x * x / R || y > 0.72 * R - 0.1 * x * x / R);
			in |= which == 2 && fabs(x + 1.2) < 1.2 && fabs(y + 2.6) < 1 && fabs(x + 1.2) > 0.08 && fabs(y + 2.6) > 0.08;
			f->hidden[(long)row * size + col] = in && f->original.px[4 * ((long)row * size + col) + 3] > 0;
		}
}

static double log_green(const struct image *image, long i)
{
	return log(fmax(image->px[4 * i + 1], 1e-4));
}

struct quality {
	double colour;    // CIEDE2000 of what is left after a blur of 0.3 mm
	double contrast;  // |log| of fine contrast over the true
	double seam;      // mean step over the edge of the filled region, against the true steps there
};

static double smooth_difference(const struct fill *f)
{
	int size = f->original.width;
	size_t n = (size_t)size * (size_t)size;
	float *plane[2][3], *weight = mem_array(n, sizeof *weight);
	double sum = 0;
	long count = 0;
	for (size_t i = 0; i < n; i++)
		weight[i] = f->original.px[4 * i + 3] > 0;
	for (int k = 0; k < 2; k++)
		for (int c = 0; c < 3; c++) {
			plane[k][c] = mem_array(n, sizeof(float));
			for (size_t i = 0; i < n; i++)
				plane[k][c][i] = (k ? &f->work : &f->original)->px[4 * i + (size_t)c];
			plane_blur_weighted(plane[k][c], weight, size, size, 0.3 * size / (2 * f->extent), 0);
		}
	for (size_t i = 0; i < n; i += 7)
		if (f->hidden[i]) {
			float a[3] = { plane[0][0][i], plane[0][1][i], plane[0][2][i] }, b[3] = { plane[1][0][i], plane[1][1][i], plane[1][2][i] };
			sum += colour_difference(a, b);
			count++;
		}
	for (int k = 0; k < 6; k++)
		free(plane[k / 3][k % 3]);
	free(weight);
	return sum / (double)count;
}

static struct quality judge(const struct fill *f)
{
	int size = f->original.width;
	double own = 0, fine = 0, step = 0, true_step = 0;
	for (int y = 1; y + 1 < size; y++)
		for (int x = 1; x + 1 < size; x++) {
			long i = (long)y * size + x;
			const long next[2] = { i + 1, i + size };
			for (int k = 0; k < 2 && f->original.px[4 * i + 3] > 0; k++) {
				long j = next[k];
				double a = log_green(&f->work, i) - log_green(&f->work, j), b = log_green(&f->original, i) - log_green(&f->original, j);
				if (!(f->original.px[4 * j + 3] > 0) || !(f->hidden[i] || f->hidden[j]))
					continue;
				bool edge = !f->hidden[i] || !f->hidden[j];
				*(edge ? &step : &own) += a * a;
				*(edge ? &true_step : &fine) += b * b;
			}
		}
	return (struct quality){ smooth_difference(f), fabs(0.5 * log(own / fine)), sqrt(step / true_step) };
}

struct result {
	char setting[128];
	struct bench_time time;
	struct quality quality[METHODS];
};

static int filling(struct result results[], const char *dir)
{
	struct err err = { 0 };
	int size = bench_quick() ? 512 : 1024;
	struct fill f = { 0 };
	if (!truth_load(&f.truth, dir, &err) || !iris_painted(&f.original, &f.extent, &f.truth, dir, size))
		return 0;
	size_t n = (size_t)size * (size_t)size;
	f.work = image_new(size, size, 4);
	f.hidden = mem_new(n, 1);
	struct image rgb = image_new(size, size, 3);
	for (size_t i = 0; i < n; i++)
		memcpy(rgb.px + 3 * i, f.original.px + 4 * i, 3 * sizeof(float));
	f.rgb8 = image_to_srgb8(&rgb);
	f.work8 = mem_array(n * 3, 1);
	for (int c = 0; c < COVERS; c++) {
		cover(&f, c);
		snprintf(results[c].setting, sizeof results[c].setting, "%s, %s", f.truth.name, cover_names[c]);
		for (f.method = 0; f.method < METHODS; f.method++) {
			struct bench_time t = bench_time(run_fill, &f, bench_quick() ? 1 : 2);
			results[c].quality[f.method] = judge(&f);
			bench_row("colour of what is filled", method_names[f.method], results[c].setting, t, "texture",
			          results[c].quality[f.method].colour, "dE00", "after a blur of 0.3 mm");
		}
	}
	image_free(&rgb);
	image_free(&f.original);
	image_free(&f.work);
	free(f.hidden);
	free(f.rgb8);
	free(f.work8);
	return COVERS;
}

static void fillings(void)
{
	enum { MOST = 32 };
	static struct result results[MOST * COVERS];
	char *dirs[MOST];
	int n = truth_captures(dirs, MOST), m = 0;
	for (int i = 0; i < n; i++) {
		const char *name = strrchr(dirs[i], '/') + 1;
		bool painted = !strncmp(name, "G01", 3) || (!bench_quick() && (!strncmp(name, "G08", 3) || !strncmp(name, "L02", 3)));
		m += painted ? filling(results + m, dirs[i]) : 0;
		free(dirs[i]);
	}
	double contrast[METHODS] = { 0 }, seam = 0, colour[METHODS] = { 0 };
	for (int i = 0; i < m; i++)
		for (int k = 0; k < METHODS; k++) {
			bench_row("fibres in what is filled", method_names[k], results[i].setting, untimed, "texture", results[i].quality[k].contrast, "",
			          "|log| of fine contrast over the true");
			contrast[k] += results[i].quality[k].contrast / m;
			colour[k] += results[i].quality[k].colour / m;
		}
	for (int i = 0; i < m; i++)
		for (int k = 0; k < METHODS; k++) {
			bench_row("seams of what is filled", method_names[k], results[i].setting, untimed, "texture", results[i].quality[k].seam, "",
			          "rms step at its edge over the true");
			seam = k ? seam : fmax(seam, results[i].quality[k].seam);
		}
	if (!m)
		return;
	bench_goal("filled: fibres' contrast, |log|, mean", "<= 0.2", contrast[0], "", contrast[0] <= 0.2);
	bench_goal("filled: step at the edge over the true, worst", "<= 1.3", seam, "", seam <= 1.3);
	bench_goal("filled: colour, mean, against mirrored rings", "no worse", colour[0] / colour[1], "", colour[0] <= colour[1]);
}

int main(int argc, char **argv)
{
	struct evidence_net *net;
	struct err err = { 0 };
	bench_open("covered", argc, argv);
	if (!evidence_open(&net, "config/evidence.onnx", &err)) {
		fprintf(stderr, "bench_covered: %s\n", err.msg);
		return 1;
	}
	fillings();
	whites(net);
	evidence_close(net);
	return bench_close();
}
