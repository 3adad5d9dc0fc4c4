#include "stages/pigment/find_white.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/exr.h"
#include "limbus/evidence.h"
#include "math/stats.h"
#include "tissue/light/iris_light.h"

/* What brought this photograph's colour to the texture's: texture.json's "gain"; and the colour of its light ("white"), ln R/G, 0 where it
 * is not known. False when the photograph was not used there. */
static bool texture_gain(double gain[3], double *white, const json_t *texture, const char *name)
{
	size_t i;
	json_t *photo;
	double rgb[3];
	gain[0] = gain[1] = gain[2] = 1;
	*white = 0;
	json_array_foreach(json_object_get(texture, "photos"), i, photo) {
		const char *is = json_string_value(json_object_get(photo, "name"));
		struct err unread = { 0 };
		if (is && !strcmp(is, name)) {
			json_get_array(gain, 3, photo, "gain", "", &unread);
			if (json_get_array(rgb, 3, json_object_get(photo, "white"), "rgb", "", &unread) && rgb[0] > 0 && rgb[1] > 0)
				*white = log(rgb[0] / rgb[1]);
			return !json_is_false(json_object_get(photo, "used"));
		}
	}
	return true;
}

/* One photograph. */
struct seen {
	struct white white;
	bool has_white, joined;
	double cos_view;
	struct image light, slant;
	struct sclera_light shading;
};

enum { LIGHT_TEXELS = 96, ENV_ROWS = 128 };

/* What all photographs of an eye share. */
struct search {
	struct stage *stage;
	const struct capture *capture;
	const struct eye *anatomy;
	const struct envmap *told;
	double extent;
	const struct pigment_stage_conf *conf;
	struct evidence_net *net;
};

/* Light first, then white under it. on_iris: what white shows on the iris, too. */
static bool measure(struct seen *out, const struct photo *photo, const struct fit *fit, const struct capture_photo *of, const struct pale_conf *pale,
                    bool on_iris, const struct search *s, struct err *err)
{
	const struct pigment_stage_conf *c = s->conf;
	struct pale *samples = mem_array(PALE_MAX, sizeof *samples);
	const struct opt_each *card = capture_key(&c->card, of);
	struct evidence evidence = { 0 };
	struct err untold = { 0 };
	bool ok = true, told = evidence_window(&evidence, s->net, photo, fit->limbus.cx, fit->limbus.cy, fit->limbus.a, &untold);
	int n = pale_find(samples, photo, fit, s->anatomy, told ? &evidence : 0, pale);
	evidence_free(&evidence);
	if (!told)
		stage_warn(s->stage, "%s", untold.msg);
	out->shading = sclera_light_fit(samples, n);
	struct envmap own = s->told ? (struct envmap){ 0 } : sclera_light_environment(&out->shading, ENV_ROWS);
	const struct envmap *env = s->told ? s->told : &own;
	struct iris_view view = { .env = env, .eye = s->anatomy };
	memcpy(view.cam_from_eye, fit->cam_from_eye, sizeof view.cam_from_eye);
	if (on_iris)
		iris_light_make(&out->light, &out->slant, LIGHT_TEXELS, s->extent, &view);
	struct white sclera;
	const bool measured = white_sclera(&sclera, samples, n, env, &c->white);
	out->white = white_camera();
	if (card && c->white_from != WHITE_FROM_CAMERA) {
		ok = white_card(&out->white, photo, card->value, &c->white, err);
		out->has_white = ok;
	} else if (measured && c->white_from == WHITE_FROM_SCLERA) {
		out->white = sclera;
		out->has_white = true;
	}
	for (int k = 0; k < 3 && measured; k++)
		out->white.sclera[k] = sclera.rgb[k] * c->white.sclera[k] / out->white.rgb[k];
	if (measured) {
		out->white.shade = sclera.shade;
		out->white.share = out->has_white ? out->white.share : sclera.share;
	}
	envmap_free(&own);
	free(samples);
	return ok;
}

