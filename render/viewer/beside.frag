// Light that comes to a place through the tissue beside it: lib/draw/eye/march/beside.c, in three passes. 0: where light falls; 1: spread along
// x; 2: spread along y, over what the march takes there.
uniform int part;
uniform vec3 keep;                // by channel: what is left of a step's light at the next
uniform sampler2D lit_map;        // of the pass before
out vec4 light;

const int REACH = 12;

vec3 lit_at(ivec2 p)
{
	p = abs(p + ivec2(lessThan(p, ivec2(0))));  // mirrored beyond the borders
	return texelFetch(lit_map, min(p, 2 * BESIDE - 1 - p), 0).rgb;
}

vec3 spread_along(ivec2 at, ivec2 step)
{
	vec3 sum = lit_at(at), all = vec3(1.0), left = keep;
	for (int i = 1; i <= REACH; i++) {
		sum += left * (lit_at(at + i * step) + lit_at(at - i * step));
		all += 2.0 * left;
		left *= keep;
	}
	return sum / all;
}

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	vec3 p = vec3((vec2(at) + 0.5) / float(BESIDE) * 2.0 * extent - extent, iris_depth);
	if (part == 0)
		light = vec4(lit_plane(p, 0.0) + LOOK_BESIDE_DARK, 1.0);
	else if (part == 1)
		light = vec4(spread_along(at, ivec2(1, 0)), 1.0);
	else
		light = vec4(spread_along(at, ivec2(0, 1)) / (lit_plane(p, rim_light.w) + LOOK_BESIDE_DARK), 1.0);
}
