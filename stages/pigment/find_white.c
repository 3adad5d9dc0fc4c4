#include "stages/pigment/find_white.h"

#include <math.h>
#include <string.h>

#include "base/json.h"

/* What brought this photograph's colour to the texture's: texture.json's "gain"; false when it was not used there. */
static bool texture_gain(double gain[3], const json_t *texture, const char *name)
{
	size_t i;
	json_t *photo;
	gain[0] = gain[1] = gain[2] = 1;
	json_array_foreach(json_object_get(texture, "photos"), i, photo) {
		const char *is = json_string_value(json_object_get(photo, "name"));
		struct err unread = { 0 };
		if (is && !strcmp(is, name)) {
			json_get_array(gain, 3, photo, "gain", "", &unread);
			return !json_is_false(json_object_get(photo, "used"));
		}
	}
	return true;
}

/* The white of one photograph. False, with no error, when it has none. */
static bool look(struct white *white, double *cos_view, struct stage *stage, const struct capture_photo *p, const struct eye *anatomy,
                 const struct pigment_stage_conf *c, struct err *err)
{
	struct fit fit;
	struct photo photo = { 0 };
	const struct opt_each *card = capture_each(&c->card, p->name);
	if (!fit_load(&fit, stage_path(stage, "%s", p->fit), err))
		return false;
	double inside = sin(fit.theta) / anatomy->index;
	*cos_view = sqrt(1 - inside * inside);
	if (!fit.ok || !photo_load(&photo, stage_path(stage, "%s", p->file), c->limit_mpx, err))
		return false;
	bool ok = false;
	if (card && c->white_from != WHITE_FROM_CAMERA)
		ok = white_card(white, &photo, card->value, &c->white, err) || err_wrap(err, "%s", p->file);
	else if (c->white_from == WHITE_FROM_SCLERA)
		ok = white_sclera(white, &photo, &fit, &c->white);
	photo_free(&photo);
	return ok;
}

bool find_white(struct found_white *out, struct stage *stage, const struct capture *capture, int eye, const struct eye *anatomy,
                const struct pigment_stage_conf *c, struct err *err)
{
	json_t *texture = json_read(stage_path(stage, "%s/texture.json", capture->eyes[eye].iris), 1 << 22, err);
	if (!texture)
		return false;
	*out = (struct found_white){ .white = white_camera() };
	double view = 0;
	int views = 0;
	for (int i = 0; i < capture->n_photos; i++) {
		const struct capture_photo *p = &capture->photos[i];
		double gain[3], cos_view = 1;
		struct white white;
		if (p->eye != eye || !texture_gain(gain, texture, p->name))  // what was left out of the texture is left out here
			continue;
		struct err fault = { 0 };
		bool ok = look(&white, &cos_view, stage, p, anatomy, c, &fault);
		if (err_is(&fault)) {
			stage_warn(stage, "white: %s", fault.msg);
			continue;
		}
		view += cos_view;
		views++;
		if (!ok || !white_better(&white, &out->white))
			continue;
		out->white = white;
		out->photo = p->name;
		for (int k = 0; k < 3; k++)
			out->white.rgb[k] *= gain[k];
	}
	json_decref(texture);
	out->cos_view = views ? view / views : 1;
	return true;
}
