#include "tests/lib/unseen/tally.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"

static const double DEG = M_PI / 180;
const char *const tally_bin[TALLY_BINS] = { "all", "drawn (tests/evidence, test split)", "cast (tests/lib/cast)",
	"path-traced (EYEWRIGHT_TRACED)", "heads (EYEWRIGHT_HEADS)", "opening below 0.4 of the iris",
	"opening 0.4 to 0.8", "opening above 0.8", "tungsten light", "balanced light", "bluish light", "radius 30 to 60 px", "radius 60 to 120 px",
	"radius 120 to 500 px", "tilt below 15 deg", "tilt 15 to 30 deg", "tilt above 30 deg" };

bool tally_in(int bin, const struct outcome *o)
{
	const double a = o->eye.limbus.a, tilt = o->eye.theta / DEG;
	switch (bin) {
	case 0: return true;
	case 1: return o->maker == UNSEEN_DRAWN;
	case 2: return o->maker == UNSEEN_CAST;
	case 3: return o->maker == UNSEEN_TRACED;
	case 4: return o->maker == UNSEEN_HEADS;
	case 5: return o->opening < 0.4;
	case 6: return o->opening >= 0.4 && o->opening <= 0.8;
	case 7: return o->opening > 0.8;
	case 8: return o->warmth > 1.6;
	case 9: return o->warmth >= 0.8 && o->warmth <= 1.6;
	case 10: return o->warmth < 0.8;
	case 11: return a < 60;
	case 12: return a >= 60 && a < 120;
	case 13: return a >= 120;
	case 14: return tilt < 15;
	case 15: return tilt >= 15 && tilt <= 30;
	default: return tilt > 30;
	}
}

void outcome_of(struct outcome *o, int number, const struct unseen *u)
{
	o->number = number;
	o->width = u->photo.width;
	o->height = u->photo.height;
	o->maker = u->maker;
	o->eye = u->eye[0];
	o->opening = u->opening;
	o->warmth = u->warmth;
}

struct verdict verdict_of(const struct answer *a, const struct unseen *u)
{
	struct verdict v = { .ran = true, .ok = a->ok, .rough = a->rough, .error = NAN, .share = NAN, .ratio = { NAN, NAN, NAN, NAN }, .tilt = NAN, .tilt_ratio = NAN,
		.weak = NAN, .seconds = a->seconds, .e = a->e };
	snprintf(v.reason, sizeof v.reason, "%.95s", a->reason);
	if (!a->ok && !(a->rough > 0))
		return v;
	const struct unseen_eye *eye = answer_meant(&a->e, u);
	const struct ellipse *t = &eye->limbus;
	v.error = ellipse_apart(&a->e, t);
	v.share = v.error / t->a;
	v.right = a->ok && v.share <= answer_right();
	v.has_pupil = a->has_pupil && eye->pupil.a > 0;  // of heads none is known
	v.pupil_wrong = v.has_pupil && ellipse_apart(&a->pupil, &eye->pupil) > 0.1 * t->a;
	const double off[4] = { a->e.cx - t->cx, a->e.cy - t->cy, a->e.a - t->a, a->e.b - t->b };
	for (int k = 0; k < 4; k++)
		v.ratio[k] = a->sigma[k] > 0 ? fabs(off[k]) / a->sigma[k] : NAN;
	if (u->leans)
		return v;
	v.tilt = fabs(a->theta - eye->theta) / DEG;
	v.tilt_ratio = fabs(a->theta - eye->theta) / a->theta_sigma;
	v.weak = fabs(a->weak - eye->theta) / DEG;
	return v;
}

static double quantile(int n, double *x, double q)
{
	return n ? stats_quantile(n, x, q) : NAN;
}

static void push(double *x, int *n, double value)
{
	if (!isnan(value))
		x[(*n)++] = value;
}

