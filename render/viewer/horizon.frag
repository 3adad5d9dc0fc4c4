// Slopes to which the relief rises from the texels that light is marched from, in sixteen azimuths, looked at where
// lib/draw/eye/march/shadow.c does: four to a channel each, the next four beside them, eight more below. They are valid as long as the pupil
// does not change.
uniform vec2 heights;
uniform float shadow_grow;        // of the distances at which the relief is looked at
out vec4 slopes;

float horizon(vec2 p, float own, float texel, float turn)
{
	float steepest = -1.0, off = texel, reach = 2.0 * (heights.y - heights.x);
	vec2 to = vec2(cos(turn), sin(turn));
	for (int k = 0; k < 24; k++) {
		if (off >= reach || 0.5 * off >= heights.y - own)
			break;
		steepest = max(steepest, (relief_at(p + off * to).x - own - LOOK_BIAS) / off);
		off += max(texel, shadow_grow * off);
	}
	return steepest;
}

void main()
{
	const float STEP = 0.39269908;
	int n = map_size >> level;
	ivec2 at = ivec2(gl_FragCoord.xy), part = at / n;
	float texel = 2.0 * extent / float(n), first = 4.0 * float(part.x + 2 * part.y);
	vec2 q = (vec2(at - n * part) + 0.5) * texel - extent;
	slopes = vec4(0.0);
	if (!marched(q, texel))
		return;
	vec2 p = shrink(q);
	float own = relief_at(p).x;
	slopes = vec4(horizon(p, own, texel, first * STEP), horizon(p, own, texel, (first + 1.0) * STEP), horizon(p, own, texel, (first + 2.0) * STEP),
	              horizon(p, own, texel, (first + 3.0) * STEP));
}
