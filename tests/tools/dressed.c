/* dressed IN.obj OUT.glb [unit=0.1] [px=1024] [z_up] [skinned] [no_uv] [no_material]: a head and its eyeballs as an artist's glTF, with
 * textures, hair cards and blend shapes (tests/lib/scenes/dressed.h). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bridge/om_mesh.h"
#include "tests/lib/scenes/dressed.h"

int main(int argc, char **argv)
{
	struct dressed how = { .unit = 0.1, .texture_px = 1024 };
	struct mesh mesh = { 0 };
	struct err err = { 0 };
	if (argc < 3)
		return 2;
	for (int i = 3; i < argc; i++) {
		how.z_up |= !strcmp(argv[i], "z_up");
		how.skinned |= !strcmp(argv[i], "skinned");
		how.no_uv |= !strcmp(argv[i], "no_uv");
		how.no_material |= !strcmp(argv[i], "no_material");
		if (!strncmp(argv[i], "unit=", 5))
			how.unit = atof(argv[i] + 5);
		if (!strncmp(argv[i], "px=", 3))
			how.texture_px = atoi(argv[i] + 3);
	}
	const bool ok = om_mesh_load(&mesh, argv[1], 1000000, &err) && dressed_write(argv[2], &mesh, &how, &err);
	if (!ok)
		fprintf(stderr, "dressed: %s\n", err.msg);
	mesh_free(&mesh);
	return !ok;
}
