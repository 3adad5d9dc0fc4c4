// The iris as a ray behind the cornea meets it: lib/draw/eye/march/meet.c, draw/eye/pupil.c; and the eye's uniforms.
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
uniform int search;               // steps of the search for the relief
uniform sampler2D colour_map, light_map, tint_map, vein_map, film_map, sharp_map, rough_map;
uniform float detail;
uniform vec3 wet_light[18];          // irradiance below a film: lib/image/envmap/envmap.h
uniform float mirror_on, tear;
out vec4 seen;

// Depth of the ray below the relief at t.
float below(vec3 f, vec3 v, float t)
{
	vec3 p = f + t * v;
	return p.z - iris_depth + relief_at(p.xy).x;
}

// The first point at which a ray meets the relief, which may occlude itself: lib/draw/eye/march/meet.c.
float search_relief(vec3 f, vec3 v, float a, float e)
{
	float stride = (e - a) / float(search), fa = -1e-6, b = a, fb = fa;
	for (int k = 0; k < SEARCH; k++) {
		b += stride;
		fb = below(f, v, b);
		if (fb >= 0.0 || k + 1 >= search)
			break;
		a = b;
		fa = fb;
	}
	for (int k = 0; k < 2; k++) {
		float t = a - fa * (b - a) / (fb - fa + 1e-12), ft = below(f, v, t);
		if (ft >= 0.0) {
			b = t;
			fb = ft;
		}
		else {
			a = t;
			fa = ft;
		}
	}
	return fb - fa > 1e-12 ? a - fa * (b - a) / (fb - fa) : b;
}

// Where the ray meets the relief; of a ray that leans little by Newton's steps from the iris plane: lib/draw/eye/quick/quick.c.
vec3 meet(vec3 f, vec3 v)
{
	float c = max(v.z, 0.1), low = (iris_depth - heights.y - f.z) / c, high = (iris_depth - heights.x - f.z) / c, t = (iris_depth - f.z) / c;
	if (dot(v.xy, v.xy) > LOOK_LEANS * LOOK_LEANS * v.z * v.z)
		return f + search_relief(f, vec3(v.xy, c), low - 1e-4, high + 1e-4) * v;
	for (int k = 0; k < 2; k++) {
		vec3 p = f + t * v;
		vec4 h = relief_slope(p.xy);
		t = clamp(t - (p.z - iris_depth + h.x) / max(c + dot(h.zw, v.xy), 0.3), low, high);
	}
	return f + t * v;
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

// Where a ray from f behind the cornea meets the iris.
vec2 iris_place(vec3 f, vec3 v)
{
	f.xy += (slip * vec3(f.xy, 1.0)).xy;
	v.xy += mat2(slip) * v.xy;
	return meet(f, v).xy;
}

// The photograph's colour times what the march changes it by (march.frag).
vec3 iris(vec2 p)
{
	float along, across;
	vec3 cover = pupil_cover(p);
	if (cover.r <= 0.0)
		return vec3(0.0);
	vec2 at = map_place(stretch(p, along, across));
	vec3 shown = textureLod(colour_map, at, float(level)).rgb;
	if (detail < 1.0)
		shown = pow(max(shown, 1e-5), vec3(detail)) * pow(textureLod(tint_map, at, 0.0).rgb, vec3(1.0 - detail));
	return shown * textureLod(light_map, at, 0.0).rgb * cover;
}
