// Distance to the lid's edge across the screen, exact on the mask (Saito and Toriwaki 1994): for each pixel the nearest skin in
// its row, then over rows the nearest of those. shown: px to it (x, y), their length; far: none within reach.
uniform sampler2D picture;        // pass 0: skin as drawn, cover 1; pass 1: what pass 0 found
uniform int rows, reach;
out vec4 shown;
const float FAR = 1e3;

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy), most = textureSize(picture, 0) - 1;
	vec3 best = vec3(FAR, FAR, FAR);
	for (int k = 0; k <= 64; k++) {
		if (k > reach || float(k) >= best.z)
			break;
		for (int side = -1; side <= 1; side += 2) {
			ivec2 p = clamp(at + (rows == 1 ? ivec2(0, k * side) : ivec2(k * side, 0)), ivec2(0), most);
			vec4 t = texelFetch(picture, p, 0);
			vec2 off = rows == 1 ? vec2(t.x, float(p.y - at.y)) : vec2(p.x - at.x, 0.0);
			float far = length(off);
			if ((rows == 1 ? t.z < FAR : t.a > 0.995) && far < best.z)
				best = vec3(off, far);
		}
	}
	shown = vec4(best, 1.0);
}
