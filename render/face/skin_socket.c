/* Whether a fitted eye is of the size that the character's eyeballs have: pictures and exports scale it to them. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/face/skin.h"

char *skin_socket_says(const char *name, const double socket[2], const struct render_conf *conf)
{
	const double ball = conf->scene.sclera_radius, left = socket[0] / ball, right = socket[1] / ball;
	if (fmax(fabs(left - 1), fabs(right - 1)) <= conf->socket_share)
		return 0;
	return mem_printf("targets/%s: its eyeballs have radii of %.1f mm (left) and %.1f mm (right), the fitted eye %.1f mm: the eye is drawn %.2f and %.2f times as large as it is; "
	                  "target.%s.unit_mm says another scale, render.socket_share what may pass", name, socket[0], socket[1], ball, left, right, name);
}
