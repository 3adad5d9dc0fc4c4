#include "tests/lib/scenes/ridged.h"

#include <math.h>
#include <stdio.h>

#include "tests/lib/scenes/painted.h"

static const struct eye eye = { 7.8, 0.75, 1.336, 5.85, 1, 3.3, false, 6.5, 0.75, 0.55, 1.376 };

struct scene_conf ridged_conf(int steps, int quadrature, int path)
{
	return (struct scene_conf){ .map_size = 1024, .search = 8, .shadow = 8, .steps = steps, .quadrature = quadrature,
		                        .path = path, .bands = 4, .detail = 1, .own_width = 0.2, .ratio_most = 2.5, .ratio_chroma = 1.5, .limbus_width = 0.4, .sclera_radius = 11.8,
		                        .sclera_rgb = { 0.7, 0.65, 0.6 }, .vein_density = 1, .veins_px = 512, .seed = 1 };
}

static void fibres(float rgb[3], double x, double y)
{
	double r = hypot(x, y), t = atan2(y, x), v = 0.3 + 0.12 * sin(40 * t + 3 * sin(2 * r)) * sin(5 * r);
	rgb[0] = (float)(0.7 * v);
	rgb[1] = (float)(0.9 * v);
	rgb[2] = (float)v;
}

static double ridges(double x, double y)
{
	double r = hypot(x, y), t = atan2(y, x);
	return 0.05 * sin(40 * t + 3 * sin(2 * r)) * sin(5 * r) + 0.06 * exp(-(r - 3) * (r - 3) / 0.1);
}

bool ridged_scene(struct scene *scene, const struct scene_conf *conf)
{
	struct err err = { 0 };
	if (painted_scene(scene, 1024, &eye, conf, fibres, ridges, 1.6, &err))
		return true;
	fprintf(stderr, "a ridged eye: %s\n", err.msg);
	return false;
}

struct envmap ridged_room(void)
{
	struct envmap_box box[2] = { { { -0.48, -0.6, -0.64 }, { 0.15, 0.2 }, { 25, 25, 25 }, 0 },
		                         { { 0.7, -0.1, -0.7071 }, { 0.1, 0.2 }, { 10, 10, 11 }, 0 } };
	struct envmap env = envmap_room(128, (double[3]){ 0.6, 0.6, 0.7 }, (double[3]){ 0.2, 0.2, 0.2 }, 0.5, 2, box);
	envmap_normalise(&env);
	return env;
}
