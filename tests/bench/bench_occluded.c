/* What covers an iris, kept out of its texture: lids and lashes, reflections; and what of the iris is lost by that. By the brightness and hue of the rings alone, with
 * the evidence of the pixels, and with the network that looks at the iris alone. On drawn eyes of the test split (the class of every pixel is known), on such that
 * mirror surroundings, and on another renderer's where EYEWRIGHT_TRACED names what tests/evidence/traced.py --mirrors has written.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/plane.h"
#include "iris/unrefract/unrefract.h"
#include "limbus/occlusion.h"
#include "math/rng.h"
#include "math/stats.h"
#include "tests/evidence/kept.h"
#include "tests/evidence/scene.h"
#include "tests/evidence/veil.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/iris.h"

static const struct eye anatomy = { 7.8, 0.75, 1.336, 5.85, 1, 3.3, false, 6.5, 0.75, 0.55, 1.376 };
static const struct bench_time untimed = { NAN, NAN, NAN };

enum { WIDE = 384, HIGH = 288, EYES_MOST = 120, BY_RINGS = 0, BY_EVIDENCE, BY_OCCLUSION, WAYS };
static const char *const way_names[WAYS] = { "brightness and hue of the rings", "with the pixels' evidence", "with the iris' own network" };

struct nets { struct evidence_net *evidence; struct occlusion_net *occlusion; };

/* The fit of a circle seen so, under weak perspective: the eye looks to the side of its limbus to which the pupil lies. */
static struct fit fit_of(const struct drawn_eye *e, int width, int height)
{
	struct fit fit = { .ok = true, .has_pupil = e->pupil[2] > 0, .width = width, .height = height, .edge_sigma_px = 1, .limbus_aspect = 1,
		           .limbus = { e->limbus[0], e->limbus[1], e->limbus[2], e->limbus[3], e->limbus[4] },
		           .pupil = { e->pupil[0], e->pupil[1], e->pupil[2], e->pupil[3], e->pupil[4] } };
	const double far = 1000, focal = fit.limbus.a / anatomy.limbus_radius * far, depth = eye_limbus_depth(&anatomy);
	double theta = acos(fmin(1, fit.limbus.b / fit.limbus.a)), phi = fit.limbus.angle + M_PI / 2;
	if ((fit.pupil.cx - fit.limbus.cx) * cos(phi) + (fit.pupil.cy - fit.limbus.cy) * sin(phi) < 0)
		phi += M_PI;
	fit.camera = (struct camera){ .focal_px = focal, .center_px = { width / 2., height / 2. }, .source = CAMERA_CONF };
	fit.theta = theta;
	fit.phi = phi;
	// The smallest rotation that takes (0, 0, -1) to the direction of gaze (Rodrigues).
	double v[3] = { sin(theta) * sin(phi), -sin(theta) * cos(phi), 0 }, c = cos(theta);
	double K[3][3] = { { 0, -v[2], v[1] }, { v[2], 0, -v[0] }, { -v[1], v[0], 0 } };
	double at[3] = { (fit.limbus.cx - width / 2.) * far / focal, (fit.limbus.cy - height / 2.) * far / focal, far };
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++) {
			double square = 0;
			for (int k = 0; k < 3; k++)
				square += K[i][k] * K[k][j];
			fit.cam_from_eye[i][j] = (i == j) + K[i][j] + square / (1 + c);
		}
		fit.cam_from_eye[i][3] = at[i] - fit.cam_from_eye[i][2] * depth;
	}
	fit.cam_from_eye[3][3] = 1;
	for (int i = 0; i < FIT_SECTORS; i++)
		fit.seen[i] = 1;
	return fit;
}

struct covers {
	int n, n_mirrored, n_added, n_pupils;
	double wrong[EYES_MOST], mirrored[EYES_MOST], missed[EYES_MOST];  // %
	double added[EYES_MOST];                                        // % of the iris' own light
	double pupil[EYES_MOST], usual[EYES_MOST], sigmas[EYES_MOST];    // mm; error over sigma
};

/* What the survey keeps, against the classes; the margins of pupil and limbus are left out, where classes and blur are undecided. Of what a reflection adds to, the iris is
 * lost only where it is less than a tenth of its own light. */
