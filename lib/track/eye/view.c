/* An eyeball as a frame shows it. */
#include <math.h>
#include <string.h>

#include "track/eye/eye_track_impl.h"

void eye_view(struct gaze_view *view, const struct eye_scene *scene, const double cam_from_head[3][4])
{
	view->camera = scene->camera;
	memcpy(view->cam_from_head, cam_from_head, sizeof(double[3][4]));
	for (int k = 0; k < 4; k++)
		view->cam_from_head[3][k] = k == 3;
}

double eye_scale(const struct gaze_globe *globe, const struct gaze_view *view)
{
	double a[2], b[2], z = globe->radius;
	if (!gaze_pixel(a, globe, view, (double[3]){ 0 }, (double[3]){ 0, -1, z })
	    || !gaze_pixel(b, globe, view, (double[3]){ 0 }, (double[3]){ 0, 1, z }))
		return NAN;
	return 0.5 * hypot(b[0] - a[0], b[1] - a[1]);
}
