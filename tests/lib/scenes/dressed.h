/* dressed: a character's glTF as artists have them, made from a head and its eyeballs: head, eyeballs and hair cards as meshes of
 * their own below a turned node, a seam in the texture coordinates, colour, normal and roughness textures, blend shapes.
 */
#ifndef TESTS_SCENES_DRESSED_H
#define TESTS_SCENES_DRESSED_H
#include "mesh/mesh.h"

struct dressed {
	double unit;        // the file's in one of the mesh's
	bool z_up;          // its z points up, as in Blender
	bool skinned;       // carried by a joint that turns it, as a posed character
	int texture_px;
	bool no_uv, no_material;
	bool eyes_apart;    // each eyeball is a mesh of its own
	int many_materials; // more, none of which is used
	int used_materials; // the head in so many primitives of a material each, which share its vertices; 0: in one
	bool halves;        // its colour: red on the person's left, blue on the right
	bool grain;         // its textures have the noise of a photographed skin, all three of texture_px
	bool lid_hair;      // hair cards that stand on the skin round the left eye, four vertices each, the last of the file
};

/* Writes the .glb. mesh: y up, the face towards +z. Returns false, err set, when it cannot. */
bool dressed_write(const char *path, const struct mesh *mesh, const struct dressed *how, struct err *err);

/* Where the turned node puts a point of the mesh, in the file's unit. */
void dressed_place(float out[3], const float in[3], const struct dressed *how);

#endif
