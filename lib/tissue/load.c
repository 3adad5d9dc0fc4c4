#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "tissue/tissue.h"

enum { FILE_LIMIT = 1 << 22 };

/* {"value": number} under object[group][key]. */
static bool number(double *out, const json_t *root, const char *group, const char *key, double lo, double hi,
                   const char *path, struct err *err)
{
	const json_t *at = group ? json_object_get(root, group) : root;
	const json_t *entry = json_object_get(at, key);
	const json_t *value = json_is_object(entry) ? json_object_get(entry, "value") : entry;
	if (!json_is_number(value))
		return err_set(err, "%s: %s%s%s: number missing", path, group ? group : "", group ? "." : "", key);
	*out = json_number_value(value);
	if (!(*out >= lo && *out <= hi))
		return err_set(err, "%s: %s%s%s = %g: must be in [%g, %g]", path, group ? group : "", group ? "." : "", key, *out, lo, hi);
	return true;
}

static bool illuminant(enum illuminant *out, const json_t *root, const char *path, struct err *err)
{
	const char *name = json_get_string(root, "illuminant", path, err);
	if (!name)
		return false;
	for (int i = 0; illuminant_names[i]; i++) {
		if (!strcmp(illuminant_names[i], name)) {
			*out = (enum illuminant)i;
			return true;
		}
	}
	return err_set(err, "%s: illuminant = %s: not one of those known", path, name);
}

static bool scattering(bool *multiple, const json_t *root, const char *path, struct err *err)
{
	const char *name = json_get_string(root, "scattering", path, err);
	*multiple = name && !strcmp(name, "multiple");
	return name && (*multiple || !strcmp(name, "single") || err_set(err, "%s: scattering = %s: must be single or multiple", path, name));
}

bool tissue_load(struct tissue *t, const char *path, struct err *err)
{
	json_t *root = json_read(path, FILE_LIMIT, err);
	if (!root)
		return false;
	struct tissue_layer *abl = &t->layer[TISSUE_ABL], *stroma = &t->layer[TISSUE_STROMA];
	bool ok = number(&abl->melanin, root, "abl", "melanin", 0, 1, path, err)
	          && number(&abl->eumelanin_ratio, root, "abl", "eumelanin_ratio", 0, 1, path, err)
	          && number(&t->abl_thickness, root, "abl", "thickness_mm", 0, 1, path, err)
	          && number(&stroma->melanin, root, "stroma", "melanin", 0, 1, path, err)
	          && number(&stroma->eumelanin_ratio, root, "stroma", "eumelanin_ratio", 0, 1, path, err)
	          && number(&t->thickness_scale, root, "stroma", "thickness_scale", 1e-6, 100, path, err)
	          && number(&t->exposure, root, 0, "exposure", 1e-6, 1e6, path, err)
	          && illuminant(&t->illuminant, root, path, err) && scattering(&t->multiple, root, path, err);
	json_decref(root);
	return ok;
}

bool tissue_without(char reason[256], const char *path)
{
	struct err err = { 0 };
	json_t *root = json_read(path, FILE_LIMIT, &err);
	const char *why = json_string_value(json_object_get(root, "without"));
	snprintf(reason, 256, "%.250s", why ? why : "");
	json_decref(root);
	return why;
}
