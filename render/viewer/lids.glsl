// What lids do to the eye below them: they leave it some of the sky, whose light is that about its middle, darken it under their edge, and hold the tear line, a quarter
// of a circle that leaves the globe flat and meets the lid upright: lib/draw/face/eye.c, draw/face/tear.c, draw/face/wet.c.
uniform mat3 lidded_from_eye;     // to the axes in which lids leave sky over places of the globe
uniform float side;               // left eye 0, right eye 1
uniform sampler2D sky_map, lid_map;  // lid_map: tear.frag
uniform vec3 depth;               // of clip space, and the face's mm in one of the eye's
uniform float tear_height;        // mm of the face
uniform vec3 tear_absorb;         // 1/mm
uniform vec4 canthus;             // the inner corner from the globe's middle, head's axes; mm of a mean eyeball's, 0: not known
uniform vec3 skin_rgb;

vec3 environment(vec3 r, float rough);
vec3 below_film(vec3 normal);
vec3 ray_at(vec2 px);

// Direction to the lid, averaged over the neighbours: a single pixel's follows every step of the edge.
vec2 towards(ivec2 at, int reach)
{
	vec2 sum = vec2(0.0);
	for (int v = -2; v <= 2; v++)
		for (int u = -2; u <= 2; u++) {
			vec4 t = texelFetch(lid_map, at + ivec2(u, v) * reach, 0);
			if (t.z > 0.0 && t.z < 1e3)
				sum += t.xy;
		}
	return sum / (length(sum) + 1e-6);
}

// Height of the meniscus on a place of the globe: the lake at the inner corner is wider.
float lake_height(vec3 place)
{
	vec3 off = place - canthus.xyz;
	return tear_height * (canthus.w > 0.0 ? 1.0 + LAKE_RISE * exp(-dot(off, off) / (LAKE_MM * LAKE_MM * canthus.w * canthus.w)) : 1.0);
}

// Transmittance of a lake of that depth for light that leaves under that cosine.
vec3 lake_light(float deep, float cos_i)
{
	float s2 = (1.0 - cos_i * cos_i) / (LOOK_FILM_INDEX * LOOK_FILM_INDEX);
	return exp(-tear_absorb * deep * (inversesqrt(1.0 - s2) + LAKE_LIGHT_WAY));
}

// Of the meniscus, with the normal n of the globe and the direction `away` from the lid, in its tangent plane; d in px.
vec3 wet(vec3 rgb, vec3 dir, vec3 n, vec3 away, float d, float height, float mm, float open)
{
	const int ACROSS = 4;
	vec3 sum = vec3(0.0);
	vec3 through = vec3(0.0);
	for (int k = 0; k < ACROSS; k++) {
		float dk = mix(max(d - 0.5 * mm, 0.0), d + 0.5 * mm, (float(k) + 0.5) / float(ACROSS)), part = 1.0 - step_smooth(TEAR_END * height, height, dk);
		float lean = 1.0 - clamp(dk, 0.0, height) / height;
		vec3 normal = sqrt(1.0 - lean * lean) * n + lean * away;
		float c = -dot(dir, normal), share = part * mirror_share(c, LOOK_FILM_INDEX);
		vec3 r = dir + 2.0 * c * normal;
		// The lids stand before what is low over the globe: as much of it as they take of the sky.
		float free = step_smooth(0.5 * (1.0 - open), 1.5 * (1.0 - open) + 0.01, dot(r, n));
		sum += share * mix(TEAR_SKIN * skin_rgb, mirror_on * environment(r, TEAR_ROUGH), free);
		float x = height - clamp(dk, 0.0, height);
		through += (1.0 - share) * lake_light(height - sqrt(height * height - x * x), -dot(dir, n));
	}
	return (rgb * through + sum) / float(ACROSS);
}

vec3 below_lids(vec3 rgb, vec3 at, vec3 dir)
{
	vec3 n = normalize(at - vec3(0.0, 0.0, sclera.x)), place = lidded_from_eye * n;
	vec4 left = textureLod(sky_map, vec2(clamp(0.25 + 0.25 * place.x, 0.02, 0.48) + 0.5 * side, 0.5 + 0.5 * place.y), 0.0);
	float open = left.r;
	vec3 middle = transpose(lidded_from_eye) * normalize(2.0 * left.gba - 1.0);
	rgb *= open * min(max(below_film(middle), 0.02) / max(below_film(n), 0.02), 2.0) + vec3(LOOK_BOUNCE) * (1.0 - open);
	ivec2 px = ivec2(gl_FragCoord.xy);
	// In view space, over the globe: a pixel that it turns away from the camera shows more of it.
	vec4 lid = texelFetch(lid_map, px, 0);
	float mm = pixel * depth.z;
	if (lid.z > 0.0 && lid.z < 1e3) {
		vec3 beside = eye_from_cam * ray_at(vec2(gl_FragCoord.x + lid.x / lid.z, size.y - gl_FragCoord.y - lid.y / lid.z) + jitter);
		mm = max(mm, min(length(at - (origin + beside * (dot(at - origin, n) / dot(beside, n)))) * depth.z, 4.0 * mm));
	}
	float d = (lid.z - 0.5) * mm;
	rgb *= 1.0 - TEAR_SHADOW * exp(-TEAR_SHADOW_FADE * max(d, 0.0) / TEAR_SHADOW_MM) * (1.0 - step_smooth(TEAR_SHADOW_END * TEAR_SHADOW_MM, TEAR_SHADOW_MM, d));
	float height = lake_height(place * length(at - vec3(0.0, 0.0, sclera.x)) * depth.z);
	if (d - 0.5 * mm >= height)
		return rgb;
	vec2 off = towards(px, clamp(int(0.4 * height / (pixel * depth.z)), 1, 3));
	vec3 beside = eye_from_cam * ray_at(vec2(gl_FragCoord.x + off.x, size.y - gl_FragCoord.y - off.y) + jitter);
	vec3 away = at - (origin + beside * (dot(at - origin, n) / dot(beside, n)));
	return length(away) > 1e-5 ? wet(rgb, dir, n, normalize(away), d, height, mm, open) : rgb;
}
