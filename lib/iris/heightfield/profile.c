#include <math.h>

#include "base/json.h"
#include "iris/heightfield/heightfield.h"

bool pupil_load(struct pupil *pupil, const char *path, double fallback, struct err *err)
{
	json_t *json = json_read(path, 1 << 20, err);
	if (!json)
		return false;
	const json_t *at = json_object_get(json, "pupil");
	*pupil = (struct pupil) { 0, 0, fallback };
	bool ok = !json_is_object(at)
	          || (json_get(&pupil->x, at, "cx", path, err) && json_get(&pupil->y, at, "cy", path, err)
	              && json_get(&pupil->r, at, "r", path, err));
	json_decref(json);
	if (ok && !(pupil->r > 0 && pupil->r < 6 && fabs(pupil->x) < 3 && fabs(pupil->y) < 3))
		return err_set(err, "%s: pupil at (%g, %g), radius %g mm: not inside an iris", path, pupil->x, pupil->y, pupil->r);
	return ok;
}

/* Circle s has its centre (1 - s) c and radius r + s (root - r): |p - (1 - s) c| = r + s w, quadratic in s. */
double iris_share(const struct pupil *pupil, double root, double x, double y)
{
	double dx = x - pupil->x, dy = y - pupil->y, w = root - pupil->r;
	double a = pupil->x * pupil->x + pupil->y * pupil->y - w * w;  // < 0: the pupil lies inside the root
	double b = dx * pupil->x + dy * pupil->y - pupil->r * w;
	double c = dx * dx + dy * dy - pupil->r * pupil->r;
	return (-b - sqrt(fmax(b * b - a * c, 0))) / a;
}

/* Slopes that keep a cubic monotone: weighted harmonic means, zero at local extrema, one-sided at the ends (Fritsch and
 * Butland 1984). */
static void slopes(int n, const double x[], const double y[], double m[])
{
	double h[PROFILE_KNOTS], d[PROFILE_KNOTS];
	for (int i = 0; i < n - 1; i++) {
		h[i] = x[i + 1] - x[i];
		d[i] = (y[i + 1] - y[i]) / h[i];
	}
	for (int i = 1; i < n - 1; i++) {
		double w1 = 2 * h[i] + h[i - 1], w2 = h[i] + 2 * h[i - 1];
		m[i] = d[i - 1] * d[i] > 0 ? (w1 + w2) / (w1 / d[i - 1] + w2 / d[i]) : 0;
	}
	m[0] = d[0];
	m[n - 1] = d[n - 2];
}

static double hermite(double x0, double x1, double y0, double y1, double m0, double m1, double x)
{
	double h = x1 - x0, t = (x - x0) / h, u = 1 - t;
	return u * u * ((1 + 2 * t) * y0 + t * h * m0) + t * t * ((1 + 2 * u) * y1 - u * h * m1);
}

static void knot(struct profile *p, double share, double mm, double sigma)
{
	p->share[p->n] = share;
	p->mm[p->n] = mm;
	p->sigma[p->n++] = sigma;
}

void profile_make(struct profile *p, const struct profile_conf *c, double width)
{
	enum { ID1, ID2, ID3 };
	// Neighbouring knots stay a tenth of the iris apart, however narrow a wide pupil makes it.
	double s3 = fmin(c->id3_from_margin / width, 0.4), s1 = fmax(1 - c->id1_from_spur / width, 0.8);
	double s2 = 1 - c->id2_from_root / width;
	*p = (struct profile) { 0 };
	knot(p, 0, c->margin_share * c->id[ID3], c->margin_share * c->id_sigma[ID3]);
	knot(p, s3, c->id[ID3], c->id_sigma[ID3]);
	if (s2 > s3 + 0.1 && s2 < s1 - 0.1)
		knot(p, s2, c->id[ID2], c->id_sigma[ID2]);
	knot(p, s1, c->id[ID1], c->id_sigma[ID1]);
	knot(p, 1, c->root_share * c->id[ID1], c->root_share * c->id_sigma[ID1]);
	slopes(p->n, p->share, p->mm, p->slope);
	slopes(p->n, p->share, p->sigma, p->sigma_slope);
}

double profile_at(const struct profile *p, double share, double *sigma)
{
	double s = fmin(fmax(share, 0), 1);
	int i = 0;
	while (i < p->n - 2 && s > p->share[i + 1])
		i++;
	double x0 = p->share[i], x1 = p->share[i + 1];
	if (sigma)
		*sigma = hermite(x0, x1, p->sigma[i], p->sigma[i + 1], p->sigma_slope[i], p->sigma_slope[i + 1], s);
	return hermite(x0, x1, p->mm[i], p->mm[i + 1], p->slope[i], p->slope[i + 1], s);
}
