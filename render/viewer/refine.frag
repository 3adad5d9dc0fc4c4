// A table of the light's ways on SIDE x SIDE points made one on GRID x GRID: Catmull and Rom's cubics, linear at the border;
// lib/draw/eye/march/beam.c.
uniform sampler2D path_map, down_map;
layout(location = 0) out vec4 way;
layout(location = 1) out float down;

vec4 cubic(int i, out int at)
{
	float x = float(i) * float(SIDE - 1) / float(GRID - 1);
	at = clamp(int(x) - 1, 0, SIDE - 4);
	float t = x - float(at + 1), u = t * t;
	if (t < 0.0)
		return vec4(-t, 1.0 + t, 0.0, 0.0);
	if (t > 1.0)
		return vec4(0.0, 0.0, 2.0 - t, t - 1.0);
	return 0.5 * vec4(2.0 * u - t - t * u, 2.0 - 5.0 * u + 3.0 * t * u, t + 4.0 * u - 3.0 * t * u, t * u - u);
}

void main()
{
	ivec2 texel = ivec2(gl_FragCoord.xy), tile = texel / GRID, cell = texel - tile * GRID, at;
	vec4 wx = cubic(cell.x, at.x), wy = cubic(cell.y, at.y);
	at += tile * SIDE;
	way = vec4(0.0);
	down = 0.0;
	for (int v = 0; v < 4; v++)
		for (int u = 0; u < 4; u++) {
			float w = wx[u] * wy[v];
			way += w * texelFetch(path_map, at + ivec2(u, v), 0);
			down += w * texelFetch(down_map, at + ivec2(u, v), 0).r;
		}
}
