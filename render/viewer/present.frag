// The picture as it is seen, with the light that glows in it (bloom.frag, of so many octaves), encoded as sRGB, without noise (bare) for measuring.
uniform sampler2D picture, glow;
uniform vec3 gain;
uniform float bare, tone, bloom, octaves;
uniform vec2 size;
out vec4 shown;

void main()
{
	vec2 at = gl_FragCoord.xy / size;
	vec3 c = on_grey(picture, at, gain);
	if (bloom > 0.0)
		c = (1.0 - bloom) * c + bloom / octaves * enlarged(glow, ivec2(gl_FragCoord.xy)).rgb;
	// As film takes highlights: Narkowicz's fit of the ACES curve, with middle grey where it was.
	vec3 f = 0.8 * c;
	c = mix(clamp(c, 0.0, 1.0), clamp(f * (2.51 * f + 0.03) / (f * (2.43 * f + 0.59) + 0.14), 0.0, 1.0), tone);
	vec3 s = mix(c * 12.92, 1.055 * pow(max(c, 1e-5), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
	// Half a step of noise (dithering): smooth areas show no bands.
	float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
	shown = vec4(s + noise / 255.0 * (1.0 - bare), 1.0);
}
