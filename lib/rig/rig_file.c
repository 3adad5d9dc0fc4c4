#include "rig/rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/npy/npy.h"

static const char *const globe_keys[2] = { "globe_left_map", "globe_right_map" }, lids_key[] = "expression_lids", low_key[] = "own_lower_lids";

/* The single numbers of a rig, in their order in the file's array `parameters`. */
struct small {
	double e[RIG_COMPONENTS], aperture[4], baseline[4][3], rotation[3][3], center[2][3], radius[2], own[2];
	double grid[3], from_target[3][4], focal[2], middle[2], size[2];
	struct known known;
};

static struct small small_of(const struct rig *r)
{
	struct small s = { .grid = { r->skull.x0, r->skull.y0, r->skull.step },
		               .size = { r->camera.width, r->camera.height }, .known = r->known };
	memcpy(s.e, r->rest_e, sizeof s.e);
	memcpy(s.aperture, r->rest_aperture, sizeof s.aperture);
	memcpy(s.baseline, r->baseline, sizeof s.baseline);
	memcpy(s.rotation, r->head_from_target, sizeof s.rotation);
	memcpy(s.from_target, r->camera.from_target, sizeof s.from_target);
	memcpy(s.focal, r->camera.focal_px, sizeof s.focal);
	memcpy(s.middle, r->camera.center_px, sizeof s.middle);
	for (int i = 0; i < 2; i++) {
		memcpy(s.center[i], r->globe[i].center, sizeof s.center[i]);
		s.radius[i] = r->globe[i].radius;
		s.own[i] = r->globe[i].own;
	}
	return s;
}

static void small_to(struct rig *r, const struct small *s)
{
	r->skull.x0 = s->grid[0];
	r->skull.y0 = s->grid[1];
	r->skull.step = s->grid[2];
	memcpy(r->rest_e, s->e, sizeof s->e);
	memcpy(r->rest_aperture, s->aperture, sizeof s->aperture);
	memcpy(r->baseline, s->baseline, sizeof s->baseline);
	memcpy(r->head_from_target, s->rotation, sizeof s->rotation);
	memcpy(r->camera.from_target, s->from_target, sizeof s->from_target);
	memcpy(r->camera.focal_px, s->focal, sizeof s->focal);
	memcpy(r->camera.center_px, s->middle, sizeof s->middle);
	r->known = s->known;
	r->camera.width = (int)s->size[0];
	r->camera.height = (int)s->size[1];
	for (int i = 0; i < 2; i++) {
		memcpy(r->globe[i].center, s->center[i], sizeof s->center[i]);
		r->globe[i].radius = s->radius[i];
		r->globe[i].own = s->own[i] != 0;
	}
}

/* One array of the file: where it is stored, and its shape (-1: any, known once it is read). */
struct entry {
	const char *name;
	enum npy_type type;
	int ndim;
	long shape[3];
	void **data;
};

enum { ENTRIES_MAX = 32 };
static const double NUMBER_MOST = 1e12;  // no length in mm, no coefficient comes near

