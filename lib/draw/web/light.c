#include "draw/web/light.h"

#include "base/json.h"
#include "draw/eye/colour.h"
#include "draw/eye/lighting.h"
#include "draw/web/map.h"

static json_t *directions(int n, const struct envmap_light *light)
{
	json_t *list = json_array();
	for (int i = 0; i < n; i++) {
		double v[6];
		for (int c = 0; c < 3; c++) {
			v[c] = light[i].dir[c];
			v[3 + c] = light[i].rgb[c];
		}
		json_array_append_new(list, json_numbers(6, v));
	}
	return list;
}

/* A polynomial's coefficients, three channels each. */
static json_t *coefficients(int n, const float of[][3])
{
	json_t *list = json_array();
	for (int k = 0; k < n; k++)
		json_array_append_new(list, json_numbers(3, (double[]){ of[k][0], of[k][1], of[k][2] }));
	return list;
}

json_t *web_light(const char *name, const struct envmap *env, const struct envmap *mirror, const struct web_source *source, struct err *err)
{
	enum { SKIES = 8 };  // what the skin mirrors
	struct scene_lighting light = scene_lighting_of(env, mirror, source->lights, source->directions);
	struct envmap_light sky[ENVMAP_LIGHTS_MAX];
	int n = envmap_lights(sky, SKIES, env);
	json_t *out = json_pack("{s:s,s:i}", "name", name, "beams", (light.n + light.each - 1) / light.each);
	json_object_set_new(out, "lights", directions(light.n, light.light));
	json_object_set_new(out, "skies", directions(n, sky));
	json_object_set_new(out, "quadric", coefficients(9, env->quadric));
	json_object_set_new(out, "wet", coefficients(ENVMAP_WET, env->wet));
	if (mirror) {
		const struct image *s = &mirror->sharp, *r = &mirror->rough;
		json_object_set_new(out, "sharp", web_map_log(s->px, s->width, s->height, s->channels, SCENE_DARK, err));
		json_object_set_new(out, "rough", web_map_log(r->px, r->width, r->height, r->channels, SCENE_DARK, err));
	}
	return out;
}
