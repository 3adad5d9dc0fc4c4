// The iris as a ray behind the cornea meets it: lib/eye/scene_meet.c, scene_march.c, scene_shadow.c, scene_pupil.c,
// scene_colour.c; and all that the eye is told.
const int NODES = 12;
uniform vec3 origin;              // of all rays: the camera, eye frame
uniform mat3 eye_from_cam, env_from_eye;
uniform vec4 lens;                // focal length, middle (px of the camera), px of the camera in one of the picture
uniform vec2 corner, size, jitter;
uniform mat3 slip;
uniform vec2 limbus;
uniform vec4 back;                // of the cornea: sight()
uniform float sclera_reach;       // angle at the edge of the maps of the sclera
uniform vec3 sclera;              // z of its centre, radius, width of the limbus over its radius
uniform vec3 pupil;               // as fitted: x, y, radius, in the iris plane
uniform float pupil_now;
uniform float iris_depth, pixel;  // pixel: mm on the iris
uniform vec2 heights;
uniform int level, map_size;
uniform sampler2D relief_map, colour_map, model_map, path_map, vein_map, film_map, sharp_map, rough_map;
uniform int beams;
uniform vec3 beam_rgb[LIGHTS];
uniform vec4 source[2], extinction[2];  // by layer, four wavelengths
uniform mat4 band_rgb;            // columns: wavelengths; rows: R, G, B
uniform float abl, exposure, tissue_gain, detail;
uniform int nodes[2];
uniform vec2 node[2 * NODES];     // place and weight, of the anterior border layer, then of the stroma
uniform int search, shadow_steps;
uniform bool flat_iris;
uniform vec3 flat_rgb;
uniform vec3 quadric[9], even;    // irradiance of the environment
uniform float mirror_on, tear;
out vec4 seen;

// From a place on the iris as it is now to the same tissue in the maps: radial fibres shorten evenly from the margin to the
// root, the homogeneous rubber sheet of Daugman (1993).
vec2 stretch(vec2 p, out float along, out float across)
{
	vec2 d = p - pupil.xy;
	float r = length(d), root = rim * 1.02;
	along = across = 1.0;
	if (abs(pupil_now - pupil.z) < 1e-4 || r >= root)
		return p;
	along = (root - pupil.z) / (root - pupil_now);
	float r0 = pupil.z + (r - pupil_now) * along;
	across = r0 / max(r, 1e-3);
	return pupil.xy + d * across;
}

vec2 map_place(vec2 p)
{
	return p / (2.0 * extent) + 0.5;
}

// Height, which a half float holds too coarsely for its slopes: in two, and thickness.
vec2 height_of(vec4 t)
{
	return vec2(t.r + t.b, t.g);
}

// Height and thickness; lying loosely, the stroma keeps its volume: it is thicker where it is shorter.
vec2 relief_at(vec2 p)
{
	float along, across;
	vec2 q = stretch(p, along, across), t = height_of(textureLod(relief_map, map_place(q), float(level)));
	return vec2(t.x, t.y * clamp(along * across, 0.3, 3.0));
}

// The same with the slope of the height in zw.
vec4 relief_slope(vec2 p)
{
	float along, across;
	vec2 q = stretch(p, along, across);
	int n = map_size >> level;
	float per_mm = float(n) / (2.0 * extent);
	vec2 u = clamp(q * per_mm + 0.5 * float(n) - 0.5, 0.0, float(n) - 1.001);
	ivec2 i = ivec2(u);
	u -= vec2(i);
	vec2 a = height_of(texelFetch(relief_map, i, level)), b = height_of(texelFetch(relief_map, i + ivec2(1, 0), level));
	vec2 c = height_of(texelFetch(relief_map, i + ivec2(0, 1), level)), d = height_of(texelFetch(relief_map, i + ivec2(1, 1), level));
	vec2 g = per_mm * vec2(mix(b.x - a.x, d.x - c.x, u.y), mix(c.x - a.x, d.x - b.x, u.x));
	vec2 ht = mix(mix(a, b, u.x), mix(c, d, u.x), u.y);
	if (along != 1.0 || across != 1.0) {
		vec2 e = normalize(p - pupil.xy);
		g = across * g + (along - across) * dot(g, e) * e;
		ht.y *= clamp(along * across, 0.3, 3.0);
	}
	return vec4(ht, g);
}

