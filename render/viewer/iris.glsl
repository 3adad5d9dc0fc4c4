// The iris as a ray behind the cornea meets it: lib/eye/scene_meet.c, scene_pupil.c; and all that the eye is told.
uniform vec3 origin;              // of all rays: the camera, eye frame
uniform mat3 eye_from_cam, env_from_eye;
uniform vec4 lens;                // focal length, middle (px of the camera), px of the camera in one of the picture
uniform vec2 corner, size, jitter;
uniform mat3 slip;
uniform vec2 limbus;
uniform vec4 back;                // of the cornea: sight()
uniform float sclera_reach;       // angle at the edge of the maps of the sclera
uniform vec3 sclera;              // z of its centre, radius, width of the limbus over its radius
uniform float pixel;              // mm on the iris
uniform vec2 heights;
uniform sampler2D colour_map, light_map, vein_map, film_map, sharp_map, rough_map;
uniform float detail;
uniform int search;
uniform vec3 quadric[9], even;    // irradiance of the environment
uniform float mirror_on, tear;
out vec4 seen;

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

// The photograph's colour times what the march changes it by (march.frag).
vec3 iris(vec3 f, vec3 v)
{
	f.xy += (slip * vec3(f.xy, 1.0)).xy;
	v.xy += mat2(slip) * v.xy;
	float along, across;
	vec3 p = meet(f, v), cover = pupil_cover(p.xy);
	if (cover.r <= 0.0)
		return vec3(0.0);
	vec2 at = map_place(stretch(p.xy, along, across));
	vec3 shown = textureLod(colour_map, at, float(level)).rgb;
	if (detail < 1.0)
		shown = pow(max(shown, 1e-5), vec3(detail));
	return shown * textureLod(light_map, at, 0.0).rgb * cover;
}