static void count(struct covers *c, const struct unrefract_view *view, const struct fit *fit, const struct drawn *d)
{
	const struct unrefract_survey *s = &view->survey;
	double kept = 0, wrong = 0, iris = 0, missed = 0, mirror = 0, mirror_kept = 0, added = 0, shown = 0, to = s->size / (2 * s->extent);
	const struct veil veil = veil_of(d, fit->limbus.cx, fit->limbus.cy, fit->limbus.a);
	const bool measured = d->mirror && veil.iris > 0;
	for (int y = 0; y < d->height; y++)
		for (int x = 0; x < d->width; x++) {
			double px[2] = { x + 0.5, y + 0.5 }, p[2], rim;
			if (hypot(px[0] - fit->limbus.cx, px[1] - fit->limbus.cy) > fit->limbus.a || !iris_see(p, &rim, &view->iris, px)
			    || rim > 0.94 * anatomy.limbus_radius || hypot(p[0] - view->pupil.cx, p[1] - view->pupil.cy) < view->pupil.r + 0.15)
				continue;
			const long i = (long)y * d->width + x;
			const int is = d->label[i];
			const bool w = plane_sample(s->weight, s->size, s->size, (p[0] + s->extent) * to, (p[1] + s->extent) * to) > 0.1f;
			const double more = measured ? fmax(d->mirror[i] - veil.mirrored, 0) / veil.iris : 0;
			kept += w;
			wrong += w && (is == EVIDENCE_SKIN || is == EVIDENCE_LASH || is == EVIDENCE_SCLERA);
			mirror += is == EVIDENCE_REFLECTION;
			mirror_kept += w && is == EVIDENCE_REFLECTION;
			iris += is == EVIDENCE_IRIS && more < 0.1;
			missed += is == EVIDENCE_IRIS && more < 0.1 && !w;
			shown += w && is >= EVIDENCE_IRIS;
			added += w && is >= EVIDENCE_IRIS ? more : 0;
		}
	c->wrong[c->n] = 100 * wrong / fmax(kept, 1);
	c->missed[c->n] = 100 * missed / fmax(iris, 1);
	c->n++;
	if (mirror > 0.002 * M_PI * fit->limbus.a * fit->limbus.b)
		c->mirrored[c->n_mirrored++] = 100 * mirror_kept / mirror;
	if (measured && shown > 0)
		c->added[c->n_added++] = 100 * added / shown;
}

static double mean(int n, const double *v)
{
	double sum = 0;
	for (int i = 0; i < n; i++)
		sum += v[i] / n;
	return sum;
}

/* The size of the pupil as if its margin had not been measured, against the true ellipse's. */
static void count_pupil(struct covers *c, const struct photo *photo, const struct fit *fit, const struct evidence *told, const struct occlusion *occlusion, const struct unrefract_view *view,
                        const struct unrefract_conf *conf)
{
	struct fit unmeasured = *fit;
	struct unrefract_view guess = { .name = "drawn", .occlusion = occlusion };
	struct err err = { 0 };
	unmeasured.has_pupil = false;
	if (fit->has_pupil && unrefract_survey(&guess, photo, &unmeasured, told, 0, &anatomy, conf, &err)) {
		const double truth = view->pupil.r;
		c->pupil[c->n_pupils] = fabs(guess.pupil.r - truth);
		c->usual[c->n_pupils] = fabs(conf->pupil_usual[0] - truth);
		c->sigmas[c->n_pupils++] = fabs(log(guess.pupil.r / truth)) / guess.pupil_sigma;
	}
	unrefract_view_free(&guess);
}

static void measure(struct covers covers[WAYS], const struct nets *nets, const struct drawn *d, bool pupils)
{
	struct unrefract_conf conf = iris_unrefract_conf("draft");
	struct photo photo = photo_of_bytes(d->rgb, d->width, d->height);
	struct fit fit = fit_of(&d->eye[0], d->width, d->height);
	struct evidence evidence;
	static struct occlusion occlusion;
	struct err err = { 0 };
	if (evidence_window(&evidence, nets->evidence, &photo, fit.limbus.cx, fit.limbus.cy, fit.limbus.a, &err)
	    && occlusion_read(&occlusion, nets->occlusion, &photo, &evidence, &fit.limbus, &err)) {
		const struct balance_conf conf_white = iris_balance_conf();
		for (int k = 0; k < WAYS; k++) {
			const struct evidence *told = k == BY_RINGS ? 0 : &evidence;
			struct unrefract_view view = { .name = "drawn", .white = balance_sclera(&photo, &fit, told, &conf_white), .occlusion = k == BY_OCCLUSION ? &occlusion : 0 };
			if (unrefract_survey(&view, &photo, &fit, told, 0, &anatomy, &conf, &err))
				count(&covers[k], &view, &fit, d);
			if (k == BY_OCCLUSION && view.used && pupils)
				count_pupil(&covers[k], &photo, &fit, told, &occlusion, &view, &conf);
			unrefract_view_free(&view);
		}
	} else {
		fprintf(stderr, "bench_occluded: %s\n", err.msg);
	}
	evidence_free(&evidence);
	photo_free(&photo);
}

