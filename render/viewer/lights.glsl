// The lights of the iris from the tables that paths.frag makes, and how they end at the limbus: lib/draw/eye/march/light.c,
// lib/tissue/light/rim_shadow.h.
uniform vec4 rim_light;           // width of the limbus' shadow's edge, slope and depth of the cornea there, spread of light in the tissue
uniform float rim_edge;           // where it lies, 1 at the limbus
uniform sampler2D path_map, down_map;
uniform int beams;
uniform vec3 beam_rgb[LIGHTS];

vec2 path_place(int beam, int plane, vec2 p)
{
	const float grid = float(GRID);
	vec2 cell = clamp((p + extent) / (2.0 * extent) * (grid - 1.0), 0.0, grid - 1.0);
	return (cell + 0.5 + vec2(float(plane), float(beam)) * grid) / (grid * vec2(2.0, float(TILES)));
}

const float RIM_SHADOW_MOST = 3.6;

// What the sclera's shadow leaves of light that enters at rho and comes to p from l, in tissue that spreads it so far.
float rim_open(float rho, vec3 p, vec3 l, float spread)
{
	float inv = 1.0 / max(-l.z, 0.05);
	vec2 k = p.xy + (p.z - rim_light.z) * inv * l.xy;
	float outwards = dot(k, l.xy) / sqrt(dot(k, k) + 1e-6), soft = spread / (1.0 + rim_light.y * inv * max(outwards, 0.0));
	float at = (rho - rim_edge) / sqrt(rim_light.x * rim_light.x + soft * soft), far = abs(at) < RIM_SHADOW_MOST ? 0.5 * exp(-1.4142136 * abs(at)) : 0.0;
	float t = clamp(0.2236068 * at + 0.5, 0.0, 1.0), begins = rim_light.x * rim_light.x;
	return mix(at < 0.0 ? 1.0 - far : far, 1.0 - t * t * (3.0 - 2.0 * t), begins / (begins + spread * spread));
}

// Direction towards a beam's light (not of unit length), and irradiance of a plane that faces it. rho: where it entered the cornea.
vec4 way_at(int beam, vec3 p, out float rho)
{
	float q = (p.z - beam_z.x) / (beam_z.y - beam_z.x);
	vec2 above = path_place(beam, 0, p.xy), below = path_place(beam, 1, p.xy);
	vec4 w = mix(textureLod(path_map, above, 0.0), textureLod(path_map, below, 0.0), q);
	float down = mix(textureLod(down_map, above, 0.0).r, textureLod(down_map, below, 0.0).r, q);
	rho = w.w;
	return vec4(w.xy, down, down < 0.0 ? max(w.z, 0.0) : 0.0);
}

// Irradiance of the iris plane at p by all beams, in tissue that spreads the limbus' shadow so far.
vec3 lit_plane(vec3 p, float spread)
{
	vec3 sum = vec3(0.0);
	for (int b = 0; b < LIGHTS; b++) {
		if (b >= beams)
			break;
		float rho;
		vec4 l = way_at(b, p, rho);
		sum += beam_rgb[b] * (max(-l.z, 0.0) * l.w * rim_open(rho, p, l.xyz, spread));
	}
	return sum;
}
