// Light that a lens scatters, step by step as lib/draw/bloom.c has it.
uniform sampler2D picture;
uniform vec3 gain;
uniform int what;  // 0: the picture as it is seen; 1: half as large; 2: what is half as large, enlarged
uniform vec2 size;
out vec4 light;

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
				light += w[i] * w[j] * texelFetch(picture, held(picture, 2 * p + ivec2(i - 1, j - 1)), 0);
	} else {
		light = enlarged(picture, p);
	}
}
