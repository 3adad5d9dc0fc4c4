// Skin of a driven character: posed on the page (pose.glsl), seen in the head's axes (x to the person's left, y up, z out of the
// face; middle of both eyes), mm.
precision highp sampler2D;
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 light;
layout(location = 3) in vec4 skin;
layout(location = 4) in vec3 rest;
layout(location = 5) in vec2 home;  // in the chart of wrinkles, px
uniform mat3 cam_from_head, head_from_rig;
uniform vec3 middle;              // of both eyes, the rig's axes
uniform vec3 camera;              // focal length over half the width, over half the height; distance
uniform vec2 clip_depth, shift;
uniform sampler2D at_map;         // all of `at`
uniform int first_hair;           // from there vertices are pairs across a hair
uniform vec2 hair_px;             // focal length; a hair's least width
out vec3 seen_at, seen_normal, seen_light, seen_rest;
out vec4 seen_skin;
out vec2 seen_home;
out float seen_cover;             // of a hair as thick as it is, by one as thick as it is drawn

void main()
{
	vec3 place = at;
	seen_cover = 1.0;
	if (gl_VertexID >= first_hair) {
		// Never thinner than pixels lie apart; it lets through what it covers too much then: lib/draw/face/lash.c.
		int mate = first_hair + ((gl_VertexID - first_hair) ^ 1), wide = textureSize(at_map, 0).x;
		vec3 off = 0.5 * (at - texelFetch(at_map, ivec2(mate % wide, mate / wide), 0).xyz);
		seen_cover = min(1.0, 2.0 * length(off) * hair_px.x / (camera.z * hair_px.y));
		place += off * (1.0 / max(seen_cover, 0.02) - 1.0);
	}
	seen_at = head_from_rig * (place - middle);
	vec3 p = cam_from_head * seen_at + vec3(0.0, 0.0, camera.z);
	gl_Position = vec4(vec2(camera.x * p.x, -camera.y * p.y) + shift * p.z, clip_depth.x * p.z + clip_depth.y, p.z);
	seen_normal = head_from_rig * normal;
	seen_light = light;
	seen_rest = rest;
	seen_skin = skin;
	seen_home = home;
}