/* The rig's arrays; the last two are some that older rigs have not: aperture_px, then expression; own_low. */
static int entries(struct entry out[ENTRIES_MAX], struct rig *r, struct small **small, float **mean, double (**lids)[EXPRESS_LIDS], float **low)
{
	long n = r->n, cells = r->globe[0].map.n + 1;
	const struct entry small_entries[] = {
		{ "parameters", NPY_F8, 1, { sizeof(struct small) / sizeof(double) }, (void **)small },
		{ "U", NPY_F4, 3, { n, 2, RIG_COMPONENTS }, (void **)&r->basis },
		{ "mean", NPY_F4, 2, { n, 2 }, (void **)mean },
		{ "home", NPY_F4, 2, { n, 2 }, (void **)&r->home },
		{ "W", NPY_F8, 2, { RIG_COMPONENTS, r->n_inputs + 1 }, (void **)&r->W },
		{ "vertices", NPY_F4, 2, { n, 3 }, (void **)&r->rest },
		{ "normals", NPY_F4, 2, { n, 3 }, (void **)&r->normal },
		{ "faces", NPY_I4, 2, { r->n_faces, 3 }, (void **)&r->faces },
		{ "fade", NPY_F4, 1, { n }, (void **)&r->fade },
		{ "thickness", NPY_F4, 1, { n }, (void **)&r->thickness },
		{ "delta0", NPY_F4, 1, { n }, (void **)&r->gap },
		{ "glue", NPY_F4, 1, { n }, (void **)&r->glue },
		{ "part", NPY_U1, 1, { n }, (void **)&r->part },
		{ "source", NPY_U1, 1, { n }, (void **)&r->source },
		{ "side", NPY_U1, 1, { n }, (void **)&r->side },
		{ "bplus_indptr", NPY_I4, 1, { n + 1 }, (void **)&r->bplus.start },
		{ "bplus_indices", NPY_I4, 1, { r->bplus.start ? r->bplus.start[n] : -1 }, (void **)&r->bplus.column },
		{ "bplus_data", NPY_F4, 1, { r->bplus.start ? r->bplus.start[n] : -1 }, (void **)&r->bplus.weight },
		{ "skull", NPY_F4, 3, { r->skull.height, r->skull.width, SKULL_CHANNELS }, (void **)&r->skull.texel },
		{ globe_keys[0], NPY_F4, 2, { cells, cells }, (void **)&r->globe[0].map.radius },
		{ globe_keys[1], NPY_F4, 2, { cells, cells }, (void **)&r->globe[1].map.radius },
		{ lids_key, NPY_F8, 2, { r->n_inputs - 10 + 1, EXPRESS_LIDS }, (void **)lids },
		{ low_key, NPY_F4, 3, { 2, OWN_LOW_V, OWN_LOW_H }, (void **)low },
	};
	memcpy(out, small_entries, sizeof small_entries);
	return COUNT(small_entries);
}

bool rig_save(const struct rig *rig, const char *path, const char *made_by, struct err *err)
{
	struct rig view = *rig;
	struct small small = small_of(rig), *at = &small;
	float *mean = mem_new(2 * (size_t)rig->n + 1, sizeof *mean);
	for (int i = 0; i < 2 * rig->n; i++) {
		double m = rig->home[i / 2][i % 2];
		for (int k = 0; k < RIG_COMPONENTS; k++)
			m -= (double)rig->basis[i / 2][i % 2 * RIG_COMPONENTS + k] * rig->rest_e[k];
		mean[i] = (float)m;
	}
	const int expressions = rig->n_inputs - 10;
	double (*lids)[EXPRESS_LIDS] = mem_new((size_t)expressions + 1, sizeof *lids);
	memcpy(lids[0], rig->aperture_px, sizeof lids[0]);
	for (int k = 0; k < expressions && rig->expression; k++)
		memcpy(lids[1 + k], rig->expression[k], sizeof lids[1 + k]);
	struct entry all[ENTRIES_MAX];
	struct npz_item items[ENTRIES_MAX];
	float *low = &view.own_low.share[0][0][0];
	int n = entries(all, &view, &at, &mean, &lids, &low);
	for (int i = 0; i < n; i++)
		items[i] = (struct npz_item){ all[i].name, npy_of(all[i].type, all[i].ndim, all[i].shape, *all[i].data) };
	bool ok = npz_save(path, n, items, made_by, err);
	free(mean);
	free(lids);
	return ok;
}

/* Reads one array; got: its shape. */
static bool read_entry(const char *path, const struct entry *e, long got[3], struct err *err)
{
	struct npy a;
	if (!npz_read(&a, path, e->name, NPY_LIMIT, err))
		return false;
	if (a.type != e->type) {
		npy_free(&a);
		return err_set(err, "%s: %s: another type of number than extrapolate writes: run it again", path, e->name);
	}
	if (!npy_expect(&a, path, e->ndim, e->shape, err) || !npy_in_range(&a, NUMBER_MOST, false, 0, path, err)) {
		npy_free(&a);
		return err_wrap(err, "%s", e->name);
	}
	size_t size = (size_t)npy_count(&a) * npy_type_size(a.type);
	*e->data = mem_array(size + 64, 1);  // aligned, as the texels of the skull map require
	memcpy(*e->data, a.data, size);
	for (int i = 0; i < e->ndim; i++)
		got[i] = a.shape[i];
	npy_free(&a);
	return true;
}

