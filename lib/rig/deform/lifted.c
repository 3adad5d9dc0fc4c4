#include "rig/deform/lifted.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/deform/deform.h"
#include "rig/deform/opening.h"
#include "rig/drive.h"

enum { QUARTER = 4 };

/* Mean height of the lower margin over the middle half of the opening at rest, mm; false: there is none. */
static bool height(double *mm, const struct rig *rig, const struct deform_near *near, int side, const float (*x)[3])
{
	const struct deform_opening *rest = &near->rest[side];
	const int inset = (rest->last - rest->first) / QUARTER;
	struct deform_opening now;
	int n = 0;
	deform_open(&now, rig, near, side, x, near->within[side]);
	*mm = 0;
	for (int i = rest->first + inset; i <= rest->last - inset; i++)
		if (i >= now.first && i <= now.last) {
			*mm += now.bottom[i];
			n++;
		}
	*mm /= n ? n : 1;
	return n > 0;
}

void deform_find_lifted(struct deform_near *near, const struct rig *rig)
{
	const int expressions = rig->n_inputs - SKIN_EYE_INPUTS;
	near->lifted = mem_new((size_t)expressions + 1, sizeof *near->lifted);
	if (!expressions)
		return;
	struct deform *deform = deform_new(rig);
	float (*x)[3] = mem_new((size_t)rig->n + 1, sizeof *x);
	double *c = mem_new((size_t)rig->n_inputs + 1, sizeof *c), e[RIG_COMPONENTS], turn[2][3][3], from[2], to;
	bool open[2] = { false };
	deform_rest(deform, x, 0);
	for (int k = -1; k < expressions; k++) {
		drive_look(c, rig, 0, 0, 1);
		if (k >= 0)
			drive_express(c, rig, k, 1, 1);
		rig_components(e, rig, c);
		rig_globes_turned(turn, rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		for (int side = 0; side < 2; side++)
			if (k < 0)
				open[side] = height(&from[side], rig, near, side, (const float(*)[3])x);
			else if (open[side] && height(&to, rig, near, side, (const float(*)[3])x))
				near->lifted[k][side] = to - from[side];
	}
	deform_free(deform);
	free(x);
	free(c);
}

void deform_lifted(double mm[2], const struct deform_near *near, const struct rig *rig, const double *controls)
{
	for (int side = 0; side < 2; side++) {
		mm[side] = 0;
		for (int k = 0; k < rig->n_inputs - SKIN_EYE_INPUTS; k++)
			mm[side] += controls[SKIN_EYE_INPUTS + k] * near->lifted[k][side];
		mm[side] = mm[side] > 0 ? drive_opened(rig, controls, side) * mm[side] : 0;
	}
}
