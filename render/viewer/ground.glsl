// The iris' ground: where its tissue is as the pupil is now, and how it lies.
uniform float iris_depth;
uniform vec3 pupil;               // as fitted: x, y, radius, in the iris plane
uniform float pupil_now;
uniform int level, map_size;      // level: of the maps of relief and colour
uniform sampler2D relief_map;

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

// The same place as stretch() knows it, the other way round.
vec2 shrink(vec2 q)
{
	vec2 d = q - pupil.xy;
	float r = length(d), root = rim * 1.02;
	if (abs(pupil_now - pupil.z) < 1e-4 || r >= root)
		return q;
	return pupil.xy + d * ((pupil_now + (r - pupil.z) * (root - pupil_now) / (root - pupil.z)) / max(r, 1e-3));
}

// Whether a picture may show the map's place q, texels apart.
bool marched(vec2 q, float texel)
{
	return length(q) < 1.06 * rim + 3.0 * texel && length(q - pupil.xy) > pupil.z - 0.1 - 3.0 * texel;
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
