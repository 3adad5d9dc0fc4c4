// lib/draw/face/shade.c: diffuse light as spread in the skin, pores, and two rough lobes.
in vec3 seen_at, seen_normal, seen_light, seen_rest;
in vec4 seen_skin;
in float seen_cover;
uniform vec3 head_camera;         // where it is, head's axes
uniform mat3 env_from_head, still_from_head;  // the surroundings as they are, and as the light of the vertices had them
uniform int skies;
uniform vec3 sky_dir[LIGHTS], sky_rgb[LIGHTS];  // head's axes
uniform vec3 quadric[9], still_quadric[9];
#ifdef PORES
uniform float pores;
#endif
uniform vec4 globes[2];           // middle and radius, head's axes
uniform sampler2D sharp_map, rough_map;
uniform float mirror_on;
out vec4 seen;

#ifdef PORES
// Of four corners.
vec4 hash(uvec4 h)
{
	h ^= h >> 15;
	h *= 0x2c1b3c6du;
	h ^= h >> 12;
	h *= 0x297a2d39u;
	h ^= h >> 15;
	return vec4(h & 0xffffu) / 32767.5 - 1.0;
}

float noise(vec3 p)
{
	const uvec3 KEY = uvec3(0x8da6b343u, 0xd8163841u, 0xcb1ab31fu);
	vec3 f = fract(p);
	f = f * f * (3.0 - 2.0 * f);
	uvec3 a = uvec3(ivec3(floor(p))) * KEY, b = a + KEY;
	uvec4 corners = uvec4(a.x ^ a.y, b.x ^ a.y, a.x ^ b.y, b.x ^ b.y);
	vec4 v = mix(hash(corners ^ a.z), hash(corners ^ b.z), f.z);
	return mix(mix(v.x, v.y, f.x), mix(v.z, v.w, f.x), f.y);
}

float pore(vec3 p)
{
	return noise(SKIN_PORES_COARSE * p) + 0.5 * noise(SKIN_PORES_FINE * p);
}
#endif

// 1, or less where a globe stands before it: what is behind an eye is no edge of a lid (tear.frag).
float before_globes()
{
	float far = distance(head_camera, seen_at), out_ = 1.0;
	vec3 d = (seen_at - head_camera) / far;
	for (int i = 0; i < 2; i++) {
		vec3 m = globes[i].xyz - head_camera;
		float along = dot(m, d), inside = globes[i].w * globes[i].w - dot(m - along * d, m - along * d);
		if (inside > 0.0 && along - sqrt(inside) + 0.15 < far)
			out_ = 0.99;
	}
	return out_;
}

vec3 irradiance(vec3 d, vec3 q[9])
{
	return max(q[0] + q[1] * d.x + q[2] * d.y + q[3] * d.z + q[4] * (d.x * d.y) + q[5] * (d.y * d.z) + q[6] * (d.z * d.z)
	           + q[7] * (d.x * d.z) + q[8] * (d.x * d.x - d.y * d.y), 0.02);
}

// A light's mirror image in both lobes, but for what the beholder's side of shadowing takes; a2: roughness to the fourth power.
vec2 gloss(vec3 n, vec3 l, vec3 v, vec2 a2, vec2 k)
{
	vec3 h = normalize(l + v);
	float nh = dot(n, h), nl = max(dot(n, l), 0.0), s = 1.0 - max(dot(v, h), 0.0), s2 = s * s;
	vec2 d = nh * nh * (a2 - 1.0) + 1.0;
	return a2 / (d * d * (nl - nl * k + k)) * (nl * (SKIN_MIRROR + (1.0 - SKIN_MIRROR) * s2 * s2 * s));
}

// Share of a light that the head itself does not block once the light was moved behind it: as of a ball, by the direction of the point
// from its middle. Of the original surroundings the vertices' light has the exact shadows.
float before_head(vec3 facing, vec3 l)
{
	return step_smooth(-0.35, -0.05, dot(facing, l));
}

void main()
{
	vec3 smooth_n = normalize(seen_normal), n = smooth_n, to = normalize(head_camera - seen_at), albedo = seen_skin.rgb * seen_skin.rgb;
	// Change of the light on a surface that faces this way, since the lights were moved.
	vec3 moved = irradiance(env_from_head * n, quadric) / irradiance(still_from_head * n, still_quadric);
	vec3 light = 3.0 * seen_light * seen_light * clamp(moved, 0.0, 6.0);
#ifdef FOLDS
	float sky;
	vec3 fold = folded(smooth_n, seen_at, sky), bent = normalize(smooth_n - SKIN_FOLD_DIFFUSE * fold);
	light *= sky * min(irradiance(env_from_head * bent, quadric) / irradiance(env_from_head * smooth_n, quadric), 2.0);
	n = smooth_n = normalize(smooth_n - fold);
#endif
	if (seen_skin.a > 0.5) {
		seen = vec4((albedo * 1.25 + 0.012) * light, seen_cover);  // blended: face.js
		return;
	}
	float grain = 0.0, relief = 1.0;
#ifdef DRESS
	albedo = mix(dressed(seen_rest), albedo, min(seen_skin.a * (255.0 / 127.0), 1.0));  // moist places stay as they are
#endif
#ifdef PORES
	if (pores > 0.0) {
		float at = pore(seen_rest);
		const vec2 step_ = vec2(SKIN_PORES_STEP, 0.0);
		n -= SKIN_PORES * pores * vec3(pore(seen_rest + step_.xyy) - at, pore(seen_rest + step_.yxy) - at, pore(seen_rest + step_.yyx) - at);
#ifndef DRESS
		grain = SKIN_GRAIN * pores * noise(SKIN_GRAIN_CELLS * seen_rest);
#endif
		n = normalize(n);
		relief += SKIN_PORES_LIGHT * dot(n - smooth_n, sky_dir[0]);
	}
#endif
	const vec2 ROUGH = vec2(SKIN_ROUGH_WIDE, SKIN_ROUGH_NARROW);
	vec2 k = 0.5 * ROUGH * ROUGH, a2 = 4.0 * k * k;
	float nv = dot(n, to);
	vec2 lobes = vec2(SKIN_LOBE_WIDE, SKIN_LOBE_NARROW) * (0.25 / (nv - nv * k + k));
	vec3 spec = vec3(0.0), facing = normalize(seen_at - vec3(0.0, -20.0, -80.0));
	for (int i = 0; i < LIGHTS; i++)
		if (i < skies && nv > 0.0)
			spec += dot(lobes, gloss(n, sky_dir[i], to, a2, k)) * before_head(facing, sky_dir[i]) * sky_rgb[i];
	// What reaches the skin of its light, reaches the mirror too.
	float open = clamp(dot(light, vec3(0.33)) / dot(irradiance(env_from_head * smooth_n, quadric), vec3(0.33)), 0.0, 1.0);
	float wet = min(seen_skin.a * (255.0 / 127.0), 1.0);
	vec3 rgb = albedo * (1.0 + grain) * light * relief + spec * open * (1.0 - wet);
	if (wet > 0.0) {
		// Mucous membrane below a film of tears.
		n = normalize(smooth_n + CARUNCLE_LOBES * (n - smooth_n));
		float c = dot(to, n);
		vec2 u = unfolded(env_from_head * (2.0 * c * n - to));
		rgb += wet * mirror_share(c, LOOK_FILM_INDEX) * (open * mirror_on * mix(textureLod(sharp_map, u, 0.0).rgb, textureLod(rough_map, u, 0.0).rgb, TEAR_ROUGH) - rgb);
	}
	seen = vec4(rgb, before_globes());
}
