#include "track/gaze/torsion.h"

#include <math.h>
#include <string.h>

#include "math/stats.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"

// Rings between these shares of the limbus' radius: outside a usual pupil, inside the limbus' shade.
static const double INNER = 0.52, OUTER = 0.88;
// Radians searched on either side of the last torsion; correlation from which a frame counts.
static const double REACH = 0.2, ALIKE = 0.35;

struct pattern {
	float value[TORSION_RINGS][TORSION_RAYS_MAX], weight[TORSION_RINGS][TORSION_RAYS_MAX];
};

/* Pixels of the rings of the iris, refracted by the cornea. */
static bool see(float px[][2], int rays, const struct torsion_look *look)
{
	enum { ALL = TORSION_RINGS * TORSION_RAYS_MAX };
	static _Thread_local float x[ALL], y[ALL], z[ALL], kx[ALL], ky[ALL], kz[ALL];
	double size = look->globe->limbus / look->eye->limbus_radius, R[3][3], apex, cam[3], eye[3];
	double across[TORSION_RAYS_MAX], down[TORSION_RAYS_MAX];
	struct cornea cornea = eye_cornea(look->eye);
	int n = 0;
	for (int i = 0; i < rays; i++) {
		across[i] = cos(2 * M_PI * i / rays);
		down[i] = sin(2 * M_PI * i / rays);
	}
	for (int r = 0; r < TORSION_RINGS; r++) {
		double radius = look->eye->limbus_radius * (INNER + (OUTER - INNER) * r / (TORSION_RINGS - 1));
		for (int i = 0; i < rays; i++, n++) {
			x[n] = (float)(radius * across[i]);
			y[n] = (float)(radius * down[i]);
			z[n] = (float)look->eye->iris_depth;
		}
	}
	// The camera as the eye has it: axes of the eye turned to h, v; origin at the apex, z inwards, usual size.
	apex = gaze_plane(look->globe) + size * eye_limbus_depth(look->eye);
	gaze_rotation(R, (double[3]){ look->fick[0], look->fick[1], 0 });
	for (int k = 0; k < 3; k++) {
		cam[k] = -look->globe->center[k];
		for (int i = 0; i < 3; i++)
			cam[k] -= look->view->cam_from_head[i][k] * look->view->cam_from_head[i][3];
	}
	mat_tvec(eye, R, cam);
	double C[3] = { eye[0] / size, eye[1] / size, (apex - eye[2]) / size };
	if (!(C[2] < -5))
		return false;
	lightpath_batch_point(n, x, y, z, C, kx, ky, kz, NULL, &cornea, 3);
	for (int k = 0; k < n; k++) {
		double p[2];
		if (!gaze_pixel_of(p, look->globe, look->view, R, (double[3]){ size * kx[k], size * ky[k], apex - size * kz[k] }))
			return false;
		px[k][0] = (float)p[0];
		px[k][1] = (float)p[1];
	}
	return true;
}

/* Subtracts the running mean along the ring (a twelfth of a turn) and divides by the robust spread; outliers (reflections) and
 * hidden parts get no weight. */
static void flatten(struct pattern *pattern, int r, int rays)
{
	double sum[2 * TORSION_RAYS_MAX + 1], weight[2 * TORSION_RAYS_MAX + 1], size[TORSION_RAYS_MAX];
	float *v = pattern->value[r], *w = pattern->weight[r], out[TORSION_RAYS_MAX];
	int half = rays / 24, m = 0;
	sum[0] = weight[0] = 0;
	for (int i = 0; i < 2 * rays; i++) {
		sum[i + 1] = sum[i] + w[i % rays] * v[i % rays];
		weight[i + 1] = weight[i] + w[i % rays];
	}
	for (int i = 0; i < rays; i++) {
		int a = (i >= half ? i : i + rays) - half, b = a + 2 * half + 1;
		double have = weight[b] - weight[a];
		if (w[i] > 0 && have < half)
			w[i] = 0;
		out[i] = w[i] > 0 ? v[i] - (float)((sum[b] - sum[a]) / have) : 0;
		if (w[i] > 0)
			size[m++] = fabs((double)out[i]);
	}
	double usual = m > 8 ? 1.4826 * stats_median(m, size) + 0.5 : 1;
	for (int i = 0; i < rays; i++) {
		v[i] = out[i] / (float)usual;
		if (fabsf(v[i]) > 4)
			w[i] = 0, v[i] = 0;
	}
}