/* The iris' colour in the photographs that its texture was made of. */
static bool iris_chroma(double out[CHROMA], const struct search *s, int eye)
{
	static const char *const rgbw[] = { "R", "G", "B", "W" };
	struct image clean = { 0 };
	struct exr_info info = { 0 };
	struct err err = { 0 };
	if (!exr_read(&clean, stage_path(s->stage, "%s/clean.exr", s->capture->eyes[eye].iris), 4, rgbw, PIGMENT_MAP_LIMIT_PX, &info, &err))
		return false;
	enum { MOST = 1 << 20 };
	long n = 0, all = (long)clean.width * clean.height, step = 1 + all / MOST;
	double *x[CHROMA];
	for (int k = 0; k < CHROMA; k++)
		x[k] = mem_array(MOST, sizeof **x);
	for (long i = 0; i < all; i += step) {
		const float *p = clean.px + 4 * i;
		double u = (double)(i % clean.width) / clean.width - 0.5, v = (double)(i / clean.width) / clean.height - 0.5, rgb[3] = { p[0], p[1], p[2] };
		double r = 2 * hypot(u, v) * info.extent_mm / s->anatomy->limbus_radius, c[CHROMA];
		if (p[3] > 0.5f && r > s->conf->fellow.ring[0] && r < s->conf->fellow.ring[1] && rgb[0] > 0 && rgb[1] > 0 && rgb[2] > 0) {
			chroma_of(c, rgb);
			for (int k = 0; k < CHROMA; k++)
				x[k][n] = c[k];
			n++;
		}
	}
	for (int k = 0; k < CHROMA; k++) {
		out[k] = n ? stats_median((int)n, x[k]) : 0;
		free(x[k]);
	}
	image_free(&clean);
	return n > 0;
}

/* An eye's iris as this photograph shows it: texture.json's gain undone. */
static bool iris_shown(double out[CHROMA], const struct search *s, const struct capture_photo *p, const double gain[3])
{
	double g[CHROMA];
	if (!iris_chroma(out, s, p->eye))
		return false;
	chroma_of(g, gain);
	for (int k = 0; k < CHROMA; k++)
		out[k] -= g[k];
	return true;
}

/* How much the colour of white that was measured beside an eye counts. */
static double trust(const struct white *white, const struct search *s)
{
	return 1 / (pow(white->spread, 2) + pow(s->conf->fellow.sigma, 2));
}

/* The colour of a face's white beside one eye, by that beside the other eye, too. */
static void join(struct seen *out, const struct search *s, const struct capture_photo *p, const struct photo *photo, const double gain[3])
{
	const struct capture_photo *other = p->part ? capture_fellow(s->capture, p) : 0;
	struct seen fellow = { 0 };
	struct fit fit;
	struct err err = { 0 };
	struct pale_conf pale = s->conf->white.pale;
	double theirs[3], own_chroma[CHROMA], their_chroma[CHROMA], chroma[CHROMA], theirs_joined[CHROMA], iris[CHROMA] = { 0 }, their_iris[CHROMA];
	if (!other || !out->has_white || out->white.source != WHITE_SCLERA || !fit_load(&fit, stage_path(s->stage, "%s", other->fit), &err) || !fit.ok)
		return;
	json_t *texture = json_read(stage_path(s->stage, "%s/texture.json", s->capture->eyes[other->eye].iris), 1 << 22, &err);
	bool used = texture && texture_gain(theirs, &pale.white, texture, other->name);
	json_decref(texture);
	if (!used || !measure(&fellow, photo, &fit, other, &pale, false, s, &err) || !fellow.has_white)
		return;
	bool irises = iris_shown(iris, s, p, gain) && iris_shown(their_iris, s, other, theirs);
	for (int k = 0; k < CHROMA && irises; k++)
		iris[k] -= their_iris[k];
	chroma_of(own_chroma, out->white.rgb);
	chroma_of(their_chroma, fellow.white.rgb);
	white_pair(chroma, own_chroma, their_chroma, irises ? iris : 0, &s->conf->fellow);
	for (int k = 0; k < CHROMA; k++)
		iris[k] = -iris[k];
	white_pair(theirs_joined, their_chroma, own_chroma, irises ? iris : 0, &s->conf->fellow);
	// A person's two scleras are of one colour. What either shows beyond the white that both tell may be skin among it, the more so where it is uneven.
	const double w = trust(&out->white, s), v = trust(&fellow.white, s);
	for (int k = 0; k < 3; k += 2) {
		const int c = k / 2;
		const double beyond = (w * (own_chroma[c] - chroma[c]) + v * (their_chroma[c] - theirs_joined[c])) / (w + v);
		out->white.rgb[k] = out->white.rgb[1] * exp(chroma[c]);
		out->white.sclera[k] = out->white.sclera[1] * s->conf->white.sclera[k] / s->conf->white.sclera[1] * exp(beyond);
	}
	out->joined = true;
}

