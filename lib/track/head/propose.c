#include "track/head/propose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static const double sure = 0.4;                   // score of an iris
static const double apart[2] = { 5, 16 };         // distance of the middles over the radius: 63 mm and 5.9 mm, turned by up to 55 degrees
static const double beside_radii = 3;              // within so many radii an iris is the known one, whose corners and brows are told for irises, too
static const double unlike = 0.8;                 // log of the ratio of the radii: dark irises are told to half their size

static bool is_pair(const struct evidence_region *a, const struct evidence_region *b)
{
	double r = 0.5 * (a->radius + b->radius), d = hypot(a->x - b->x, a->y - b->y) / r;
	return a->score > sure && b->score > sure && d > apart[0] && d < apart[1] && fabs(log(a->radius / b->radius)) < unlike;
}

/* Area of what shows between the lids, in squares of the iris' radius: about 7 of an open eye. */
static double open_of(struct evidence_net *net, const struct photo *photo, const struct evidence_region *r)
{
	struct evidence e;
	struct err none = { 0 };
	double sum = 0;
	if (!evidence_window(&e, net, photo, r->x, r->y, r->radius, &none))
		return 0;
	for (int i = 0; i < e.width * e.height; i++)
		sum += (double)evidence_eye(&e, i);
	sum *= pow(e.scale / r->radius, 2);
	evidence_free(&e);
	return sum;
}

bool head_propose_other(double other[2][2], const double known[2][2], double radius, struct evidence_net *net, const uint8_t *rgb, int width, int height, struct err *err)
{
	struct photo photo = photo_of_bytes(rgb, width, height);
	struct evidence_region region[EVIDENCE_REGIONS];
	int n = 0, beside[EVIDENCE_REGIONS], m = 0;
	bool ok = evidence_find(region, &n, net, &photo, err), found = false;
	free(photo.rgb);
	for (int i = 0; ok && i < n; i++) {
		const struct evidence_region *r = &region[i];
		bool is_known = false;
		for (int k = 0; k < 2; k++)
			is_known = is_known || hypot(r->x - known[k][0], r->y - known[k][1]) < beside_radii * radius;
		if (!is_known && r->score > sure && fabs(log(r->radius / radius)) < log(2))
			beside[m++] = i;
	}
	for (int i = 0; i < m && !found; i++)
		for (int k = i + 1; k < m && !found; k++) {
			const struct evidence_region *a = &region[beside[i]], *b = &region[beside[k]];
			found = fabs(log(a->radius / b->radius)) < unlike;
			if (found)
				memcpy(other, (double[2][2]){ { a->x, a->y }, { b->x, b->y } }, 4 * sizeof(double));
		}
	return found;
}

bool head_propose(struct head_eyes *eyes, struct evidence_net *net, const uint8_t *rgb, int width, int height, struct err *err)
{
	struct photo photo = photo_of_bytes(rgb, width, height);
	struct evidence_region region[EVIDENCE_REGIONS];
	const struct evidence_region *left = 0, *right = 0;
	double best = 0;
	int n = 0;
	bool ok = evidence_find(region, &n, net, &photo, err);
	for (int i = 0; ok && i < n; i++)
		for (int k = i + 1; k < n; k++) {
			const struct evidence_region *a = &region[i], *b = &region[k];
			if (!is_pair(a, b) || fmin(a->score, b->score) <= best)
				continue;
			best = fmin(a->score, b->score);
			left = a->x > b->x ? a : b;
			right = left == a ? b : a;
		}
	if (left)
		*eyes = (struct head_eyes){ { { left->x, left->y }, { right->x, right->y } }, 0.5 * (left->radius + right->radius), best,
			                        fmin(open_of(net, &photo, left), open_of(net, &photo, right)) };
	free(photo.rgb);
	return ok && best > 0;
}
