#include <math.h>

#include "image/envmap/impl.h"
#include "math/rng.h"

static double lum(const float rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

struct region {
	int x0, y0, x1, y1;
};

static double region_energy(const struct image *map, struct region r)
{
	double sum = 0;
	for (int y = r.y0; y < r.y1; y++) {
		double row = 0;
		for (int x = r.x0; x < r.x1; x++)
			row += lum(image_at(map, x, y));
		sum += row * envmap_solid_angle(map, y);
	}
	return sum;
}

/* Cuts a region across its longer side (in angle) at half of its energy. */
static void cut(const struct image *map, struct region r, struct region out[2])
{
	double width = (r.x1 - r.x0) * sin(M_PI * 0.5 * (r.y0 + r.y1) / map->height);
	bool across = (width >= r.y1 - r.y0 && r.x1 - r.x0 > 1) || r.y1 - r.y0 < 2;
	int lo = across ? r.x0 : r.y0, hi = across ? r.x1 : r.y1, at = lo < hi ? lo + 1 : hi;  // of one pixel or none the second part is empty
	double half = region_energy(map, r) / 2, sum = 0;
	for (int i = lo; i < hi - 1; i++) {
		struct region line = across ? (struct region){ i, r.y0, i + 1, r.y1 } : (struct region){ r.x0, i, r.x1, i + 1 };
		sum += region_energy(map, line);
		at = i + 1;
		if (sum >= half)
			break;
	}
	out[0] = out[1] = r;
	*(across ? &out[0].x1 : &out[0].y1) = at;
	*(across ? &out[1].x0 : &out[1].y0) = at;
}

static bool region_light(struct envmap_light *light, const struct image *map, struct region r)
{
	double dir[3] = { 0 }, rgb[3] = { 0 };
	for (int y = r.y0; y < r.y1; y++)
		for (int x = r.x0; x < r.x1; x++) {
			double d[3], w = envmap_solid_angle(map, y);
			const float *p = image_at(map, x, y);
			envmap_dir(d, (x + 0.5) / map->width, (y + 0.5) / map->height);
			for (int c = 0; c < 3; c++) {
				dir[c] += d[c] * w * lum(p);
				rgb[c] += w * p[c] / M_PI;
			}
		}
	double n = sqrt(dir[0] * dir[0] + dir[1] * dir[1] + dir[2] * dir[2]);
	for (int c = 0; c < 3; c++) {
		light->dir[c] = (float)(n > 0 ? dir[c] / n : c == 2 ? -1 : 0);
		light->rgb[c] = (float)rgb[c];
	}
	return n > 0;
}

/* Regions of equal energy; returns their number, at most n. */
static int regions_cut(struct region regions[ENVMAP_LIGHTS_MAX], const struct image *map, int n)
{
	int made = 1;
	regions[0] = (struct region){ 0, 0, map->width, map->height };
	while (2 * made <= n && 2 * made <= ENVMAP_LIGHTS_MAX) {
		for (int i = made - 1; i >= 0; i--) {
			struct region two[2];
			cut(map, regions[i], two);
			regions[2 * i] = two[0];
			regions[2 * i + 1] = two[1];
		}
		made *= 2;
	}
	return made;
}

int envmap_lights(struct envmap_light lights[], int n, const struct envmap *env)
{
	struct image map = envmap_coarse(&env->map, ENVMAP_ROWS);
	struct region regions[ENVMAP_LIGHTS_MAX];
	int made = regions_cut(regions, &map, n), out = 0;
	for (int i = 0; i < made; i++)
		out += region_light(&lights[out], &map, regions[i]);
	image_free(&map);
	return out;
}

/* Energy times solid angle: the error of replacing a region by a single direction. */
static double region_spread(const struct image *map, struct region r)
{
	double angle = 0;
	for (int y = r.y0; y < r.y1; y++)
		angle += (r.x1 - r.x0) * envmap_solid_angle(map, y);
	return (r.x1 - r.x0) * (r.y1 - r.y0) > 1 ? angle * region_energy(map, r) : 0;
}

int envmap_lights_spread(struct envmap_light lights[], int n, const struct envmap *env)
{
	struct image map = envmap_coarse(&env->map, ENVMAP_ROWS);
	struct region regions[ENVMAP_LIGHTS_MAX] = { { 0, 0, map.width, map.height } }, two[2];
	double spread[ENVMAP_LIGHTS_MAX] = { region_spread(&map, regions[0]) };
	int made = 1, out = 0;
	while (made < n && made < ENVMAP_LIGHTS_MAX) {
		int at = 0;
		for (int i = 1; i < made; i++)
			at = spread[i] > spread[at] ? i : at;
		if (!(spread[at] > 0))
			break;
		cut(&map, regions[at], two);
		regions[at] = two[0];
		regions[made] = two[1];
		spread[at] = region_spread(&map, two[0]);
		spread[made++] = region_spread(&map, two[1]);
	}
	for (int i = 0; i < made; i++)
		out += region_light(&lights[out], &map, regions[i]);
	image_free(&map);
	return out;
}

/* Draws a direction in a region with the density of its light, uniformly within a pixel. turn: successive draws are moved by
 * the golden section, so that they are spread evenly over the region's light. */
static void region_draw(double dir[3], const struct image *map, struct region r, double turn, struct rng *rng)
{
	double left = (turn - floor(turn)) * region_energy(map, r);
	int x = r.x1 - 1, y = r.y1 - 1;
	for (int v = r.y0; v < r.y1 && left >= 0; v++) {
		double w = envmap_solid_angle(map, v);
		for (int u = r.x0; u < r.x1 && left >= 0; u++) {
			left -= w * lum(image_at(map, u, v));
			x = u;
			y = v;
		}
	}
	envmap_dir(dir, (x + rng_uniform(rng)) / map->width, (y + rng_uniform(rng)) / map->height);
}

int envmap_lights_drawn(struct envmap_light lights[], int n, const struct envmap *env, uint64_t seed)
{
	struct image map = envmap_coarse(&env->map, ENVMAP_ROWS);
	struct region regions[ENVMAP_LIGHTS_MAX];
	struct rng rng = { seed }, start = { 1 };
	int made = regions_cut(regions, &map, n), out = 0;
	for (int i = 0; i < made; i++) {
		double dir[3], turn = rng_uniform(&start) + (double)(seed % (1 << 20)) * 0.6180339887498949;
		if (!region_light(&lights[out], &map, regions[i]))
			continue;
		region_draw(dir, &map, regions[i], turn, &rng);
		for (int c = 0; c < 3; c++)
			lights[out].dir[c] = (float)dir[c];
		out++;
	}
	image_free(&map);
	return out;
}
