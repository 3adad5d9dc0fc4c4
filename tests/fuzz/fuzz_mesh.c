/* Meshes: the checks, then OpenMesh. */
#include "tests/fuzz/fuzz.h"

#include "bridge/om_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct mesh mesh;
	struct err err = { 0 };
	if (om_mesh_load(&mesh, fuzz_file(data, size), 2000, &err)) {
		for (int f = 0; f < mesh.n_faces; f++)
			for (int k = 0; k < 3; k++)
				if (mesh.faces[f][k] < 0 || mesh.faces[f][k] >= mesh.n_vertices)
					abort();
		mesh_free(&mesh);
	} else if (!err_is(&err))
		abort();
	return 0;
}