static double read_pattern(struct pattern *pattern, int rays, const struct torsion_look *look)
{
	static _Thread_local float px[TORSION_RINGS * TORSION_RAYS_MAX][2];
	double seen = 0;
	if (!see(px, rays, look))
		return 0;
	for (int r = 0; r < TORSION_RINGS; r++) {
		for (int i = 0; i < rays; i++) {
			double p[2] = { px[r * rays + i][0], px[r * rays + i][1] };
			bool inside = p[0] > 1 && p[1] > 1 && p[0] < look->luma->width - 1 && p[1] < look->luma->height - 1
			              && (!look->seen || look->seen(look->ctx, p));
			pattern->weight[r][i] = inside;
			pattern->value[r][i] = inside ? (float)luma_at(look->luma, p[0], p[1]) : 0;
			seen += inside;
		}
		flatten(pattern, r, rays);
	}
	return seen / (TORSION_RINGS * rays);
}

/* Correlation of the pattern turned back by `shift` rays with the mean. */
static double alike(const struct gaze_torsion *state, const struct pattern *pattern, int shift, double *used)
{
	double fr = 0, ff = 0, rr = 0;
	int rays = state->rays;
	*used = 0;
	for (int r = 0; r < TORSION_RINGS; r++) {
		for (int i = 0; i < rays; i++) {
			int j = i + shift;
			j -= j >= rays ? rays : j < 0 ? -rays : 0;
			float w = pattern->weight[r][j] * (state->weight[r][i] > 0), f = pattern->value[r][j], m = state->mean[r][i];
			fr += w * f * m;
			ff += w * f * f;
			rr += w * m * m;
			*used += w;
		}
	}
	return fr / sqrt(ff * rr + 1e-9);
}

static void remember(struct gaze_torsion *state, const struct pattern *pattern, double turn)
{
	int rays = state->rays;
	double at = turn / (2 * M_PI) * rays, whole = floor(at), f = at - whole;
	for (int r = 0; r < TORSION_RINGS; r++) {
		for (int i = 0; i < rays; i++) {
			int a = (((i + (int)whole) % rays) + rays) % rays, b = (a + 1) % rays;
			float w = pattern->weight[r][a] * pattern->weight[r][b];
			if (!(w > 0))
				continue;
			float v = (float)((1 - f) * pattern->value[r][a] + f * pattern->value[r][b]);
			state->weight[r][i] = fminf(state->weight[r][i] + 1, 200);
			state->mean[r][i] += (v - state->mean[r][i]) / state->weight[r][i];
		}
	}
	state->frames++;
}

bool gaze_torsion(double *torsion, double *sigma, struct gaze_torsion *state, const struct torsion_look *look,
                  double first)
{
	struct pattern pattern;
	if (state->rays < 16 || read_pattern(&pattern, state->rays, look) < 0.2)
		return false;
	double ray = 2 * M_PI / state->rays;
	if (state->frames == 0) {
		// Ray i of the mean is ray i of an eye without torsion.
		state->last = first;
		remember(state, &pattern, first);
		*torsion = first;
		*sigma = 0.01;
		return true;
	}
	int middle = (int)lround(state->last / ray), reach = (int)ceil(REACH / ray), best = 0;
	double score[2 * TORSION_RAYS_MAX + 1], used = 0, all = TORSION_RINGS * state->rays;
	for (int k = -reach; k <= reach; k++) {
		score[k + reach] = alike(state, &pattern, middle + k, &used);
		if (score[k + reach] > score[best] || k == -reach)
			best = k + reach;
	}
	double top = score[best];
	if (top < ALIKE || used < 0.15 * all || best == 0 || best == 2 * reach)
		return false;
	double bend = score[best - 1] - 2 * top + score[best + 1];
	double off = bend < 0 ? 0.5 * (score[best - 1] - score[best + 1]) / bend : 0;
	*torsion = (middle + best - reach + off) * ray;
	// Neighbouring samples share pixels: one in twelve is independent.
	*sigma = ray * sqrt((1 - top * top) / fmax(1e-6, -bend * top * used / 12)) + 1e-3;
	state->last = *torsion;
	if (top > 0.5)
		remember(state, &pattern, *torsion);
	return true;
}
