#include "track/head/refine.h"

#include <math.h>
#include <string.h>

/* Colour histograms of the eyes and of the skin round them are learnt from the picture under the current pose; along each
 * normal of an outline the best split between the two is found, and the pose is fitted to the splits by least squares (the two
 * histograms: Prisacariu and Reid 2012). */

enum { ROUNDS = 10, REACH = 96, ACROSS = 5, HUES = 24, GREYS = 16 };

static const double pitch_px = 0.5;      // between samples along a normal
static const double edge_weight = 0.02;  // px^-2: 128 edges with errors of 2 px count as ten that are independent

struct picture {
	const uint8_t *rgb;
	int width, height;
	double scale;                    // px for a px of a picture 1280 wide
	double eye[HUES * GREYS];        // log of how much likelier a colour is in an eye than round it
};

static int bin(const double c[3])
{
	double all = c[0] + c[1] + c[2] + 30, hue = (c[0] / all - 0.2) / 0.4 * HUES, grey = (log(all) - log(30.0)) / (log(795.0) - log(30.0)) * GREYS;
	int h = (int)fmax(0, fmin(HUES - 1, hue)), g = (int)fmax(0, fmin(GREYS - 1, grey));
	return h * GREYS + g;
}

static bool colour(double c[3], const struct picture *p, double x, double y)
{
	double u = x - 0.5, v = y - 0.5;
	int i = (int)floor(u), j = (int)floor(v);
	if (!(i >= 0 && j >= 0 && i < p->width - 1 && j < p->height - 1))
		return false;
	double a = u - i, b = v - j;
	const uint8_t *q = p->rgb + 3 * ((long)j * p->width + i), *low = q + 3 * (long)p->width;
	for (int m = 0; m < 3; m++)
		c[m] = (1 - b) * ((1 - a) * q[m] + a * q[m + 3]) + b * ((1 - a) * low[m] + a * low[m + 3]);
	return true;
}

/* Counts the colours of an outline scaled by factors from..to about its middle. */
static void count(double *histogram, const struct picture *p, double (*px)[2], const double middle[2], double from, double to)
{
	enum { RINGS = 24 };
	for (int i = 0; i < OPENING_POINTS; i++)
		for (int part = 0; part < 4; part++)
			for (int r = 0; r < RINGS; r++) {
				const double *a = px[i], *b = px[(i + 1) % OPENING_POINTS];
				double f = from + (to - from) * (r + 0.5) / RINGS, t = 0.25 * part, c[3];
				double x = middle[0] + f * ((1 - t) * a[0] + t * b[0] - middle[0]), y = middle[1] + f * ((1 - t) * a[1] + t * b[1] - middle[1]);
				if (colour(c, p, x, y))
					histogram[bin(c)] += f;
			}
}

static void smooth(double *h)
{
	double t[HUES * GREYS], sum = 0;
	for (int i = 0; i < HUES; i++)
		for (int j = 0; j < GREYS; j++) {
			double s = 0, n = 0;
			for (int a = -1; a <= 1; a++)
				for (int b = -1; b <= 1; b++)
					if (i + a >= 0 && i + a < HUES && j + b >= 0 && j + b < GREYS) {
						double w = (a ? 1 : 2) * (b ? 1 : 2);
						s += w * h[(i + a) * GREYS + j + b];
						n += w;
					}
			t[i * GREYS + j] = s / n;
			sum += s / n;
		}
	for (int i = 0; i < HUES * GREYS; i++)
		h[i] = t[i] / fmax(sum, 1e-9) + 1e-4;
}

static bool outline(double px[OPENING_POINTS][2], double middle[2], const double m[4][4], const struct camera *camera,
                    const struct eye_opening *opening)
{
	middle[0] = middle[1] = 0;
	for (int i = 0; i < OPENING_POINTS; i++) {
		if (!head_project(px[i], camera, m, opening->edge[i]))
			return false;
		for (int k = 0; k < 2; k++)
			middle[k] += px[i][k] / OPENING_POINTS;
	}
	return true;
}

static void learn(struct picture *p, const struct head_found *found, const struct camera *camera, const struct eye_opening opening[2],
                  double margin)
{
	double in[HUES * GREYS] = { 0 }, out[HUES * GREYS] = { 0 };
	for (int e = 0; e < 2; e++) {
		double px[OPENING_POINTS][2], middle[2];
		if (!found->seen[e] || !outline(px, middle, found->cam_from_head, camera, &opening[e]))
			continue;
		count(in, p, px, middle, 0, 1 - margin);
		count(out, p, px, middle, 1 + margin, 1.3 + 1.5 * margin);
	}
	smooth(in);
	smooth(out);
	for (int i = 0; i < HUES * GREYS; i++)
		p->eye[i] = fmax(-1.5, fmin(1.5, log(in[i] / out[i])));
}

