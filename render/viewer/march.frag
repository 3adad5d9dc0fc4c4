// Light in the iris, from the map's texels: what each texel of the photograph is multiplied by in this light, seen from this
// camera; lib/draw/eye/march/shade.c, draw/eye/march/tile.c, draw/eye/march/march.c, draw/eye/colour.c.
const int NODES = 12;
uniform vec3 sclera;              // z of its centre, radius, width of the limbus over its radius
uniform sampler2D model_map;
uniform int model_top;            // of this level's rows in model_map
uniform vec4 source[2], extinction[2];  // by layer, four wavelengths
uniform mat4 band_rgb;            // columns: wavelengths; rows: R, G, B
uniform float abl, exposure, tissue_gain, detail, own;  // own: share of own_map that this light shows (lib/draw/eye/own_light.h)
uniform float ratio_most, ratio_chroma;
uniform sampler2D own_map;        // what the photograph's light did beyond the model
uniform sampler2D beside_map;     // what light that spreads in the tissue changes: beside.frag
uniform int nodes[2];
uniform vec2 node[2 * NODES];     // place and weight, of the anterior border layer, then of the stroma
#ifdef SHADOWS
uniform sampler2D horizon_map;
#endif
out vec4 light;

// Direction towards a beam's light (not of unit length), and irradiance of a plane that faces it. open: what the sclera lets
// in, which begins gradually at the limbus; all of a ray has that of its near end.
vec4 path_to(int beam, vec3 p, out float open)
{
	float rho;
	vec4 w = way_at(beam, p, rho);
	open = rim_open(rho, p, w.xyz, rim_light.w);
	return w;
}

#ifdef SHADOWS
// The steepest slope that the relief rises to from a texel, in one of sixteen azimuths: horizon.frag.
float horizon(ivec2 at, int azimuth)
{
	return texelFetch(horizon_map, at + (map_size >> level) * ivec2(azimuth >> 2 & 1, azimuth >> 3), 0)[azimuth & 3];
}

// Share of the light that comes in over the horizon, which is linear between azimuths: sources are 0.15 wide; tissue that
// stands around in the light fills shadows in.
float shadow(ivec2 at, vec3 l)
{
	const float STEP = 0.39269908;
	float across = max(length(l.xy), 1e-6), turn = atan(l.y, l.x) / STEP, whole = floor(turn);
	int azimuth = int(whole) & 15;
	float steepest = mix(horizon(at, azimuth), horizon(at, azimuth + 1 & 15), turn - whole);
	return LOOK_FILL + (1.0 - LOOK_FILL) * clamp((-l.z / across - steepest) / LOOK_SOURCE, 0.0, 1.0);
}
#endif

// Single scattering in both layers over the epithelium, all beams: the march of lib/draw/eye/march/march.c.
vec3 scatter(ivec2 texel, vec3 p, vec3 v)
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
		float open, unused;
		vec4 near_light = path_to(b, p, open), far_light = path_to(b, p + span * v, unused), lit = vec4(0.0);
#ifdef SHADOWS
		open *= shadow(texel, near_light.xyz);
#endif
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
	return max(sum * exposure, 0.0) * textureLod(beside_map, map_place(p.xy), 0.0).rgb;
}

// What the photograph's colour is multiplied by: lib/draw/eye/colour.c.
vec3 ratio(vec3 rgb, vec3 model)
{
	vec3 k = rgb / model;
	float mean = (k.r + k.g + k.b) / 3.0, lit = min(mean, ratio_most);
	k = clamp(k * (lit / max(mean, 1e-6)), lit / ratio_chroma, lit * ratio_chroma);
	return detail >= 1.0 ? k : pow(max(k, 1e-5), vec3(detail)) * pow(max(tissue_gain * rgb, 1e-5), vec3(1.0 - detail));
}

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	float texel = 2.0 * extent / float(map_size >> level);
	vec2 q = (vec2(at) + 0.5) * texel - extent, xy = shrink(q);
	light = vec4(0.0, 0.0, 0.0, 1.0);
	if (!marched(q, texel))
		return;
	vec3 p = vec3(xy, iris_depth - relief_at(xy).x), sight;
	float unused;
	sight = -normalize(path_to(beams, vec3(xy, iris_depth), unused).xyz);
	sight.z = max(sight.z, 0.2);  // flatter, nobody sees it
	light.rgb = ratio(scatter(at, p, sight), texelFetch(model_map, at + ivec2(0, model_top), 0).rgb);
	light.rgb *= pow(textureLod(own_map, q / (2.0 * extent) + 0.5, 0.0).r, own * detail);
}