vec4 path_at(int beam, int plane, vec2 p)
{
	vec2 cell = clamp((p + extent) / (2.0 * extent) * (GRID - 1.0), 0.0, GRID - 1.0);
	return textureLod(path_map, (cell + 0.5 + vec2(float(plane), float(beam)) * GRID) / (GRID * vec2(2.0, float(LIGHTS))), 0.0);
}

// Unit direction towards the light, and irradiance of a plane that faces it; the sclera stops, gradually, what would enter
// outside the limbus.
vec4 path_to(int beam, vec3 p)
{
	float q = (p.z - beam_z.x) / (beam_z.y - beam_z.x);
	vec4 w = mix(path_at(beam, 0, p.xy), path_at(beam, 1, p.xy), q);
	float t = clamp((w.w - 1.0) / sclera.z + 0.5, 0.0, 1.0);
	return vec4(w.xy, -sqrt(max(1.0 - dot(w.xy, w.xy), 0.0)), max(w.z, 0.0) * (1.0 - t * t * (3.0 - 2.0 * t)));
}

// The first crossing of the relief: bracketed by equal steps, then twice regula falsi.
vec3 meet(vec3 f, vec3 v)
{
	float high = iris_depth - heights.y - 1e-4, low = iris_depth - heights.x + 1e-4;
	float a = (high - f.z) / v.z, fa = -1e-6, b = a, fb = 0.0, dt = (low - high) / v.z / float(search);
	for (int k = 1; k <= 16; k++) {
		if (k > search)
			break;
		b = a + dt;
		vec3 p = f + b * v;
		fb = p.z - iris_depth + relief_at(p.xy).x;
		if (fb >= 0.0)
			break;
		if (k < search) {
			a = b;
			fa = fb;
		}
	}
	for (int k = 0; k < 2; k++) {
		float t = a - fa * (b - a) / (fb - fa + 1e-12);
		vec3 p = f + t * v;
		float d = p.z - iris_depth + relief_at(p.xy).x;
		if (d >= 0.0) {
			b = t;
			fb = d;
		} else {
			a = t;
			fa = d;
		}
	}
	float d = fb - fa;
	return f + v * (d > 1e-12 ? a - fa * (b - a) / d : b);
}

// Share of the light that comes in over the relief's horizon: sources are 0.15 wide; tissue that stands around in the light
// fills shadows in.
float shadow(vec3 p, vec3 l)
{
	float steepest = -1e3, across = length(l.xy), reach = (iris_depth - heights.y - 1e-4 - p.z) / min(l.z, -0.05);
	for (int k = 1; k <= 16; k++) {
		if (k > shadow_steps)
			break;
		float t = float(k) / float(shadow_steps) * reach;
		float h = iris_depth - relief_at(p.xy + t * l.xy).x;
		steepest = max(steepest, (p.z - h - LOOK_BIAS) / (t * across + 1e-6));
	}
	return LOOK_FILL + (1.0 - LOOK_FILL) * clamp((-l.z / max(across, 1e-6) - steepest) / LOOK_SOURCE, 0.0, 1.0);
}

