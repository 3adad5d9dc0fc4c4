#include <math.h>
#include <string.h>

#include "base/json.h"
#include "tissue/pigment/pigment.h"

static bool gain(double *ln, const json_t *root, const char *key, const char *path, struct err *err)
{
	double value;
	if (!json_get(&value, json_object_get(root, key), "value", path, err))
		return false;
	if (!(value > 0))
		return err_set(err, "%s: %s = %g: must be positive", path, key, value);
	*ln = log(value);
	return true;
}

bool pigment_load(double x[PIGMENT_N], double white[3], struct pigment_conf *conf, const char *path, struct err *err)
{
	struct tissue t;
	json_t *root = json_read(path, 1 << 22, err);
	if (!root)
		return false;
	double bands = 0;
	bool ok = tissue_load(&t, path, err) && gain(&x[PIGMENT_RED], root, "white_red", path, err)
	          && gain(&x[PIGMENT_BLUE], root, "white_blue", path, err)
	          && json_get(&x[PIGMENT_VEIL], json_object_get(root, "veil"), "value", path, err)
	          && json_get_array(white, 3, json_object_get(root, "white"), "rgb", path, err)
	          && json_get(&conf->cos_view, root, "cos_view", path, err) && json_get(&conf->cos_light, root, "cos_light", path, err)
	          && json_get(&bands, root, "bands", path, err);
	json_decref(root);
	if (!ok)
		return false;
	if (!(bands >= 3 && bands <= TISSUE_BANDS_MAX && conf->cos_view > 0 && conf->cos_light > 0))
		return err_set(err, "%s: bands, cos_view or cos_light out of range", path);
	conf->bands = (int)bands;
	conf->abl_thickness = t.abl_thickness;
	conf->illuminant = t.illuminant;
	conf->multiple = t.multiple;
	x[PIGMENT_ABL_MELANIN] = log(fmax(t.layer[TISSUE_ABL].melanin, 1e-6));
	x[PIGMENT_ABL_RATIO] = t.layer[TISSUE_ABL].eumelanin_ratio;
	x[PIGMENT_STROMA_MELANIN] = log(fmax(t.layer[TISSUE_STROMA].melanin, 1e-6));
	x[PIGMENT_STROMA_RATIO] = t.layer[TISSUE_STROMA].eumelanin_ratio;
	x[PIGMENT_SCALE] = log(t.thickness_scale);
	x[PIGMENT_EXPOSURE] = log(t.exposure);
	return true;
}
