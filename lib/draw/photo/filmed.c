#include "draw/photo/filmed_impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/image.h"
#include "iris/iris_map.h"
#include "math/rising.h"
#include "math/stats.h"
#include "math/vec.h"

enum { NODE = 8, BRIGHT = 250, WHITE_LEAST = 60, PX_LEAST = 24, COMMON_LEAST = 200 };
static const double upper_mm[] = { 0.4, 1.2 }, lower_mm[] = { 0.3, 0.9 };  // from a lid's margin: lashes and its shadow end between
static const double blur_px = 1.2;         // sigma: what a film's colours, of half its size, and a lens leave
static const double rim_px[] = { 2, 4.5 };  // from the limbus: the sclera's light is mixed into what lies further out
static const double tilt_sigma = 0.26;     // rad between axis and line of sight, over which an iris is seen less well: foreshortened, through a steeper cornea
static const double glint_times[] = { 3, 2 };  // as bright as the middle, and as four fifths, of the iris at the same radius: a light that the cornea mirrors
/* Between the axes of two views, rad, over which what they show comes to differ; what is left of a view far from the first one, and of one that cannot be laid onto it. */
static const double turn_sigma = 0.1, least_weight = 0.1, astray_weight = 0.005;
static const double steep = 0.5;           // cosine to the axis at which an iris is no longer looked at
static const double sclera_rings[] = { 1.15, 1.55 };  // limbus radii, between which sclera is looked for
/* Of the sclera that is seen, as of a face (draw/complexion): the brighter but for lights mirrored there, and of that what has the fewest vessels over it. */
static const double white_bright[] = { 0.65, 0.92 }, white_bare = 0.25;
static const double share_least = 0.3;     // of an iris: less is no eye to look at
static const double whole_share = 0.88;    // of the limbus' radius: what a film can show of its iris
static const double within = 0.25;         // ln of luminance from the middle of what frames show: the same thing
static const double enough = 1.5;          // frames that show a place well
static const double step_least = 0.35;     // ln by which an iris is brighter than its pupil, or the pupil is not seen

struct filmed *filmed_new(const struct eye *eye, double sclera_radius, const double sclera_rgb[3])
{
	struct filmed *f = mem_new(1, sizeof *f);
	*f = (struct filmed){ .eye = *eye, .sclera_radius = sclera_radius, .extent = 1.05 * eye->limbus_radius };
	memcpy(f->sclera_rgb, sclera_rgb, sizeof f->sclera_rgb);
	for (int i = 0; i < 256; i++)
		f->linear[i] = linear_from_srgb((float)i / 255);
	return f;
}

void filmed_free(struct filmed *f)
{
	for (int i = 0; f && i < f->n; i++)
		free(f->view[i].rgb);
	free(f);
}

/* Height of a margin at x, px; NAN beside it. */
static double margin_at(const float (*margin)[2], int n, double x)
{
	for (int i = 0; i + 1 < n; i++) {
		const double a = (double)margin[i][0], b = (double)margin[i + 1][0];
		if ((a <= x && x < b) || (b < x && x <= a))
			return (double)margin[i][1] + (x - a) / (b - a) * (double)(margin[i + 1][1] - margin[i][1]);
	}
	return NAN;
}

/* Width of the limbus, px. */
static double width_of(const struct filmed *f, const struct fit *fit)
{
	const double depth = eye_limbus_depth(&f->eye), r = f->eye.limbus_radius;
	double a[2], b[2], widest = 0;
	for (int i = 0; i < 8; i++) {
		const double x = r * cos(i * M_PI / 8), y = r * sin(i * M_PI / 8);
		if (fit_project(a, fit, (double[]){ x, y, depth }) && fit_project(b, fit, (double[]){ -x, -y, depth }))
			widest = fmax(widest, hypot(a[0] - b[0], a[1] - b[1]));
	}
	return widest;
}

/* 0 under a lid, 1 well off them. */
static double open_at(const struct filmed_view *v, double px_per_mm, double x, double y)
{
	const double below = y - margin_at(v->upper, v->n, x), above = margin_at(v->lower, v->n, x) - y;
	if (!(below > 0 && above > 0))  // NAN, too
		return 0;
	return rising(below / px_per_mm, upper_mm[0], upper_mm[1]) * rising(above / px_per_mm, lower_mm[0], lower_mm[1]);
}

