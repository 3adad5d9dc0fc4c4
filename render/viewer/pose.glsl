// A character's pose, in passes that write vertices to buffers: lib/rig/deform/deform.c, draw/face/mesh.c, draw/face/lash.c. The rig's own
// axes, mm.
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D at_map, normal_map, light_map;
uniform int first;                // the page's number of the first vertex of the pass

vec4 of(sampler2D map, int i)
{
	return texelFetch(map, ivec2(i % WIDE, i / WIDE), 0);
}

#ifdef DEFORM
// Algorithm 1 of the skin paper: where the skin's coordinates are on the skull, and out of the globe. And light, between poses.
layout(location = 0) in vec4 chart;     // mean, thickness t, gap delta0 + t
layout(location = 1) in vec4 hold;      // glue, side, whether it moves, share of the left eye's lids
layout(location = 2) in vec4 offset;    // at rest less the skull there, of what never moves its place; its number in settle_map plus 1, 0: it is not there
layout(location = 3) in mat4 basis;     // U~, four vectors: x, then y
uniform vec4 component[4];              // e: as the left eye has its lids, as the right one has
uniform sampler2D skull_map, globe_map, pose_map;
uniform vec3 skull_grid;                // px of the first texel, texels a px
uniform vec2 skull_most;                // the last place between texels
uniform vec4 skull_part;                // texels that the page has: from, size
uniform int cells;                      // of a globe's map, across
uniform mat3 globe_from_rig[2];
uniform vec3 globe_center[2];
uniform vec3 lit[LIT];                  // pose, weight for the left side, for the right
uniform int n_lit, lit_rows;            // lit_rows: of one pose in pose_map
uniform sampler2D settle_map;           // how far lids are moved that their margins be arcs (rig/deform/arc.h), in poses of their own: 128 is not
uniform float settle_step;              // mm; 0: they stay as they were learnt
uniform int settle_rows, n_settled;     // settle_rows: of one pose
uniform vec3 settled[LIT];              // as lit
out vec4 at_now, light_now;

vec3 skull(ivec2 at)
{
	return texelFetch(skull_map, clamp(at - ivec2(skull_part.xy), ivec2(0), ivec2(skull_part.zw) - 1), 0).xyz;
}

// D on the octahedron: lib/rig/globe_map.h.
float radius(vec3 d, int side)
{
	float top = float(cells);
	vec3 p = d / (abs(d.x) + abs(d.y) + abs(d.z));
	vec2 u = p.z < 0.0 ? (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0) : p.xy;
	u = min(0.5 * (u + 1.0) * top, top - 1e-3);
	ivec2 i = ivec2(u);
	u -= vec2(i);
	i.y += side * (cells + 1);
	float a = texelFetch(globe_map, i, 0).r, b = texelFetch(globe_map, i + ivec2(1, 0), 0).r;
	float c = texelFetch(globe_map, i + ivec2(0, 1), 0).r, e = texelFetch(globe_map, i + 1, 0).r;
	return (1.0 - u.y) * ((1.0 - u.x) * a + u.x * b) + u.y * ((1.0 - u.x) * c + u.x * e);
}

// In the order of the C code, so that rounding differs less.
float sum_of(vec4 v)
{
	return (v.x + v.y) + (v.z + v.w);
}

