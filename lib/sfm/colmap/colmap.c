#include "sfm/colmap/colmap.h"

#include <stdlib.h>

static const struct {
	const char *name;
	int params;
} kinds[COLMAP_KINDS] = {
	[COLMAP_SIMPLE_PINHOLE] = { "SIMPLE_PINHOLE", 3 },
	[COLMAP_PINHOLE] = { "PINHOLE", 4 },
	[COLMAP_SIMPLE_RADIAL] = { "SIMPLE_RADIAL", 4 },
	[COLMAP_RADIAL] = { "RADIAL", 5 },
	[COLMAP_OPENCV] = { "OPENCV", 8 },
	[COLMAP_OPENCV_FISHEYE] = { "OPENCV_FISHEYE", 8 },
	[COLMAP_FULL_OPENCV] = { "FULL_OPENCV", 12 },
	[COLMAP_FOV] = { "FOV", 5 },
	[COLMAP_SIMPLE_RADIAL_FISHEYE] = { "SIMPLE_RADIAL_FISHEYE", 4 },
	[COLMAP_RADIAL_FISHEYE] = { "RADIAL_FISHEYE", 5 },
	[COLMAP_THIN_PRISM_FISHEYE] = { "THIN_PRISM_FISHEYE", 12 },
};

const char *colmap_kind_name(enum colmap_kind kind)
{
	return kinds[kind].name;
}

int colmap_kind_params(enum colmap_kind kind)
{
	return kinds[kind].params;
}

void colmap_free(struct colmap_model *model)
{
	for (int i = 0; i < model->n_images; i++) {
		free(model->images[i].name);
		free(model->images[i].seen);
	}
	for (int i = 0; i < model->n_points; i++)
		free(model->points[i].track);
	free(model->cameras);
	free(model->images);
	free(model->points);
	*model = (struct colmap_model){ 0 };
}