/* sRGB at a place; false where it is outside or overexposed. */
static bool colour_at(double rgb[3], const struct filmed_view *v, double x, double y)
{
	const int w = v->fit->width, i = (int)floor(x - 0.5), j = (int)floor(y - 0.5);
	const double fx = x - 0.5 - i, fy = y - 0.5 - j;
	if (!(i >= 0 && j >= 0 && i + 1 < w && j + 1 < v->fit->height))
		return false;
	for (int c = 0; c < 3; c++) {
		const uint8_t *p = v->rgb + 3 * ((long)j * w + i) + c;
		if (p[0] > BRIGHT || p[3] > BRIGHT || p[3L * w] > BRIGHT || p[3L * w + 3] > BRIGHT)
			return false;
		rgb[c] = (1 - fy) * ((1 - fx) * p[0] + fx * p[3]) + fy * ((1 - fx) * p[3L * w] + fx * p[3L * w + 3]);
	}
	return true;
}

static double luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/* White by the sclera on both sides of the iris. */
static void white_of(double white[3], const struct filmed *f, const struct filmed_view *v, double px_per_mm)
{
	enum { RADII = 12, ANGLES = 60, ALL = 2 * RADII * ANGLES };
	double (*rgb)[3] = mem_new(ALL, sizeof *rgb), *light = mem_new(ALL, sizeof *light), *sorted = mem_new(ALL, sizeof *sorted), sum[3] = { 0 };
	const double r2 = f->sclera_radius * f->sclera_radius, limbus = f->eye.limbus_radius, depth = eye_limbus_depth(&f->eye), middle = depth + sqrt(fmax(r2 - limbus * limbus, 0));
	int n = 0, many = 0, bare = 0;
	for (int i = 0; i < ALL; i++) {
		const double rho = limbus * (sclera_rings[0] + (sclera_rings[1] - sclera_rings[0]) * (i / 2 % RADII + 0.5) / RADII);
		const double turn = ((i / 2 / RADII + 0.5) / ANGLES - 0.5) * M_PI / 2 + (i % 2 ? M_PI : 0);
		double px[2], srgb[3];
		if (rho * rho >= r2 || !fit_project(px, v->fit, (double[]){ rho * cos(turn), rho * sin(turn), middle - sqrt(r2 - rho * rho) }) || open_at(v, px_per_mm, px[0], px[1]) < 0.5
		    || !colour_at(srgb, v, px[0], px[1]))
			continue;
		for (int c = 0; c < 3; c++)
			rgb[n][c] = (double)linear_from_srgb((float)srgb[c] / 255);
		light[n] = sorted[n] = luminance(rgb[n]);
		n++;
	}
	const double low = n ? stats_quantile(n, sorted, white_bright[0]) : 0, high = n ? stats_quantile(n, sorted, white_bright[1]) : 0;
	double all = 0;
	for (int i = 0; i < n; i++)
		if (light[i] >= low && light[i] <= high) {
			memmove(rgb[many], rgb[i], sizeof *rgb);
			all += luminance(rgb[many]);
			sorted[many] = light[many] = rgb[many][0] / fmax(rgb[many][1], 1e-9);
			many++;
		}
	const double red = many ? stats_quantile(many, sorted, white_bare) : 0;
	for (int i = 0; i < many; i++)
		if (light[i] <= red) {
			for (int c = 0; c < 3; c++)
				sum[c] += rgb[i][c];
			bare++;
		}
	for (int c = 0; c < 3; c++)
		white[c] = n >= WHITE_LEAST && bare ? sum[c] * all / many / fmax(luminance(sum), 1e-12) : 0;
	free(rgb);
	free(light);
	free(sorted);
}

static double place_of(double at[2], const struct filmed *f, int texel)
{
	at[0] = (texel % SIDE + 0.5) * 2 * f->extent / SIDE - f->extent;
	at[1] = (texel / SIDE + 0.5) * 2 * f->extent / SIDE - f->extent;
	return hypot(at[0], at[1]);
}