void main()
{
	vec3 sum = vec3(0.0);
	for (int k = 0; k < n_lit; k++)
		sum += mix(lit[k].z, lit[k].y, hold.w) * texelFetch(pose_map, ivec2(gl_VertexID % WIDE, int(lit[k].x) * lit_rows + gl_VertexID / WIDE), 0).rgb;
	light_now = vec4(max(sum, 0.0), 0.0);
	at_now = vec4(offset.xyz, 0.0);
	if (hold.z == 0.0)
		return;
	vec4 e = mix(component[2], component[0], hold.w), f = mix(component[3], component[1], hold.w);
	vec2 u = chart.xy + vec2(sum_of(basis[0] * e), sum_of(basis[2] * e));
	u += vec2(sum_of(basis[1] * f), sum_of(basis[3] * f));
	u = clamp((u - skull_grid.xy) * skull_grid.z, vec2(0.0), skull_most);
	ivec2 i = ivec2(u);
	u -= vec2(i);
	vec3 p = skull(i), q = skull(i + ivec2(1, 0));
	vec3 left = p + u.y * (skull(i + ivec2(0, 1)) - p), right = q + u.y * (skull(i + 1) - q);
	int side = int(hold.y);
	vec3 x = left + u.x * (right - left) + offset.xyz - globe_center[side];
	float far = length(x) + 1e-12, D = radius(globe_from_rig[side] * x, side), pushed = max(far, D + chart.z);
	at_now.xyz = globe_center[side] + (pushed + hold.x * (D + chart.w - pushed)) / far * x;
	if (offset.w == 0.0 || settle_step == 0.0)
		return;
	int at = int(offset.w) - 1;
	vec3 by = vec3(0.0);
	for (int k = 0; k < n_settled; k++)
		by += mix(settled[k].z, settled[k].y, hold.w) * (255.0 * texelFetch(settle_map, ivec2(at % WIDE, int(settled[k].x) * settle_rows + at / WIDE), 0).rgb - 128.0);
	at_now.xyz += settle_step * by;
}
#endif

#ifdef NORMAL
// Normals of the rig's own vertices: the mean of the faces round each, weighted by area.
layout(location = 0) in vec2 ring;      // first of its pairs of neighbours, how many
uniform sampler2D ring_map;
out vec4 normal_now;

void main()
{
	vec3 a = of(at_map, first + gl_VertexID).xyz, sum = vec3(0.0);
	for (int k = 0; k < int(ring.y); k++) {
		vec4 pair = of(ring_map, int(ring.x) + k);
		sum += cross(of(at_map, int(pair.x)).xyz - a, of(at_map, int(pair.y)).xyz - a);
	}
	float len = length(sum);
	normal_now = vec4(len > 0.0 ? sum / len : vec3(0.0, 0.0, 1.0), 0.0);
}
#endif

#ifdef BETWEEN
// The middle of an edge on the curved surface of its ends' normals (Phong tessellation).
layout(location = 0) in vec2 ends;
out vec4 at_now, normal_now, light_now;

void main()
{
	int i = int(ends.x), k = int(ends.y);
	vec3 a = of(at_map, i).xyz, b = of(at_map, k).xyz, na = of(normal_map, i).xyz, nb = of(normal_map, k).xyz, p = 0.5 * (a + b), n = na + nb;
	float len = dot(n, n);
	at_now = vec4(p - 0.5 * (dot(p - a, na) * na + dot(p - b, nb) * nb), 0.0);
	normal_now = vec4(len > 1e-12 ? n / sqrt(len) : n, 0.0);
	light_now = 0.5 * (of(light_map, i) + of(light_map, k));
}
#endif

#ifdef HAIR
// A hair's vertex in the frame of its root: off the globe, along the lid, up over it.
layout(location = 0) in vec4 root;      // three vertices, side
layout(location = 1) in vec4 weight;
layout(location = 2) in vec4 pinned;
uniform vec3 globe_center[2], outward;  // outward: of the left eye
out vec4 at_now;

void main()
{
	int side = int(root.w);
	float turn = side == 1 ? -1.0 : 1.0;
	vec3 at = weight.x * of(at_map, int(root.x)).xyz + weight.y * of(at_map, int(root.y)).xyz + weight.z * of(at_map, int(root.z)).xyz;
	vec3 off = normalize(at - globe_center[side]), up = normalize(turn * cross(off, turn * outward)), along = turn * cross(up, off);
	at_now = vec4(at + pinned.x * off + pinned.y * along + pinned.z * up, 0.0);
}
#endif
