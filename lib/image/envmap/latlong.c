/* The latitude-longitude grid: direction and solid angle of its pixels, and a coarser copy of a map. */
#include <math.h>

#include "image/envmap/impl.h"

void envmap_dir(double dir[3], double u, double v)
{
	double polar = v * M_PI, turn = (u - 0.5) * 2 * M_PI;
	dir[0] = -sin(polar) * sin(turn);
	dir[1] = -cos(polar);
	dir[2] = -sin(polar) * cos(turn);
}

struct image envmap_coarse(const struct image *map, int rows)
{
	rows = map->height < rows ? map->height : rows;
	int k = map->height / rows;
	struct image out = image_new(2 * rows, rows, 3);
	for (int y = 0; y < rows; y++)
		for (int x = 0; x < 2 * rows; x++)
			for (int j = 0; j < k; j++)
				for (int i = 0; i < k; i++)
					for (int c = 0; c < 3; c++)
						image_at(&out, x, y)[c] += image_at(map, x * k + i, y * k + j)[c] / (float)(k * k);
	return out;
}

double envmap_solid_angle(const struct image *map, int y)
{
	return (cos(M_PI * y / map->height) - cos(M_PI * (y + 1) / map->height)) * 2 * M_PI / map->width;
}
