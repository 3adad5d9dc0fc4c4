#include "draw/eye/lighting.h"

struct scene_lighting scene_lighting_of(const struct envmap *env, const struct envmap *mirror, int lights, int each)
{
	struct scene_lighting l = { .env = env, .mirror = mirror, .each = 1 };
	while (2 * l.each * lights <= ENVMAP_LIGHTS_MAX && 2 * l.each <= each)
		l.each *= 2;
	l.n = l.each > 1 ? envmap_lights_spread(l.light, l.each * lights, env) : envmap_lights(l.light, lights, env);
	return l;
}

struct scene_lighting scene_lighting(const struct envmap *env, const struct envmap *mirror, int lights)
{
	return scene_lighting_of(env, mirror, lights, 8);
}
