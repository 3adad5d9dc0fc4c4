// One of the pictures whose mean is shown.
uniform sampler2D picture;
out vec4 seen;

void main()
{
	seen = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}
