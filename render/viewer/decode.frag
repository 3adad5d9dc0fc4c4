// Maps as they travel (8 bits a channel) to what is sampled. kind 0: relief, R and G 12 bits of height, B the stroma's
// thickness; 1: logarithms; 2: as they are.
uniform sampler2D map;
uniform int kind;
uniform vec4 low, high;
out vec4 value;

void main()
{
	vec4 t = texelFetch(map, ivec2(gl_FragCoord.xy), 0);
	if (kind == 0) {
		float height = mix(low.x, high.x, (t.r * 4080.0 + t.g * 15.0) / 4095.0), coarse = round(height * 256.0) / 256.0;
		value = vec4(coarse, mix(low.y, high.y, t.b), height - coarse, 1.0);
	}
	else if (kind == 1)
		value = vec4(exp(mix(low.rgb, high.rgb, t.rgb)), 1.0);
	else
		value = mix(low, high, t);
}