/* Lights that the cornea mirrors, and what lies beside them. */
static void drop_glints(struct filmed_one *one, const struct filmed *f)
{
	enum { RINGS = 32, BESIDE = 2 };
	double *of[RINGS], level[RINGS], at[2];
	int n[RINGS] = { 0 };
	uint8_t *bright = mem_new(TEXELS, 1);
	const int beside = (int)ceil(BESIDE / one->px_per_mm / (2 * f->extent / SIDE));
	for (int r = 0; r < RINGS; r++)
		of[r] = mem_new(TEXELS / RINGS * 4, sizeof **of);
	for (int i = 0; i < TEXELS; i++) {
		const int r = (int)(place_of(at, f, i) / f->extent * RINGS);
		if (one->rgb[i][3] && r < RINGS && n[r] < TEXELS / RINGS * 4)
			of[r][n[r]++] = (double)f->linear[one->rgb[i][1]];
	}
	for (int r = 0; r < RINGS; r++) {
		level[r] = n[r] ? fmax(glint_times[0] * stats_median(n[r], of[r]), glint_times[1] * stats_quantile(n[r], of[r], 0.8)) : 1;
		free(of[r]);
	}
	for (int i = 0; i < TEXELS; i++) {
		const int r = (int)(place_of(at, f, i) / f->extent * RINGS);
		// In a pupil, which is black, the iris beside it tells what is bright.
		bright[i] = one->rgb[i][3] && r < RINGS && (double)f->linear[one->rgb[i][1]] > fmax(level[r], level[RINGS / 2]);
	}
	for (int i = 0; i < TEXELS; i++)
		for (int k = -beside; bright[i] && k <= beside; k++)
			for (int j = -beside; j <= beside; j++) {
				const int y = i / SIDE + k, x = i % SIDE + j;
				if (y >= 0 && x >= 0 && y < SIDE && x < SIDE)
					one->rgb[y * SIDE + x][3] = 0;
			}
	free(bright);
}

void filmed_add(struct filmed *f, const struct filmed_view *v)
{
	const struct iris_view view = iris_view_new(v->fit, &f->eye);
	double center[3];
	fit_camera_in_eye(center, v->fit);
	const double cosine = -center[2] / fmax(vec_norm(center), 1e-9), per_mm = iris_view_px_per_mm(&view), width = width_of(f, v->fit);
	if (f->n == FILMED_VIEWS || !(cosine > steep) || !(width >= PX_LEAST))
		return;
	const double tilt = acos(fmin(cosine, 1)) / tilt_sigma, straight = exp(-0.5 * tilt * tilt);
	struct filmed_one *one = &f->view[f->n];
	struct iris_map map = iris_map_new(&view, SIDE, f->extent, f->eye.limbus_radius, &(struct iris_map_conf){ .method = IRIS_LATTICE, .node = NODE });
	one->px_per_mm = per_mm;
	one->px = width;
	vec_unit(one->axis, center);
	one->rgb = mem_new(TEXELS, sizeof *one->rgb);
	memcpy(one->a, (double[2][3]){ { 1, 0, 0 }, { 0, 1, 0 } }, sizeof one->a);
	white_of(one->white, f, v, per_mm);
	if (one->white[1] > 0)
		f->n++;
	else {
		free(one->rgb);
		iris_map_free(&map);
		return;
	}
#pragma omp parallel for schedule(static)
	for (int i = 0; i < TEXELS; i++) {
		double rgb[3];
		// Where the path leaves the cornea, not where it begins: beyond the limbus the white is seen, some tenths of a millimetre before the iris ends.
		const double off = (f->eye.limbus_radius - (double)map.rim[i]) * width / (2 * f->eye.limbus_radius);
		if (!(off > 0) || !isfinite(map.u[i] + map.v[i]) || !colour_at(rgb, v, (double)map.u[i], (double)map.v[i]))
			continue;
		const double weight = open_at(v, per_mm, (double)map.u[i], (double)map.v[i]) * rising(off, rim_px[0], rim_px[1]) * straight;
		for (int c = 0; c < 3; c++)
			one->rgb[i][c] = (uint8_t)lrint(rgb[c]);
		one->rgb[i][3] = (uint8_t)lrint(255 * weight);
	}
	iris_map_free(&map);
	drop_glints(one, f);
}