/* Returns false where the photograph has no fit, or, err set, cannot be used. */
static bool look(struct seen *out, const struct search *s, const struct capture_photo *p, const struct pale_conf *pale, const double gain[3], struct err *err)
{
	struct fit fit;
	struct photo photo = { 0 };
	*out = (struct seen){ 0 };
	if (!fit_load(&fit, stage_path(s->stage, "%s", p->fit), err))
		return false;
	double inside = sin(fit.theta) / s->anatomy->index;
	out->cos_view = sqrt(1 - inside * inside);
	if (!fit.ok || !photo_load(&photo, stage_path(s->stage, "%s", p->file), s->conf->limit_mpx, err))
		return false;
	bool ok = measure(out, &photo, &fit, p, pale, true, s, err) || err_wrap(err, "%s", p->file);
	if (ok)
		join(out, s, p, &photo, gain);
	photo_free(&photo);
	return ok;
}

/* Takes a photograph's light into the mean, and its white where that is the better one. */
static void take(struct found_white *out, const struct seen *seen, const double gain[3], const char *name)
{
	for (long i = 0; i < 4L * out->light.width * out->light.height; i++)
		out->light.px[i] += seen->light.px[i];
	for (long i = 0; i < (long)IRIS_SLANT * out->slant.width * out->slant.height; i++)
		out->slant.px[i] += seen->slant.px[i];
	out->lights[out->n_lights++] = (struct found_light){ name, seen->shading };
	if (!white_better(&seen->white, &out->white))
		return;
	out->white = seen->white;
	out->joined = seen->joined;
	out->photo = seen->has_white ? name : 0;
	for (int k = 0; k < 3; k++) {
		if (seen->has_white)
			out->white.rgb[k] *= gain[k];
		else  // the camera's white is 1 in the texture, too
			out->white.sclera[k] *= gain[k];
	}
}

bool find_white(struct found_white *out, struct stage *stage, const struct capture *capture, int eye, const struct eye *anatomy,
                const struct envmap *env, double extent, const struct pigment_stage_conf *c, struct err *err)
{
	json_t *texture = json_read(stage_path(stage, "%s/texture.json", capture->eyes[eye].iris), 1 << 22, err);
	if (!texture)
		return false;
	*out = (struct found_white){ .white = white_camera(), .light = image_new(LIGHT_TEXELS, LIGHT_TEXELS, 4),
		.slant = image_new(LIGHT_TEXELS, LIGHT_TEXELS, IRIS_SLANT), .lights = mem_array((size_t)capture->n_photos, sizeof *out->lights) };
	struct search search = { stage, capture, anatomy, env, extent, c, 0 };
	double view = 0;
	int views = 0;
	if (!evidence_open_shipped(&search.net, err)) {
		json_decref(texture);
		return false;
	}
	for (int i = 0; i < capture->n_photos; i++) {
		const struct capture_photo *p = &capture->photos[i];
		double gain[3];
		struct seen seen;
		struct pale_conf pale = c->white.pale;
		if (p->eye != eye || !texture_gain(gain, &pale.white, texture, p->name))  // what was left out of the texture is left out here
			continue;
		struct err fault = { 0 };
		if (look(&seen, &search, p, &pale, gain, &fault)) {
			view += seen.cos_view;
			views++;
			take(out, &seen, gain, p->name);
		} else if (err_is(&fault)) {
			stage_warn(stage, "white: %s", fault.msg);
		}
		image_free(&seen.light);
		image_free(&seen.slant);
	}
	evidence_close(search.net);
	json_decref(texture);
	out->cos_view = views ? view / views : 1;
	for (long i = 0; i < 4L * LIGHT_TEXELS * LIGHT_TEXELS; i++)
		out->light.px[i] /= (float)(views ? views : 1);
	return views || err_set(err, "%s: none of its photographs can be read", capture->eyes[eye].side);
}
