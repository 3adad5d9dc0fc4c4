/* The search for melanin from colours at the edge of what there is: black, white, saturated, of one colour; and from starts
 * anywhere in the priors' range, which end in the same place, or the fit says that there are two. Nothing that comes back is
 * not a number. Flagged: refused, or more than one minimum said. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tissue/pigment/pigment.h"
#include "tests/lib/stress.h"

/* The priors of config/pigment.conf, first order and all orders. */
static struct pigment_conf plain(bool multiple)
{
	return (struct pigment_conf) {
		.prior = { { log(0.02), 1.5 }, { 0.7, 0.15 }, { log(0.01), 1.5 }, { 0.7, 0.15 }, { log(0.3), 0.7 },
		           { multiple ? 0 : log(2.2), multiple ? 0.25 : 0.5 }, { 0, 0.05 }, { 0, 0.05 }, { 0, 0.01 } },
		.abl_thickness = 0.04, .cos_light = 0.84, .cos_view = 1, .light_error = 0.25, .model_error = 0.1, .floor = 0.003,
		.bands = 4, .starts = 1, .multiple = multiple,
	};
}

static void draw(double x[PIGMENT_N], const struct pigment_conf *conf, struct rng *rng, double wide)
{
	for (int j = 0; j < PIGMENT_N; j++)
		x[j] = conf->prior[j][0] + wide * conf->prior[j][1] * rng_range(rng, -1, 1);
	x[PIGMENT_VEIL] = fabs(x[PIGMENT_VEIL]);
	x[PIGMENT_ABL_MELANIN] = fmin(x[PIGMENT_ABL_MELANIN], -0.6);
	x[PIGMENT_STROMA_MELANIN] = fmin(x[PIGMENT_STROMA_MELANIN], -0.6);
	for (int j = PIGMENT_ABL_RATIO; j <= PIGMENT_STROMA_RATIO; j += 2)
		x[j] = fmin(fmax(x[j], 0.01), 0.99);
}

static struct pigment_classes photograph(const double x[PIGMENT_N], const struct pigment_conf *conf, struct rng *rng)
{
	struct pigment_classes out = { .n = 3 + rng_below(rng, 20) };
	struct tissue tissue = pigment_tissue(x, conf);
	struct tissue_bands bands;
	struct tissue_optics optics;
	tissue_bands_make(&bands, conf->bands, conf->illuminant);
	tissue_optics_make(&optics, &tissue, &bands);
	for (int i = 0; i < out.n; i++) {
		struct pigment_class *c = &out.of[i];
		*c = (struct pigment_class) { .thickness = 0.2 + 0.5 * i / (out.n - 1), .share = 0.5, .texels = 1e6 };
		pigment_model(c->rgb, x, &optics, c->thickness, conf);
		double light = conf->light_error * rng_normal(rng);
		for (int k = 0; k < 3; k++)
			c->rgb[k] *= exp(light + (k != 1 ? conf->model_error * rng_normal(rng) : 0));
	}
	return out;
}

static bool numbers(const struct pigment_fit *fit)
{
	double sum = fit->cost + fit->residual + fit->residual_colour;
	for (int j = 0; j < PIGMENT_N; j++) {
		sum += fit->x[j] + fit->sigma[j];
		for (int k = 0; k < PIGMENT_N; k++)
			sum += fit->correlation[j][k];
		if (!(fit->sigma[j] >= 0))
			return false;
	}
	return isfinite(sum);
}

/* From many starts, drawn three sigmas wide, to the places that one fit of many starts says there are. */
static void starts(struct stress *s)
{
	struct pigment_conf conf = plain(s->index % 2);
	struct err err = { 0 };
	double truth[PIGMENT_N];
	struct pigment_fit all, one;
	draw(truth, &conf, &s->rng, 2);
	struct pigment_classes classes = photograph(truth, &conf, &s->rng);
	conf.starts = 24;
	stress_about(s, "%d classes, ln melanin %.2f over %.2f, all orders %d", classes.n, truth[PIGMENT_ABL_MELANIN],
	             truth[PIGMENT_STROMA_MELANIN], conf.multiple);
	if (!pigment_solve(&all, &classes, &conf, 0, &err) || !numbers(&all)) {
		stress_wrong(s, "many starts: no answer: %s", err.msg);
		return;
	}
	if (all.minima > 1)
		stress_flagged(s);
	conf.starts = 1;
	for (int i = 0; i < 12; i++) {
		double from[PIGMENT_N], worst = 0;
		draw(from, &conf, &s->rng, 3);
		if (!pigment_solve(&one, &classes, &conf, from, &err) || !numbers(&one)) {
			stress_wrong(s, "start %d: no answer: %s", i, err.msg);
			return;
		}
		for (int j = 0; j < PIGMENT_N; j++)
			worst = fmax(worst, fabs(one.x[j] - all.x[j]) / all.sigma[j]);
		if (one.cost < all.cost - 1e-3)
			stress_wrong(s, "start %d ends lower than the fit: %.6g, %.6g", i, one.cost, all.cost);
		if (all.minima > 1 || one.cost > all.cost + 2)
			continue;  // said, or so much worse that it is not counted as another answer
		stress_measure(s, worst, "sigma between two starts' ends");
		if (worst > 0.5)  // a flat valley: nearer than that is the same answer
			stress_wrong(s, "start %d ends %.2g sigma away at cost %.6g, not %.6g, and nothing says so", i, worst, one.cost, all.cost);
	}
}