/* What a view shows at a place of the first one's map: linear, and its weight. */
static double colour_of(double rgb[3], const struct filmed *f, const struct filmed_one *one, int texel)
{
	double at[2], to[2], sum = 0;
	place_of(at, f, texel);
	for (int k = 0; k < 2; k++)
		to[k] = (one->a[k][0] * at[0] + one->a[k][1] * at[1] + one->a[k][2] + f->extent) / (2 * f->extent) * SIDE - 0.5;
	const int x = (int)floor(to[0]), y = (int)floor(to[1]);
	rgb[0] = rgb[1] = rgb[2] = 0;
	if (x < 0 || y < 0 || x + 1 >= SIDE || y + 1 >= SIDE)
		return 0;
	for (int k = 0; k < 4; k++) {
		const uint8_t *p = one->rgb[(y + k / 2) * SIDE + x + k % 2];
		const double w = (k % 2 ? to[0] - x : 1 - to[0] + x) * (k / 2 ? to[1] - y : 1 - to[1] + y);
		if (!p[3])
			return 0;
		sum += w * p[3] / 255;
		for (int c = 0; c < 3; c++)
			rgb[c] += w * (double)f->linear[p[c]];
	}
	return sum;
}

/* Exposure of a frame over that of the first: the median over what both show of the iris; where that is little, their scleras'. */
static double gain_of(const struct filmed *f, int view)
{
	double *ratio = mem_new(TEXELS, sizeof *ratio), a[3], b[3];
	int n = 0;
	for (int i = 0; i < TEXELS; i += 7)
		if (colour_of(a, f, &f->view[0], i) > 0 && colour_of(b, f, &f->view[view], i) > 0)
			ratio[n++] = luminance(b) / fmax(luminance(a), 1e-4);
	const double gain = n >= COMMON_LEAST ? stats_median(n, ratio) : luminance(f->view[view].white) / luminance(f->view[0].white);
	free(ratio);
	return fmin(fmax(gain, 0.05), 20);
}

/* The middle of what frames show at a texel, ln over white; returns its weight, 0..1. */
static float middle_of(float ln[3], const struct filmed *f, const double *gain, const double white[3], int texel)
{
	double rgb[FILMED_VIEWS][3], w[FILMED_VIEWS], all = 0, light[FILMED_VIEWS], weight = 0, sum[3] = { 0 }, near = 0;
	int n = 0, order[FILMED_VIEWS];
	for (int k = 0; k < f->n; k++)
		if ((w[n] = colour_of(rgb[n], f, &f->view[k], texel)) > 0.05) {
			all += w[n];
			w[n] *= w[n] * f->view[k].near;  // what the first shows badly is left to others before it ends
			for (int c = 0; c < 3; c++)
				rgb[n][c] /= gain[k];
			light[n] = log(fmax(luminance(rgb[n]), 1e-5));
			weight += w[n];
			int at = n++;
			for (; at > 0 && light[order[at - 1]] > light[n - 1]; at--)
				order[at] = order[at - 1];
			order[at] = n - 1;
		}
	if (!n)
		return 0;
	int middle = 0;
	for (double below = w[order[0]]; below < 0.5 * weight && middle + 1 < n; below += w[order[middle]])
		middle++;
	for (int k = 0; k < n; k++)
		if (fabs(light[k] - light[order[middle]]) <= within) {
			for (int c = 0; c < 3; c++)
				sum[c] += w[k] * rgb[k][c];
			near += w[k];
		}
	for (int c = 0; c < 3; c++)
		ln[c] = (float)log(fmax(sum[c] / near / white[c], 1e-4));
	return (float)fmin(all / enough, 1);
}