// Single scattering in both layers over the epithelium, all beams: the march of lib/eye/scene_march.c.
vec3 scatter(vec3 p, vec3 v)
{
	vec4 top = relief_slope(p.xy);
	float rate = max(v.z + dot(top.zw, v.xy), 0.2), most = 3.0 * (abl + top.y), span = (abl + top.y) / rate;
	for (int k = 0; k < 2; k++) {
		vec3 q = p + span * v;
		vec2 t = relief_at(q.xy);
		span = clamp(span + (abl + t.y - (q.z - iris_depth + t.x)) / v.z, 1e-3, most);
	}
	float near = min(abl / rate, span);
	vec4 at[NODES], way[NODES];  // slope, depth, place on the ray; to the beholder in either layer, weight
	int total = nodes[0] + nodes[1];
	for (int j = 0; j < NODES; j++) {
		if (j >= total)
			break;
		bool stroma = j >= nodes[0];
		vec2 n = node[stroma ? NODES + j - nodes[0] : j];
		float len = stroma ? span - near : near, s = (stroma ? near : 0.0) + n.x * len;
		vec3 q = p + s * v;
		vec4 t = relief_slope(q.xy);
		at[j] = vec4(t.zw, max(q.z - iris_depth + t.x, 0.0), s);
		way[j] = vec4(min(s, near), max(s - near, 0.0), n.y * len, 0.0);
	}
	vec3 sum = vec3(0.0);
	for (int b = 0; b < LIGHTS; b++) {
		if (b >= beams)
			break;
		vec4 near_light = path_to(b, p), far_light = path_to(b, p + span * v), lit = vec4(0.0);
		float open = shadow_steps > 0 ? shadow(p, near_light.xyz) : 1.0;
		for (int j = 0; j < NODES; j++) {
			if (j >= total)
				break;
			vec4 l = mix(near_light, far_light, at[j].w / span);
			float lost = max(-l.z - dot(at[j].xy, l.xy), 0.25);
			float la = min(at[j].z, abl) / lost + way[j].x, ls = max(at[j].z - abl, 0.0) / lost + way[j].y;
			lit += source[j < nodes[0] ? 0 : 1] * (way[j].z * l.w) * exp(-(extinction[0] * la + extinction[1] * ls));
		}
		sum += beam_rgb[b] * (band_rgb * (lit * (open * 0.25))).rgb;  // pi times the phase, 1 / (4 pi)
	}
	return max(sum * exposure, 0.0);
}

vec3 flat_light(vec3 p)
{
	vec3 sum = vec3(0.0);
	for (int b = 0; b < LIGHTS; b++)
		if (b < beams) {
			vec4 l = path_to(b, p);
			sum += beam_rgb[b] * max(l.w * -l.z, 0.0);
		}
	return sum * flat_rgb;
}

// The photograph's colour times what the model changes by: lib/eye/scene_colour.c.
vec3 photographed(vec3 rgb, vec2 p)
{
	float along, across;
	vec2 at = map_place(stretch(p, along, across));
	vec3 k = rgb / textureLod(model_map, at, float(level)).rgb;
	float mean = (k.r + k.g + k.b) / 3.0;
	vec3 tint = clamp(k / max(mean, 1e-6), 1.0 / LOOK_CHROMA, LOOK_CHROMA);
	vec3 shown = textureLod(colour_map, at, float(level)).rgb * min(mean, LOOK_MOST) * tint;
	return detail >= 1.0 ? shown : pow(max(shown, 1e-5), vec3(detail)) * pow(max(tissue_gain * rgb, 1e-5), vec3(1.0 - detail));
}

// The margin of the pupil, and its ruff: what is left of the iris' colour.
vec3 pupil_cover(vec2 p)
{
	vec2 d = p - pupil.xy;
	float r = length(d), soft = 0.5 * pixel;
	if (abs(r - pupil_now) > 0.2 + 2.0 * soft)
		return vec3(step(pupil_now, r));
	float turn = atan(d.y, d.x);
	float ridge = 0.6 * abs(sin(34.0 * turn + 1.7 * sin(5.0 * turn))) + 0.4 * abs(sin(21.0 * turn + 2.0 * sin(3.0 * turn + 1.0)));
	float edge = pupil_now - LOOK_RUFF_RIDGE * ridge, width = LOOK_RUFF_WIDTH + LOOK_RUFF_MORE * ridge;
	float ruff = 1.0 - step_smooth(edge + width - soft, edge + width + LOOK_RUFF_SOFT + soft, r);
	return step_smooth(edge - LOOK_RUFF_BLUR - soft, edge + LOOK_RUFF_BLUR + soft, r) * (1.0 + LOOK_RUFF_SHARE * ruff * (vec3(LOOK_RUFF_COLOUR) - 1.0));
}

vec3 iris(vec3 f, vec3 v)
{
	f.xy += (slip * vec3(f.xy, 1.0)).xy;
	v.xy += mat2(slip) * v.xy;
	vec3 p = meet(f, v), cover = pupil_cover(p.xy);
	if (cover.r <= 0.0)
		return vec3(0.0);
	return photographed(flat_iris ? flat_light(p) : scatter(p, v), p.xy) * cover;
}
