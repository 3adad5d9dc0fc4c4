precision highp float;
precision highp int;
precision highp sampler2D;
// What the passes share. Eye frame as in lib/draw/eye/scene.h: origin at the corneal apex, z into the eye, mm.
uniform float cornea_R, cornea_p, cornea_n;
uniform float extent;   // half-width of the iris maps
uniform vec2 beam_z;    // depths of the two planes of a beam's table
uniform float rim;      // the limbus, horizontally

float step_smooth(float lo, float hi, float x)
{
	float t = clamp((x - lo) / (hi - lo), 0.0, 1.0);
	return t * t * (3.0 - 2.0 * t);
}

// Fresnel reflectance, unpolarised, from air into index n.
float mirror_share(float cos_i, float n)
{
	float c = max(cos_i, 0.0), t = sqrt(n * n - 1.0 + c * c);
	float s = (c - t) / (c + t), p = (n * n * c - t) / (n * n * c + t);
	return 0.5 * (s * s + p * p);
}

// Place in a map on the octahedron unfolded about -z: lib/image/envmap/envmap.h.
vec2 unfolded(vec3 d)
{
	d /= abs(d.x) + abs(d.y) + abs(d.z);
	vec2 u = d.z > 0.0 ? vec2(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0) * (1.0 - abs(d.yx)) : d.xy;
	return 0.5 * u + 0.5;
}

// A picture as it is seen: on a photographer's grey, which falls off towards the corners (lib/draw/studio.c).
vec3 on_grey(sampler2D picture, vec2 at, vec3 gain)
{
	vec2 u = 2.0 * at - 1.0;
	vec4 p = texture(picture, at);
	return p.rgb * gain + (1.0 - p.a) * mix(0.115, 0.030, min(dot(u, u) / 2.0, 1.0));
}

ivec2 held(sampler2D picture, ivec2 p)
{
	return clamp(p, ivec2(0), textureSize(picture, 0) - 1);
}

// A pixel of what is half as large, enlarged: add_enlarged of lib/draw/bloom.c.
vec4 enlarged(sampler2D half_size, ivec2 p)
{
	ivec2 a = p / 2, b = held(half_size, a + 2 * (p & 1) - 1);
	return (9.0 * texelFetch(half_size, a, 0) + 3.0 * texelFetch(half_size, ivec2(b.x, a.y), 0) + 3.0 * texelFetch(half_size, ivec2(a.x, b.y), 0) + texelFetch(half_size, b, 0)) / 16.0;
}
