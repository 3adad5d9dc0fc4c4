#include "rig/deform/clearance.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"

double deform_clearance(const struct rig *rig)
{
	struct deform *deform = deform_new(rig);
	float (*x)[3] = mem_new((size_t)rig->n + 1, sizeof *x);
	double *c = mem_new((size_t)rig->n_inputs + 1, sizeof *c), least = INFINITY;
	static const double vertical[] = { -25, 0, 15 };
	deform_rest(deform, x, 0);
	for (int pose = 0; pose < 27; pose++) {
		double h = 20 * (pose % 3 - 1), v = vertical[pose / 3 % 3], e[RIG_COMPONENTS], turn[2][3][3];
		drive_look(c, rig, h, v, pose / 9 * 0.5);
		rig_components(e, rig, c);
		for (int s = 0; s < 2; s++)
			rig_globe_rotation(turn[s], rig, (double[]){ h * M_PI / 180, v * M_PI / 180, 0 });
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		for (int i = 0; i < rig->n; i++)
			if (!rig_is_globe(rig->part[i]))
				least = fmin(least, rig_globe_distance(rig, rig->side[i], (const double(*)[3])turn[rig->side[i]], x[i]));
	}
	free(x);
	free(c);
	deform_free(deform);
	return least;
}