/* What expressions do to lids; lids: as read, null: the rig is older. */
static bool take_lids(struct rig *r, const double (*lids)[EXPRESS_LIDS], const char *path, struct err *err)
{
	static const double most = 100;  // of an aperture's range
	const int expressions = r->n_inputs - 10;
	r->expression = mem_new((size_t)expressions + 1, sizeof *r->expression);
	for (int k = 0; k < EXPRESS_LIDS; k++)
		r->aperture_px[k] = lids ? lids[0][k] : 1;
	for (int i = 0; i < EXPRESS_LIDS * expressions && lids; i++) {
		const double by = lids[1 + i / EXPRESS_LIDS][i % EXPRESS_LIDS];
		if (!(fabs(by) <= most))
			return err_set(err, "%s: %s: %g: must be in [-%g, %g] of an eye's opening", path, lids_key, by, most, most);
		r->expression[i / EXPRESS_LIDS][i % EXPRESS_LIDS] = by;
	}
	return true;
}

/* Whether all indices are in range. */
static bool check(const struct rig *r, const char *path, struct err *err)
{
	for (int i = 0; i < 3 * r->n_faces; i++)
		if (r->faces[i / 3][i % 3] < 0 || r->faces[i / 3][i % 3] >= r->n)
			return err_set(err, "%s: faces: %d is no vertex", path, r->faces[i / 3][i % 3]);
	for (int i = 0; i < r->n; i++)
		if (r->side[i] > 1 || r->part[i] >= RIG_PARTS)
			return err_set(err, "%s: vertex %d belongs to no part", path, i);
	for (int i = 0; i < r->n; i++)
		if (r->bplus.start[i] < 0 || r->bplus.start[i] > r->bplus.start[i + 1])
			return err_set(err, "%s: bplus_indptr: must not fall", path);
	for (int i = 0; i < r->bplus.start[r->n]; i++)
		if (r->bplus.column[i] < 0 || r->bplus.column[i] >= r->n)
			return err_set(err, "%s: bplus_indices: %d is no vertex", path, r->bplus.column[i]);
	if (r->n_inputs < 10)
		return err_set(err, "%s: W: must have the inputs of two eyes", path);
	if (!known_check(&r->known, path, err))
		return false;
	if (r->skull.width < 2 || r->skull.height < 2 || !(r->skull.step > 0))
		return err_set(err, "%s: skull: must have at least 2 x 2 texels", path);
	return true;
}

bool rig_load(struct rig *rig, const char *path, struct err *err)
{
	struct small *small = 0;
	float *mean = 0, *low = 0;
	double (*lids)[EXPRESS_LIDS] = 0;
	struct entry all[ENTRIES_MAX];
	bool ok = true;
	*rig = (struct rig){ .n = -1, .n_faces = -1, .n_inputs = -2, .skull = { .width = -1, .height = -1 } };
	rig->globe[0].map.n = rig->globe[1].map.n = -2;
	int n = entries(all, rig, &small, &mean, &lids, &low);
	for (int i = 0; ok && i < n; i++) {
		long got[3] = { 0 };
		if ((!strcmp(all[i].name, lids_key) || !strcmp(all[i].name, low_key)) && !npz_has(path, all[i].name, NPY_LIMIT))
			continue;
		entries(all, rig, &small, &mean, &lids, &low);  // again, with the shapes that are known by now
		ok = read_entry(path, &all[i], got, err);
		if (ok && !strcmp(all[i].name, "U"))
			rig->n = (int)got[0];
		else if (ok && !strcmp(all[i].name, "W"))
			rig->n_inputs = (int)got[1] - 1;
		else if (ok && !strcmp(all[i].name, "faces"))
			rig->n_faces = (int)got[0];
		else if (ok && !strcmp(all[i].name, "skull"))
			rig->skull.height = (int)got[0], rig->skull.width = (int)got[1];
		else if (ok && !strcmp(all[i].name, globe_keys[0]))
			rig->globe[0].map.n = rig->globe[1].map.n = (int)got[0] - 1;
	}
	if (ok) {
		small_to(rig, small);
		for (int i = 0; i < 2 * OWN_LOW_V * OWN_LOW_H; i++)
			(&rig->own_low.share[0][0][0])[i] = low ? low[i] : 1;
		ok = check(rig, path, err) && take_lids(rig, (const double(*)[EXPRESS_LIDS])lids, path, err);
	}
	free(small);
	free(mean);
	free(lids);
	free(low);
	if (!ok)
		rig_free(rig);
	return ok;
}

bool rig_sockets(double radius[2], const char *path, struct err *err)
{
	struct small *small = 0;
	long got[3];
	const struct entry parameters = { "parameters", NPY_F8, 1, { sizeof *small / sizeof(double) }, (void **)&small };
	if (!read_entry(path, &parameters, got, err))
		return false;
	memcpy(radius, small->radius, sizeof small->radius);
	free(small);
	return true;
}
