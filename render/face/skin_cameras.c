#include "render/face/skin_cameras.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "optics/camera_rig.h"

static const double frontal_least = 0.34;   // cosine of the way to a camera with the face's own: 70 degrees to all sides
static const double apart_least = 0.9976;   // cosine of 4 degrees: what two views from nearly one place show is the same

/* False: it is not one of views/, or not before the face. */
static bool camera_of(struct face_camera *s, const struct rig_camera *c, struct stage *stage)
{
	*s = (struct face_camera){ .file = c->file, .width = c->width, .height = c->height, .camera = c->camera };
	memcpy(s->cam_from_head, c->cam_from_head, sizeof s->cam_from_head);
	if (!c->has_pose || c->frame >= 0 || strncmp(c->file, "views/", 6) != 0 || strstr(c->file, "..") || !file_exists(stage_path(stage, "%s", c->file)))
		return false;
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			s->way[k] -= c->cam_from_head[i][k] * c->cam_from_head[i][3];
	vec_unit(s->way, s->way);
	return c->width > 0 && c->height > 0 && isfinite(s->way[0] + s->way[1] + s->way[2]) && s->way[2] > frontal_least;
}

/* The one that lies furthest from those taken; of none taken the most frontal. near: out, cosine of its way with the nearest of them. -1: there is none. */
static int furthest(double *near, const struct face_camera *all, int n, const struct face_camera *taken, int n_taken)
{
	int best = -1;
	for (int i = 0; i < n; i++) {
		double here = n_taken ? -1 : -all[i].way[2];
		for (int k = 0; k < n_taken; k++)
			here = fmax(here, vec_dot(all[i].way, taken[k].way));
		if (best < 0 || here < *near) {
			*near = here;
			best = i;
		}
	}
	return best;
}

int skin_cameras(struct face_camera *out, int most, struct stage *stage, struct err *err)
{
	struct camera_rig rig = { 0 };
	int n = 0, taken = 0;
	if (!camera_rig_load(&rig, stage_path(stage, "work/rig.json"), err))
		return 0;
	struct face_camera *all = mem_new((size_t)rig.n + 1, sizeof *all);
	for (int i = 0; i < rig.n; i++)
		n += camera_of(&all[n], &rig.cameras[i], stage);
	while (taken < most) {
		double near = 0;
		const int best = furthest(&near, all, n, out, taken);
		if (best < 0 || (taken && near > apart_least))
			break;
		out[taken] = all[best];
		out[taken].file = mem_str(all[best].file);
		taken++;
	}
	free(all);
	camera_rig_free(&rig);
	if (!taken)
		err_set(err, "no photograph of views/ from before the face has a camera");
	return taken;
}

void skin_cameras_free(struct face_camera *cameras, int n)
{
	for (int i = 0; i < n; i++)
		free(cameras[i].file);
}
