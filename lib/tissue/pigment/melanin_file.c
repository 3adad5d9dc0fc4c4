#include "tissue/pigment/melanin_file.h"

#include <math.h>

#include "base/json.h"

/* Thousandths of ln are a tenth of any sigma; and a file of a few kilobytes. */
static json_t *thousandths(int n, const double v[])
{
	json_t *out = json_array();
	for (int i = 0; i < n; i++)
		json_array_append_new(out, json_number(round(v[i] * 1000) / 1000));
	return out;
}

json_t *melanin_json(const struct melanin_map *map, const struct pigment_fit *fit)
{
	json_t *out = json_object(), *rings = json_array();
	for (int r = 0; r < fit->rings; r++) {
		const struct pigment_ring *ring = &fit->ring[r];
		json_t *entry = json_object();
		json_object_set_new(entry, "share", json_number(ring->share));
		json_object_set_new(entry, "ln", json_number(ring->melanin));
		json_object_set_new(entry, "sigma", json_number(ring->sigma));
		json_array_append_new(rings, entry);
	}
	json_object_set_new(out, "rings", rings);
	json_object_set_new(out, "extent_mm", json_number(map->extent));
	json_object_set_new(out, "n", json_integer(map->n));
	json_object_set_new(out, "ln", thousandths(map->n * map->n, map->ln));
	json_object_set_new(out, "sigma", thousandths(map->n * map->n, map->sigma));
	return out;
}

static bool in_range(const double v[], int n, double low, double high)
{
	for (int i = 0; i < n; i++)
		if (!(v[i] >= low && v[i] <= high))
			return false;
	return true;
}

bool melanin_load(struct melanin_map *map, const char *path, struct err *err)
{
	json_t *root = json_read(path, 1 << 22, err), *at = json_object_get(root, "melanin_map");
	double n = 0;
	map->n = 0;
	bool ok = root && (!at || (json_get(&n, at, "n", path, err) && json_get(&map->extent, at, "extent_mm", path, err)));
	if (ok && at) {
		ok = (n >= 2 && n <= MELANIN_SIDE_MAX && n == floor(n) && map->extent > 0)
		     || err_set(err, "%s: melanin_map: n = %g, extent_mm = %g: must be a whole number in [2, %d], and positive", path, n, map->extent, MELANIN_SIDE_MAX);
		int all = ok ? (int)(n * n) : 0;
		ok = ok && json_get_array(map->ln, all, at, "ln", path, err) && json_get_array(map->sigma, all, at, "sigma", path, err)
		     && (in_range(map->ln, all, -20, 20) || err_set(err, "%s: melanin_map: ln: must be in [-20, 20]", path));
		map->n = ok ? (int)n : 0;
	}
	json_decref(root);
	return ok;
}
