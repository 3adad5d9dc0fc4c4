// Wrinkles of expressions: the subject's bump maps where its skin would be, as strong as the expressions; lib/draw/face/wrinkle_map.c,
// draw/face/wrinkle.c.
in vec2 seen_home;
uniform sampler2D fold_map;       // one below the other
uniform int folds;
uniform float fold_strength[LIGHTS];
uniform vec2 fold_size;           // px of one map
uniform vec2 fold_scale;          // of the subject: mm in one of the character's, px in one of the character's mm

// Height in x, mm; share of sky in y.
vec2 fold_at(vec2 px, int k)
{
	vec4 t = textureLod(fold_map, vec2(px.x / fold_size.x, (px.y / fold_size.y + float(k)) / float(folds)), 0.0);
	return vec2(t.r + t.b, t.g);
}

// Slope over the face of what folds at this place; sky: the share of it that is left.
vec3 folded(vec3 normal, vec3 at, out float sky)
{
	vec3 ex = dFdx(at), ey = dFdy(at);
	vec2 hx = dFdx(seen_home), hy = dFdy(seen_home), slope = vec2(0.0), px = seen_home;
	sky = 1.0;
	if (px.x <= 1.0 || px.y <= 1.0 || px.x >= fold_size.x - 1.0 || px.y >= fold_size.y - 1.0)
		return vec3(0.0);
	for (int k = 0; k < LIGHTS; k++) {
		if (k >= folds || fold_strength[k] <= 0.0)
			continue;
		const vec2 d = vec2(SKIN_FOLD_STEP, 0.0);
		float open = fold_at(px, k).y;
		slope += fold_strength[k] / (2.0 * SKIN_FOLD_STEP) * vec2(fold_at(px + d.xy, k).x - fold_at(px - d.xy, k).x, fold_at(px + d.yx, k).x - fold_at(px - d.yx, k).x);
		sky *= 1.0 - fold_strength[k] * (1.0 - open);
	}
	float a = dot(ex, ex), b = dot(ex, ey), c = dot(ey, ey), det = a * c - b * b;
	// The chart's y points down: > 0 where the modelling camera saw its front; all but edge-on it saw no lines.
	float seen_ = (hx.y * hy.x - hx.x * hy.y) * sign(dot(cross(ex, ey), normal));
	if (det <= 0.0 || seen_ <= 0.1 * fold_scale.y * fold_scale.y * sqrt(det)) {
		sky = 1.0;
		return vec3(0.0);
	}
	vec2 rise = vec2(dot(slope, hx), dot(slope, hy));
	return ((rise.x * c - rise.y * b) * ex + (rise.y * a - rise.x * b) * ey) / (det * fold_scale.x);
}
