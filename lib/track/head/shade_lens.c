#include "track/head/shade_lens.h"

#include <math.h>
#include <string.h>

#include "math/chol.h"

enum { LENSES = 9, ROUNDS = 12, TERMS = 3 };
static const double pitch = 0.2;  // of the lenses' logarithms

/* Lays the head on under a lens. m: where to begin, and the pose found. Returns false where shading does not tell it. */
static bool lay(struct head_form *form, double m[4][4], const struct camera *camera, const struct head_shape *shape, const struct head_picture *picture, int n,
                const struct head_sight *s, double robust, const struct head_prior *prior, const struct head_shade_conf *conf)
{
	struct head_prior with = *prior;
	for (int i = 0; i < ROUNDS; i++) {
		if (!head_shade(form, shape, picture, camera, (const double(*)[4])m, conf))
			return false;
		with.form = form;
		if (isnan(head_pose_fit(m, n, s, camera, robust, &with)))
			return false;
	}
	return true;
}

bool head_shade_lens(struct head_lens *lens, const struct head_shape *shape, const struct head_picture *picture, const struct camera *camera,
                     const double cam_from_head[4][4], int n, const struct head_sight *sights, double robust, const struct head_prior *prior,
                     const struct head_shade_conf *conf)
{
	double a[TERMS][TERMS] = { { 0 } }, b[TERMS] = { 0 }, patches = 0;
	const double away = head_lens_away(cam_from_head, n, sights);
	for (int k = 0; k < LENSES; k++) {
		const double x = pitch * (k - LENSES / 2), row[TERMS] = { 1, x, x * x };
		struct camera other = *camera;
		struct head_form form;
		double m[4][4];
		memcpy(m, cam_from_head, sizeof m);
		other.focal_px = camera->focal_px / exp(x);
		m[2][3] += away * (exp(-x) - 1);
		if (!lay(&form, m, &other, shape, picture, n, sights, robust, prior, conf))
			return false;
		patches = k == LENSES / 2 ? head_shade_patches(&form, shape, conf) : patches;
		for (int i = 0; i < TERMS; i++) {
			b[i] += row[i] * 2 * log(form.off);  // for a patch: skin that scatters by an unknown amount
			for (int j = 0; j < TERMS; j++)
				a[i][j] += row[i] * row[j];
		}
	}
	if (!chol_solve(TERMS, TERMS, &a[0][0], b) || !(b[2] > 0))
		return false;
	// cost is (x - middle)^2 / sigma^2; a bottom beyond the lenses tried says little but that it is not near
	const double reach = pitch * (LENSES / 2), middle = fmax(-reach, fmin(reach, -b[1] / (2 * b[2])));
	*lens = (struct head_lens){ exp(middle), exp(middle) / sqrt(patches * b[2]) };
	return true;
}
