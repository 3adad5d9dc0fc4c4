#include "mesh/mesh_clean.h"

#include <string.h>

#include "mesh/mesh_clean_obj.h"
#include "mesh/mesh_clean_ply.h"

bool mesh_kind_of(enum mesh_kind *kind, const char *data, size_t size, struct err *err)
{
	*kind = !strncmp(data, "ply\n", 4) || !strncmp(data, "ply\r\n", 5) ? MESH_PLY : MESH_OBJ;
	if (!size)
		return err_set(err, "is empty");
	if (*kind == MESH_OBJ && memchr(data, 0, size))
		return err_set(err, "is no mesh: must be PLY or OBJ");
	return true;
}

bool mesh_clean(struct mesh *mesh, const char *data, size_t size, long limit, struct err *err)
{
	enum mesh_kind kind;
	return mesh_kind_of(&kind, data, size, err) && (kind == MESH_PLY ? mesh_clean_ply : mesh_clean_obj)(mesh, data, size, limit, err);
}
