// A ray of sight for each pixel: lib/draw/eye/exact/trace.c, draw/eye/sclera.c. With CROSSINGS it only finds where the ray goes, which does
// not depend on light; with KEPT it shades what was found so.
vec3 environment(vec3 r, float rough)
{
	vec2 u = unfolded(env_from_eye * r);
	return mix(textureLod(sharp_map, u, 0.0).rgb, textureLod(rough_map, u, 0.0).rgb, rough);
}

// As envmap_wet_at.
vec3 below_film(vec3 normal)
{
	vec3 d = env_from_eye * normal;
	float x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z, yz = y * z;
	vec3 quartic = xx * (xx * wet_light[3] + x * (y * wet_light[4] + z * wet_light[5]) + yy * wet_light[6] + yz * wet_light[7] + zz * wet_light[8]) + x * (yy * (y * wet_light[9] + z * wet_light[10]) + zz * (y * wet_light[11] + z * wet_light[12]))
	               + yy * (yy * wet_light[13] + yz * wet_light[14] + zz * wet_light[15]) + zz * (yz * wet_light[16] + zz * wet_light[17]);
	return max(x * wet_light[0] + y * wet_light[1] + z * wet_light[2] + quartic, 0.0);
}

// The white of the eye: diffuse below its film, whose ripples turn the normal.
vec3 white(inout vec3 normal, vec3 at, float rho)
{
	vec3 light = below_film(normal), d = at - vec3(0.0, 0.0, sclera.x);
	float flat_ = length(d.xy), r = atan(flat_, -d.z) / sclera_reach;
	vec2 u = 0.5 + 0.5 * r * d.xy / max(flat_, 1e-6);
	vec3 albedo = textureLod(vein_map, u, 0.0).rgb;
	normal = normalize(normal + vec3(textureLod(film_map, u, 0.0).rg, 0.0));
	float edge = 1.0 - step_smooth(LOOK_RIM_FROM, LOOK_RIM_TO, rho);
	return albedo * light * (1.0 - vec3(LOOK_RIM_DARK) * edge * edge);
}

// Unit direction behind the cornea of a ray d that meets it at `from`, which becomes the place where that direction starts:
// lib/optics/cornea/cornea.c. back: radius, asphericity, depth of the posterior surface's apex, index of the cornea; index 0: none.
vec3 sight(inout vec3 from, vec3 d)
{
	vec3 N = normalize(vec3(from.xy, cornea_p * from.z - cornea_R));
	vec3 v = refract(d, N, 1.0 / (back.w > 0.0 ? back.w : cornea_n));
	if (back.w <= 0.0)
		return v;
	vec3 o = from - vec3(0.0, 0.0, back.z);
	float A = dot(v.xy, v.xy) + back.y * v.z * v.z, B = dot(o.xy, v.xy) + (back.y * o.z - back.x) * v.z;
	float C = dot(o.xy, o.xy) + o.z * (back.y * o.z - 2.0 * back.x), disc = max(B * B - A * C, 0.0);
	from += v * max(B < 0.0 ? C / (sqrt(disc) - B) : -(B + sqrt(disc)) / A, 0.0);
	N = normalize(vec3(from.xy, back.y * (from.z - back.z) - back.x));
	return refract(v, N, back.w / cornea_n);
}

#ifdef KEPT
uniform sampler2D kept_map;
#endif

// From the point of the ray nearest to the apex: no digits are lost.
float begin(vec3 o, vec3 d)
{
	return max(0.0, -dot(o, d));
}

float rho_of(vec3 at)
{
	return at.z < sclera.x ? length(at.xy / limbus) : 2.0;
}

// Share of the white at the limbus.
float lid_of(float rho)
{
	return step_smooth(1.0 - 0.5 * sclera.z, 1.0 + 0.5 * sclera.z, rho);
}

