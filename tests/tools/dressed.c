/* dressed IN.obj OUT.glb|.fbx [unit=0.1] [px=1024] [z_up] [skinned] [no_uv] [no_material] [halves] [grain] [lid_hair] [materials=N]
 * [faces=18000] [stretch=1,1,1] [ball=X,Y,Z,RADIUS]: a head and its eyeballs as an artist's glTF, with textures, hair cards and blend shapes, or as FBX
 * (tests/lib/scenes/dressed.h, fbx.h); with one of the last three in another topology, each eyeball a mesh of its own (tests/lib/scenes/remeshed.h). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bridge/om_mesh.h"
#include "tests/lib/scenes/dressed.h"
#include "tests/lib/scenes/fbx.h"
#include "tests/lib/scenes/remeshed.h"

int main(int argc, char **argv)
{
	struct dressed how = { .unit = 0.1, .texture_px = 1024 };
	struct remeshed other = { 0 };
	struct mesh mesh = { 0 }, made = { 0 };
	struct err err = { 0 };
	if (argc < 3)
		return 2;
	for (int i = 3; i < argc; i++) {
		how.z_up |= !strcmp(argv[i], "z_up");
		how.skinned |= !strcmp(argv[i], "skinned");
		how.no_uv |= !strcmp(argv[i], "no_uv");
		how.no_material |= !strcmp(argv[i], "no_material");
		how.halves |= !strcmp(argv[i], "halves");
		how.grain |= !strcmp(argv[i], "grain");
		how.lid_hair |= !strcmp(argv[i], "lid_hair");
		if (!strncmp(argv[i], "materials=", 10))
			how.used_materials = atoi(argv[i] + 10);
		if (!strncmp(argv[i], "unit=", 5))
			how.unit = atof(argv[i] + 5);
		if (!strncmp(argv[i], "px=", 3))
			how.texture_px = atoi(argv[i] + 3);
		if (!strncmp(argv[i], "faces=", 6))
			other.faces = atoi(argv[i] + 6);
		how.eyes_apart |= !strncmp(argv[i], "faces=", 6) || sscanf(argv[i], "stretch=%lf,%lf,%lf", &other.stretch[0], &other.stretch[1], &other.stretch[2]) == 3
		                  || sscanf(argv[i], "ball=%lf,%lf,%lf,%lf", &other.ball[0], &other.ball[1], &other.ball[2], &other.ball[3]) == 4;
	}
	const size_t n = strlen(argv[2]);
	const bool fbx = n > 4 && !strcmp(argv[2] + n - 4, ".fbx");
	const bool ok = om_mesh_load(&mesh, argv[1], 1000000, &err) && (!how.eyes_apart || remeshed_make(&made, &mesh, &other, &err))
	                && (fbx ? fbx_write : dressed_write)(argv[2], how.eyes_apart ? &made : &mesh, &how, &err);
	if (!ok)
		fprintf(stderr, "dressed: %s\n", err.msg);
	mesh_free(&mesh);
	mesh_free(&made);
	return !ok;
}