/* Radius at which rings step up the most, seen from the middle; 0 where they hardly do. */
static double pupil_of(const struct filmed *f, const struct scene_seen *s)
{
	enum { RINGS = 120 };
	static const double least_mm = 0.7, most_share = 0.75, beside_mm = 0.5;
	const double mm = s->limbus / RINGS;
	const int beside = (int)lrint(beside_mm / mm);
	double ring[RINGS], *value = mem_new(TEXELS, sizeof *value), best = step_least, at = 0;
	bool known[RINGS];
	for (int r = 0; r < RINGS; r++) {
		int n = 0;
		for (int turn = 0; turn < 360; turn++) {
			const double x = (r + 0.5) * mm * cos(turn * M_PI / 180), y = (r + 0.5) * mm * sin(turn * M_PI / 180);
			const int i = (int)((y + f->extent) / (2 * f->extent) * SIDE) * SIDE + (int)((x + f->extent) / (2 * f->extent) * SIDE);
			if (s->weight[i] > 0)
				value[n++] = 0.2126 * (double)s->ln[i][0] + 0.7152 * (double)s->ln[i][1] + 0.0722 * (double)s->ln[i][2];
		}
		known[r] = n > 30;
		ring[r] = known[r] ? stats_median(n, value) : 0;
	}
	for (int r = (int)(least_mm / mm); r < most_share * RINGS && r + beside < RINGS; r++) {
		double out = 0, in = 0, n_in = 0, n_out = 0;
		for (int k = 0; k < beside; k++) {
			if (known[r + k]) {
				out += ring[r + k];
				n_out++;
			}
			if (r - 1 - k >= 0 && known[r - 1 - k]) {
				in += ring[r - 1 - k];
				n_in++;
			}
		}
		const double step = n_in && n_out ? out / n_out - in / n_in : 0;
		if (step > best) {
			best = step;
			at = r * mm;
		}
	}
	free(value);
	return at;
}

/* White in the exposure of the first frame: the median over the frames, each colour. */
static void common_white(double white[3], const struct filmed *f, const double *gain)
{
	for (int c = 0; c < 3; c++) {
		double of[FILMED_VIEWS];
		for (int k = 0; k < f->n; k++)
			of[k] = f->view[k].white[c] / gain[k];
		white[c] = stats_median(f->n, of) / f->sclera_rgb[c];
	}
}

double filmed_share(const struct filmed *f)
{
	double seen = 0, all = 0, at[2];
	for (int i = 0; i < TEXELS; i++)
		if (place_of(at, f, i) < f->eye.limbus_radius) {
			bool any = false;
			for (int k = 0; k < f->n && !any; k++)
				any = f->view[k].rgb[i][3] > 0;
			seen += any;
			all++;
		}
	return seen / all;
}

bool filmed_make(struct scene_seen *s, struct filmed_report *report, struct filmed *f, struct err *err)
{
	double gain[FILMED_VIEWS], white[3], seen = 0, all = 0, per_mm = 0;
	*s = (struct scene_seen){ .extent = f->extent, .limbus = f->eye.limbus_radius };
	*report = (struct filmed_report){ .views = f->n };
	if (!f->n)
		return err_set(err, "no frame shows an iris of %d px or more and white beside it", PX_LEAST);
	filmed_align(f);
	for (int k = 0; k < f->n; k++) {
		const double turn = acos(fmin(vec_dot(f->view[k].axis, f->view[0].axis), 1)) / turn_sigma;
		f->view[k].near = f->view[k].astray ? astray_weight : fmax(exp(-0.5 * turn * turn), least_weight);
	}
	for (int k = 0; k < f->n; k++) {
		gain[k] = k ? gain_of(f, k) : 1;
		per_mm += f->view[k].px_per_mm / f->n;
		report->px += f->view[k].px / f->n;
	}
	common_white(white, f, gain);
	s->ln = mem_new(TEXELS, sizeof *s->ln);
	s->weight = mem_new(TEXELS, sizeof *s->weight);
	s->finest = blur_px / per_mm;
#pragma omp parallel for schedule(dynamic, 1024)
	for (int i = 0; i < TEXELS; i++)
		s->weight[i] = middle_of(s->ln[i], f, gain, white, i);
	for (int i = 0; i < TEXELS; i++) {
		double at[2];
		const bool inside = place_of(at, f, i) < whole_share * s->limbus;
		all += inside;
		seen += inside && s->weight[i] > 0.1f;
	}
	report->share = seen / fmax(all, 1);
	if (report->share < share_least) {
		scene_seen_free(s);
		return err_set(err, "%.0f %% of the iris is seen, less than %.0f %%", 100 * report->share, 100 * share_least);
	}
	s->pupil = pupil_of(f, s);
	return true;
}
