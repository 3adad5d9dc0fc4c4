// Light that a lens scatters, step by step as lib/draw/bloom.c has it.
uniform sampler2D picture;
uniform vec3 gain;
uniform int what;  // 0: the picture as it is seen; 1: half as large; 2: what is half as large, enlarged
uniform vec2 size;
out vec4 light;

ivec2 held(ivec2 p)
{
	return clamp(p, ivec2(0), textureSize(picture, 0) - 1);
}

void main()
{
	ivec2 p = ivec2(gl_FragCoord.xy);
	light = vec4(0.0);
	if (what == 0) {
		light.rgb = min(on_grey(picture, gl_FragCoord.xy / size, gain), 6e4);
	} else if (what == 1) {
		const float w[4] = float[](0.125, 0.375, 0.375, 0.125);
		for (int j = 0; j < 4; j++)
			for (int i = 0; i < 4; i++)
				light += w[i] * w[j] * texelFetch(picture, held(2 * p + ivec2(i - 1, j - 1)), 0);
	} else {
		ivec2 a = p / 2, b = held(a + 2 * (p & 1) - 1);
		light = (9.0 * texelFetch(picture, a, 0) + 3.0 * texelFetch(picture, ivec2(b.x, a.y), 0) + 3.0 * texelFetch(picture, ivec2(a.x, b.y), 0) + texelFetch(picture, b, 0)) / 16.0;
	}
}
