#include "anatomy/eye.h"

#include <math.h>

struct cornea eye_cornea(const struct eye *eye)
{
	return (struct cornea){ .R = eye->cornea_radius, .p = eye->cornea_asphericity, .n = eye->index,
	                        .rim = eye->limbus_radius, .two_surface = eye->two_surface,
	                        .R_post = eye->post_radius, .p_post = eye->post_asphericity,
	                        .thickness = eye->thickness, .n_cornea = eye->cornea_index };
}

double eye_limbus_depth(const struct eye *eye)
{
	struct cornea cornea = eye_cornea(eye);
	return cornea_depth(&cornea, eye->limbus_radius);
}

bool eye_check(const struct eye *eye, struct err *err)
{
	double depth = eye_limbus_depth(eye);
	if (!isfinite(depth))
		return err_set(err, "eye.limbus_radius_mm = %g: the cornea (R %g mm, p %g) is not that wide",
		               eye->limbus_radius, eye->cornea_radius, eye->cornea_asphericity);
	if (eye->two_surface && !(eye->iris_depth > eye->thickness))
		return err_set(err, "eye.iris_depth_mm = %g: must be behind the cornea, %g mm thick", eye->iris_depth,
		               eye->thickness);
	// The iris must lie behind the cornea's surface over all of its radius to be seen through it.
	if (eye->iris_depth < 0.6 * depth)
		return err_set(err, "eye.iris_depth_mm = %g: in front of the limbus plane, %.2f mm", eye->iris_depth, depth);
	return true;
}