// Where a ray meets the eye: how far behind begin(); the place on the iris that it comes to; 1 on the cornea, 2 and how much of
// the pixel the eye covers on the sclera, 0 nowhere.
vec4 crossing(vec3 o, vec3 d)
{
	vec3 n = o + begin(o, d) * d;
	float A = dot(d.xy, d.xy) + cornea_p * d.z * d.z, B = dot(n.xy, d.xy) + (cornea_p * n.z - cornea_R) * d.z;
	float C = dot(n.xy, n.xy) + n.z * (cornea_p * n.z - 2.0 * cornea_R), disc = B * B - A * C;
	float t = disc >= 0.0 ? (B < 0.0 ? C / (sqrt(disc) - B) : -(B + sqrt(disc)) / A) : 1e9;
	vec3 K = n + t * d;
	bool hit = disc >= 0.0 && cornea_p * K.z <= cornea_R && length(K.xy) <= 1.06 * rim;
	vec3 m = n - vec3(0.0, 0.0, sclera.x);
	float b = dot(m, d), miss = sqrt(max(dot(m, m) - b * b, 0.0)), in_sphere = sclera.y * sclera.y - miss * miss;
	float ts = in_sphere > 0.0 ? -b - sqrt(in_sphere) : 1e9;
	bool on_sclera = ts < 1e8 && (!hit || ts < t);
	if (!hit && !on_sclera)
		return vec4(0.0);
	vec2 place = vec2(0.0);
	if (hit && lid_of(rho_of(n + (on_sclera ? ts : t) * d)) < 1.0) {
		vec3 from = K, inside = sight(from, d);
		place = iris_place(from, inside);
	}
	// On the sclera where the cornea's surface is met behind it: its iris still shows in the limbus.
	return vec4(on_sclera ? ts : t, place, on_sclera ? (hit ? 3.5 : 2.0) + clamp((sclera.y - miss) / pixel, 0.0, 1.0) : 1.0);
}

#ifndef CROSSINGS
// Radiance from a ray that crosses the eye so, and how much of the pixel the eye covers.
vec4 look(vec3 o, vec3 d, vec4 met, out float far)
{
	far = 1e9;
	if (met.w == 0.0)
		return vec4(0.0);
	bool hit = met.w == 1.0 || met.w >= 3.5;
	float cover = met.w == 1.0 ? 1.0 : met.w - (met.w >= 3.5 ? 3.5 : 2.0);
	vec3 at = o + begin(o, d) * d + met.x * d;
	far = begin(o, d) + met.x;
	// The corneal normal turns into the sphere's across the sulcus: no crease stands where they meet.
	float rho = rho_of(at);
	vec3 front = normalize(vec3(at.xy, cornea_p * at.z - cornea_R)), round_ = (at - vec3(0.0, 0.0, sclera.x)) / sclera.y;
	vec3 normal = normalize(mix(front, round_, step_smooth(LOOK_SEAM_FROM, LOOK_SEAM_TO, rho)));
	float cos_i = -dot(normal, d), lid = hit ? lid_of(rho) : 1.0;
	vec3 rgb = vec3(0.0);
	if (lid < 1.0)
		rgb = (1.0 - lid) * iris(met.yz);
	if (lid > 0.0)
		rgb += lid * white(normal, at, rho);
	rgb *= 1.0 - mirror_share(cos_i, LOOK_FILM_INDEX);  // what the film mirrors does not come back from below
	if (mirror_on > 0.0) {
		float rough = LOOK_FILM_ROUGH * step_smooth(LOOK_FILM_FROM, LOOK_FILM_TO, rho) * clamp(1.5 - 0.5 * tear, 0.0, 1.33);
		rgb += mirror_on * mirror_share(cos_i, LOOK_FILM_INDEX) * environment(d + 2.0 * cos_i * normal, rough);
	}
#ifdef LIDS
	rgb = below_lids(rgb, at, d);
	cover = 1.0;
#endif
	return vec4(rgb * cover, cover);
}
#endif

// Of a point of the picture, px; camera's axes.
vec3 ray_at(vec2 px)
{
	return vec3((corner + lens.w * px - lens.yz) / lens.x, 1.0);
}

void main()
{
#ifdef CROSSINGS
	seen = crossing(origin, normalize(eye_from_cam * ray_at(vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) + jitter)));
#else
#ifdef LIDS
	if (texelFetch(lid_map, ivec2(gl_FragCoord.xy), 0).z <= 0.0)
		discard;  // skin stands before it
#endif
	vec3 ray = ray_at(vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) + jitter), dir = normalize(eye_from_cam * ray);
	float far;
#ifdef KEPT
	vec4 c = look(origin, dir, texelFetch(kept_map, ivec2(gl_FragCoord.xy), 0), far);
#else
	vec4 c = look(origin, dir, crossing(origin, dir), far);
#endif
#ifdef LIDS
	if (c.a == 0.0)
		discard;
	gl_FragDepth = 0.5 + 0.5 * (depth.x + depth.y / (far / length(ray) * depth.z));
#endif
	seen = vec4(min(c.rgb, 2.0), c.a);  // a mirror image brighter than white counts as a little more than white
#endif
}
