/* plain_scene: a usual eye with a painted iris, for the renderer's tests. */
#ifndef TESTS_PLAIN_SCENE_H
#define TESTS_PLAIN_SCENE_H
#include "tests/lib/scenes/painted.h"
#include "tests/lib/unit.h"

static const struct eye plain_eye = { 7.8, 0.75, 1.336, 5.85, 1, 3.3, false, 6.5, 0.75, 0.55, 1.376 };
static const double grey[3] = { 1, 1, 1 };

/* Gauss-Legendre of so many steps, every light's table, along every ray. */
static inline struct scene_conf conf_of(int steps)
{
	return (struct scene_conf){ .map_size = 1024, .search = 8, .shadow = 4, .steps = steps, .quadrature = SCENE_GAUSS,
		                        .path = SCENE_PATH_GRID, .bands = 6, .detail = 1, .own_width = 0.2, .ratio_most = 2.5, .ratio_chroma = 1.5, .limbus_width = 0.4,
		                        .sclera_radius = 11.8, .sclera_rgb = { 0.7, 0.65, 0.6 }, .vein_density = 0.2,
		                        .veins_px = 128, .seed = 1 };
}

/* 192 x 192 texels; pupil: radius, mm. scene_free. */
static inline void scene_of(struct scene *scene, const struct eye *eye, const struct scene_conf *conf, painted_colour *colour,
                     painted_height *height, double pupil)
{
	struct err err = { 0 };
	assert_true(painted_scene(scene, 192, eye, conf, colour, height, pupil, &err));
}

static inline void even(float rgb[3], double x, double y)
{
	(void)x;
	(void)y;
	rgb[0] = 0.30f;
	rgb[1] = 0.22f;
	rgb[2] = 0.15f;
}

static inline double bumps(double x, double y)
{
	return 0.06 * sin(5 * x) * cos(4 * y);
}

#endif