/* Parameters that the colours do not separate: classes of nearly one thickness, few bands of light. Whatever is found explains
 * them as well as the truth does, and no number is surer than it is right. */
static void correlated(struct stress *s)
{
	struct pigment_conf conf = plain(s->index % 2);
	struct err err = { 0 };
	double truth[PIGMENT_N], spread = pow(10, rng_range(&s->rng, -6, -1)), most = 0, worst = 0;
	struct pigment_fit fit;
	conf.light_error = conf.model_error = 0.02;
	draw(truth, &conf, &s->rng, 1.5);
	struct pigment_classes classes = photograph(truth, &conf, &s->rng);
	struct tissue tissue = pigment_tissue(truth, &conf);
	struct tissue_bands bands;
	struct tissue_optics optics;
	tissue_bands_make(&bands, conf.bands, conf.illuminant);
	tissue_optics_make(&optics, &tissue, &bands);
	for (int i = 0; i < classes.n; i++) {
		struct pigment_class *c = &classes.of[i];
		c->thickness = 0.4 * (1 + spread * i / classes.n);
		pigment_model(c->rgb, truth, &optics, c->thickness, &conf);
	}
	stress_about(s, "%d classes, thickness varies by %.1g, ln melanin %.2f over %.2f, all orders %d", classes.n, spread, truth[PIGMENT_ABL_MELANIN],
	             truth[PIGMENT_STROMA_MELANIN], conf.multiple);
	conf.starts = 8;
	if (!pigment_solve(&fit, &classes, &conf, 0, &err) || !numbers(&fit)) {
		stress_wrong(s, "no answer, or none of numbers: %s", err.msg);
		return;
	}
	for (int j = 0; j < PIGMENT_N; j++) {
		worst = fmax(worst, fabs(fit.x[j] - truth[j]) / fit.sigma[j]);
		for (int k = 0; k < j; k++)
			most = fmax(most, fabs(fit.correlation[j][k]));
	}
	if (fit.minima > 1)
		stress_flagged(s);
	stress_measure(s, worst, "sigma from the truth");
	if (s->show)
		printf("  largest correlation %.4f, residual %.2g\n", most, fit.residual);
	if (most > 1 + 1e-9)
		stress_wrong(s, "a correlation of %.6f", most);
	if (fit.minima == 1 && worst > 5)
		stress_wrong(s, "%.2g sigma from the truth", worst);
}

/* Colours that no tissue has. */
static void strange(struct stress *s)
{
	static const double values[] = { 0, 1e-12, 1e-6, 0.003, 0.1, 1, 1.5, 1e3, 1e12 };
	struct pigment_conf conf = plain(s->index % 2);
	struct rng *rng = &s->rng;
	struct pigment_classes classes = { .n = 3 + rng_below(rng, 40) };
	const int kind = rng_below(rng, 4);
	double same[3], thick = rng_range(rng, 0, 1);
	conf.polarised = rng_uniform(rng) < 0.3;
	conf.starts = 1 + rng_below(rng, 4);
	for (int k = 0; k < 3; k++)
		same[k] = values[rng_below(rng, COUNT(values))];
	for (int i = 0; i < classes.n; i++) {
		struct pigment_class *c = &classes.of[i];
		*c = (struct pigment_class) { .thickness = kind == 1 ? thick : rng_range(rng, 0, 1), .share = rng_uniform(rng),
			                          .texels = pow(10, rng_range(rng, 0, 7)) };
		for (int k = 0; k < 3; k++) {
			c->rgb[k] = kind == 0 || kind == 1 ? same[k] : kind == 2 ? values[rng_below(rng, COUNT(values))] : k == 0 ? 1 : 0;
			c->spread[k] = rng_uniform(rng) < 0.5 ? 0 : 0.1 * c->rgb[k];
		}
	}
	stress_about(s, "%d classes of kind %d, first %g %g %g", classes.n, kind, classes.of[0].rgb[0], classes.of[0].rgb[1], classes.of[0].rgb[2]);
	struct pigment_fit fit;
	struct err err = { 0 };
	if (!pigment_solve(&fit, &classes, &conf, 0, &err)) {
		stress_flagged(s);
		if (!err_is(&err) || strchr(err.msg, '\n'))
			stress_wrong(s, "refused without a line");
	} else if (!numbers(&fit))
		stress_wrong(s, "an answer that is not numbers: cost %g, residual %g, sigma of the first %g", fit.cost, fit.residual, fit.sigma[0]);
}

int main(int argc, char **argv)
{
	struct stress s;
	stress_start(&s, "pigment", argc, argv);
	for (stress_family(&s, "starts anywhere", 30); stress_case(&s);)
		starts(&s);
	for (stress_family(&s, "correlated parameters", 60); stress_case(&s);)
		correlated(&s);
	for (stress_family(&s, "colours that no tissue has", 200); stress_case(&s);)
		strange(&s);
	return stress_end(&s);
}
