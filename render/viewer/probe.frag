// The visible part of a globe under shut lids: its disc on the screen where no skin covers it.
// Each texel measures its own part of the square round the disc. Or (crease) fills what is left.
uniform vec3 globe;               // middle and radius, px
out vec4 shown;

#ifdef CREASE
uniform vec3 skin_rgb;

// Lids that touch: no light comes from between them but what their margins throw back and forth.
void main()
{
	if (distance(gl_FragCoord.xy, globe.xy) > globe.z)
		discard;
	gl_FragDepth = 1.0;
	shown = vec4(0.3 * skin_rgb * skin_rgb, 1.0);
}
#else
uniform sampler2D picture;

void main()
{
	vec2 from = globe.xy - globe.z, cell = vec2(2.0 * globe.z / float(PROBE));
	ivec2 low = ivec2(floor(from + floor(gl_FragCoord.xy) * cell)), high = ivec2(floor(from + ceil(gl_FragCoord.xy) * cell)), most = textureSize(picture, 0);
	float seen_ = 0.0;
	for (int y = max(low.y, 0); y < min(high.y, most.y); y++)
		for (int x = max(low.x, 0); x < min(high.x, most.x); x++) {
			float cover = texelFetch(picture, ivec2(x, y), 0).a;
			if (cover <= 0.995 && distance(vec2(x, y) + 0.5, globe.xy) < globe.z)
				seen_ += 1.0;
		}
	shown = vec4(seen_ / (cell.x * cell.y));
}
#endif
