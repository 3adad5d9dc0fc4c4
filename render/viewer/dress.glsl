// The character's own colours, on a cylinder about an axis behind the eyes: lib/draw/web/dress.c.
uniform sampler2D dress_map;
uniform vec3 dress_place;         // how far behind, mm; half its turn, rad; half its height, mm

vec3 dressed(vec3 rest)
{
	float turn = atan(rest.x, rest.z + dress_place.x);
	return texture(dress_map, vec2(0.5 + 0.5 * turn / dress_place.y, 0.5 - 0.5 * rest.y / dress_place.z)).rgb;
}