/* The best split within +- range of px: *at px along the normal, *sure: its margin. Returns false when there is none. */
static bool split(double *at, double *sure, const struct picture *p, const double px[2], const double normal[2], double range)
{
	const double tangent[2] = { -normal[1], normal[0] };
	double v[2 * REACH + 1], sum[2 * REACH + 2] = { 0 }, pitch = pitch_px * p->scale, top = -INFINITY;
	int flank = 16, n = (int)fmin(REACH, ceil(1.5 * range / pitch) + flank), best = 0;
	for (int k = -n; k <= n; k++) {
		v[k + n] = 0;
		for (int j = 0; j < ACROSS; j++) {
			double c[3], s = p->scale * 1.5 * (j - (ACROSS - 1) / 2);
			if (!colour(c, p, px[0] + k * pitch * normal[0] + s * tangent[0], px[1] + k * pitch * normal[1] + s * tangent[1]))
				return false;
			// lashes are as dark as pupils: near black is no evidence
			v[k + n] += c[0] + c[1] + c[2] < 150 ? 0 : p->eye[bin(c)] / ACROSS;
		}
		sum[k + n + 1] = sum[k + n] + v[k + n];
	}
	for (int k = flank; k <= 2 * n + 1 - flank; k++) {
		// evidence of `flank` samples on either side
		double gain = 2 * sum[k] - sum[k - flank] - sum[k + flank], off = (k - 0.5 - n) * pitch / range;
		double score = gain - 2 * off * off;
		if (fabs(off) <= 1.5 && score > top) {
			top = score;
			best = k;
			*sure = gain / (2 * flank);
		}
	}
	if (best <= flank || best >= 2 * n + 1 - flank || *sure < 0.15)
		return false;
	// between two samples: where the evidence changes sign
	double a = v[best - 1], b = v[best];
	*at = (best - 0.5 - n + (a > 0 && b < 0 ? a / (a - b) - 0.5 : 0)) * pitch;
	return true;
}

static int look(struct head_sight *sights, const struct picture *p, const double m[4][4], const struct camera *camera,
                const struct eye_opening *opening, double range)
{
	double px[OPENING_POINTS][2], middle[2];
	int n = 0;
	for (int i = 0; i < OPENING_POINTS && outline(px, middle, m, camera, opening); i++) {
		const double *a = px[(i + OPENING_POINTS - 2) % OPENING_POINTS], *b = px[(i + 2) % OPENING_POINTS];
		double normal[2] = { b[1] - a[1], a[0] - b[0] }, length = hypot(normal[0], normal[1]), at, sure = 0;
		if (length < 1e-6)
			continue;
		double out = normal[0] * (px[i][0] - middle[0]) + normal[1] * (px[i][1] - middle[1]) < 0 ? -1 : 1;
		for (int k = 0; k < 2; k++)
			normal[k] *= out / length;
		if (!split(&at, &sure, p, px[i], normal, range))
			continue;
		struct head_sight *s = &sights[n++];
		*s = (struct head_sight){ .line = true, .weight = fmin(1, sure * sure) };
		memcpy(s->head, opening->edge[i], sizeof s->head);
		for (int k = 0; k < 2; k++) {
			s->normal[k] = normal[k];
			s->px[k] = px[i][k] + at * normal[k];
		}
	}
	return n;
}

/* Sizes in px were chosen where an opening is so wide. */
static const double usual_px = 253;

double head_find_scale(int width, const struct camera *camera, const double cam_from_head[4][4], const struct eye_opening opening[2])
{
	double scale = fmax(0.5, width / 1280.0);
	for (int e = 0; e < 2; e++) {
		double p[3], across = 0;
		if (!opening[e].open)
			continue;
		head_from(p, cam_from_head, opening[e].center);
		for (int k = 0; k < 3; k++)
			across += pow(opening[e].canthus[1][k] - opening[e].canthus[0][k], 2);
		scale = fmin(scale, camera->focal_px / p[2] * sqrt(across) / usual_px);
	}
	return fmax(scale, 0.1);
}

bool head_find_refine(struct head_found *found, const uint8_t *rgb, int width, int height, const struct camera *camera,
                      const struct eye_opening opening[2], const struct head_find_conf *conf)
{
	struct picture p = { .rgb = rgb, .width = width, .height = height, .scale = head_find_scale(width, camera, found->cam_from_head, opening) };
	double turn = conf->turn_sigma * M_PI / 180;
	struct head_prior prior = { .sigma = { turn, found->seen[0] && found->seen[1] ? conf->yaw_sigma * M_PI / 180 : turn, INFINITY, INFINITY, INFINITY, INFINITY } };
	memcpy(prior.cam_from_head, found->cam_from_head, sizeof prior.cam_from_head);
	found->edge_px = NAN;
	for (int round = 0; round < ROUNDS; round++) {
		struct head_sight sights[2 * OPENING_POINTS];
		double range = p.scale * fmax(5, conf->edge * pow(0.65, round));
		int n = 0;
		learn(&p, found, camera, opening, round < 3 ? 0.25 : 0.1);
		for (int e = 0; e < 2; e++)
			if (found->seen[e])
				n += look(sights + n, &p, found->cam_from_head, camera, &opening[e], range);
		if (n < OPENING_POINTS / 3)
			return false;
		// errors of neighbouring edges are correlated (shadows of lashes)
		for (int i = 0; i < n; i++)
			sights[i].weight *= edge_weight / (p.scale * p.scale);
		double rms = head_pose_fit(found->cam_from_head, n, sights, camera, fmax(1.5 * fmin(1, p.scale), 0.3 * range), &prior);
		if (isnan(rms))
			return false;
		found->edge_px = rms;
	}
	return true;
}