struct tally tally_make(int n, const struct outcome *o, int method, int bin)
{
	enum { ERROR, RATIO, ROUGH_RATIO, ROUGH_TILT_RATIO, TILT_RATIO, TILT, WEAK, SECONDS, LISTS };
	double *list[LISTS];
	int of[LISTS] = { 0 };
	struct tally t = { 0 };
	for (int l = 0; l < LISTS; l++)
		list[l] = mem_array((size_t)(4 * n + 1), sizeof(double));
	for (int i = 0; i < n; i++) {
		const struct verdict *v = &o[i].by[method];
		if (!v->ran || !tally_in(bin, &o[i]))
			continue;
		const bool half = o[i].eye.showing >= 0.5;
		t.n++;
		t.right += v->right;
		t.near += v->ok && v->share <= 0.05;
		t.wrong += v->ok && !v->right;
		t.pupils += v->right && v->has_pupil;
		t.pupils_wrong += v->right && v->pupil_wrong;
		t.refused += !v->ok;
		t.half += half;
		t.half_found += half && v->right;
		const bool rough = !v->ok && v->rough > 0 && v->rough <= ANSWER_ROUGH;
		t.rough += rough;
		t.rough_off += rough && v->share > v->rough;
		t.half_rough += half && rough && v->share <= v->rough;
		push(list[ERROR], &of[ERROR], v->right ? v->error : NAN);
		for (int k = 0; k < 4; k++)
			push(list[v->ok ? RATIO : ROUGH_RATIO], &of[v->ok ? RATIO : ROUGH_RATIO], v->ok || rough ? v->ratio[k] : NAN);
		push(list[v->ok ? TILT_RATIO : ROUGH_TILT_RATIO], &of[v->ok ? TILT_RATIO : ROUGH_TILT_RATIO], v->ok || rough ? v->tilt_ratio : NAN);
		push(list[TILT], &of[TILT], v->right ? v->tilt : NAN);
		push(list[WEAK], &of[WEAK], v->right ? v->weak : NAN);
		push(list[SECONDS], &of[SECONDS], v->seconds);
	}
	t.median_px = quantile(of[ERROR], list[ERROR], 0.5);
	t.ratio90 = quantile(of[RATIO], list[RATIO], 0.9);
	t.rough_ratio90 = quantile(of[ROUGH_RATIO], list[ROUGH_RATIO], 0.9);
	t.rough_tilt_ratio90 = quantile(of[ROUGH_TILT_RATIO], list[ROUGH_TILT_RATIO], 0.9);
	t.tilt_ratio90 = quantile(of[TILT_RATIO], list[TILT_RATIO], 0.9);
	t.tilt_median = quantile(of[TILT], list[TILT], 0.5);
	t.weak_median = quantile(of[WEAK], list[WEAK], 0.5);
	t.seconds = quantile(of[SECONDS], list[SECONDS], 0.5);
	for (int l = 0; l < LISTS; l++)
		free(list[l]);
	return t;
}

bool tally_csv(const char *path, int n, const struct outcome *o, int methods, const char *const name[])
{
	FILE *f = fopen(path, "w");
	if (!f)
		return false;
	fputs("case,method,width,height,maker,cx,cy,a,b,angle_deg,showing,opening,warmth,theta_deg,verdict,error_px,error_of_a,"
	      "got_cx,got_cy,got_a,got_b,got_angle_deg,ratio_cx,ratio_cy,ratio_a,ratio_b,tilt_error_deg,tilt_ratio,seconds,reason\n", f);
	for (int i = 0; i < n; i++)
		for (int m = 0; m < methods; m++) {
			const struct outcome *c = &o[i];
			const struct verdict *v = &c->by[m];
			const struct ellipse *t = &c->eye.limbus, *e = &v->e;
			if (!v->ran)
				continue;
			fprintf(f, "%d,%s,%d,%d,%d,%.2f,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f,%.2f,%.2f,%s,%.3f,%.5f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.4f,\"%s\"\n",
			        c->number, name[m], c->width, c->height, (int)c->maker, t->cx, t->cy, t->a, t->b, t->angle / DEG, c->eye.showing, c->opening,
			        c->warmth, c->eye.theta / DEG, v->right ? "right" : v->ok ? "WRONG" : v->rough > 0 ? v->share <= v->rough ? "rough" : "rough, OFF" : "refused", v->error, v->share, e->cx, e->cy, e->a, e->b,
			        e->angle / DEG, v->ratio[0], v->ratio[1], v->ratio[2], v->ratio[3], v->tilt, v->tilt_ratio, v->seconds, v->reason);
		}
	return fclose(f) == 0;
}