static void tell(struct covers covers[WAYS], const char *eyes)
{
	for (int k = 0; k < WAYS; k++) {
		struct covers *c = &covers[k];
		bench_row("covers left in the texture", way_names[k], eyes, untimed, "eye", mean(c->n, c->wrong), "%", "of what is kept is lid, lash or sclera");
		bench_row("covers left in the texture", way_names[k], eyes, untimed, "eye", mean(c->n_mirrored, c->mirrored), "%", "of reflections is kept");
		if (c->n_mirrored)
			bench_row("covers left in the texture", way_names[k], eyes, untimed, "eye", stats_quantile(c->n_mirrored, c->mirrored, 0.5), "%", "of reflections is kept, median");
		bench_row("covers left in the texture", way_names[k], eyes, untimed, "eye", mean(c->n, c->missed), "%", "of the visible iris is lost");
		if (c->n_added)
			bench_row("covers left in the texture", way_names[k], eyes, untimed, "eye", stats_quantile(c->n_added, c->added, 0.9), "%", "of the iris' light is added by reflections, 90 %");
	}
	const double before = mean(covers[BY_RINGS].n, covers[BY_RINGS].wrong), after = mean(covers[BY_OCCLUSION].n, covers[BY_OCCLUSION].wrong);
	if (before > 0)
		bench_goal("lid, lash or sclera in what is kept, against without evidence", "<= 1/4", after / before, "", after <= before / 4);
}

static bool fits(const struct drawn *d)
{
	return d->n_eyes == 1 && d->eye[0].shown > 0.35 && d->eye[0].limbus[3] > 0.75 * d->eye[0].limbus[2];
}

/* From which number on: the first thousands judge; EYEWRIGHT_FIRST: others, of the same split. */
static void drawn_eyes(const struct nets *nets, bool around)
{
	struct covers *covers = mem_new(WAYS, sizeof *covers);
	struct rng rng = { 11 };
	const uint64_t first = getenv("EYEWRIGHT_FIRST") ? strtoull(getenv("EYEWRIGHT_FIRST"), 0, 10) : 1;
	for (uint64_t number = first; covers[0].n < (bench_quick() ? 16 : EYES_MOST) && number < first + 2000; number++) {
		struct drawn_view at = { .radius = (float)(45 + 45 * rng_uniform(&rng)), .x = WIDE * (float)(0.4 + 0.2 * rng_uniform(&rng)),
			                 .y = HIGH * 0.5f, .turn = (float)(0.4 * rng_uniform(&rng) - 0.2), .around = around };
		struct drawn d = drawn_photograph(number, &at, WIDE, HIGH);
		if (fits(&d))
			measure(covers, nets, &d, true);
		drawn_free(&d);
	}
	tell(covers, around ? "drawn eyes in surroundings, mean" : "drawn eyes, mean");
	if (!around) {
		struct covers *c = &covers[BY_OCCLUSION];
		bench_row("pupils taken as unmeasured", "evidence, step, usual size", "drawn eyes, mean", untimed, "eye", mean(c->n_pupils, c->pupil), "mm", "of the radius");
		bench_row("pupils taken as unmeasured", "the usual size alone", "drawn eyes, mean", untimed, "eye", mean(c->n_pupils, c->usual), "mm", "of the radius");
		if (c->n_pupils) {
			const double within = stats_quantile(c->n_pupils, c->sigmas, 0.9);
			bench_goal("pupils taken as unmeasured: error over sigma, 90 %", "<= 2", within, "", within <= 2);
		}
	}
	free(covers);
}

static void traced_eyes(const struct nets *nets)
{
	const char *path = getenv("EYEWRIGHT_TRACED");
	FILE *file = path ? fopen(path, "rb") : 0;
	struct drawn d;
	if (!file) {
		printf("path-traced eyes: EYEWRIGHT_TRACED=FILE names them; left out\n");
		return;
	}
	struct covers *covers = mem_new(WAYS, sizeof *covers);
	while (covers[0].n < EYES_MOST && kept_next(&d, file)) {
		if (d.n_eyes == 1 && d.eye[0].shown > 0.1 && d.eye[0].limbus[3] > 0.75 * d.eye[0].limbus[2])
			measure(covers, nets, &d, false);
		drawn_free(&d);
	}
	fclose(file);
	tell(covers, "path-traced eyes, mean");
	free(covers);
}

int main(int argc, char **argv)
{
	struct nets nets = { 0 };
	struct err err = { 0 };
	bench_open("occluded", argc, argv);
	const char *other = getenv("EYEWRIGHT_OCCLUSION");
	if (!evidence_open(&nets.evidence, "config/evidence.onnx", &err) || !occlusion_open(&nets.occlusion, other ? other : "config/occlusion.onnx", &err)) {
		fprintf(stderr, "bench_occluded: %s\n", err.msg);
		evidence_close(nets.evidence);
		return 1;
	}
	drawn_eyes(&nets, false);
	drawn_eyes(&nets, true);
	traced_eyes(&nets);
	occlusion_close(nets.occlusion);
	evidence_close(nets.evidence);
	return bench_close();
}
