#include "plan/meshes.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "character/kind.h"
#include "mesh/mesh_peek.h"

/* Longer files are not read: every make starts plan. transfer finds the same out when it reads them. */
enum { MOST = 64 << 20 };

static char *subject_of(const char *capture)
{
	static const char *const names[] = { "subject.ply", "subject.obj" };
	for (int i = 0; i < COUNT(names); i++) {
		char *path = mem_printf("%s/%s", capture, names[i]);
		if (file_exists(path))
			return path;
		free(path);
	}
	return 0;
}

/* True when the mesh at `path` has exactly the subject's faces. subject: loaded at the first call that needs it. */
static bool is_same(struct mesh *subject, const char *subject_path, long vertices, const char *path)
{
	struct mesh target;
	if (vertices < 0 || mesh_peek_vertices(path, MOST) != vertices)
		return false;
	if (!subject->n_faces && (!mesh_peek_faces(subject, subject_path, MOST) || !subject->n_faces))
		return false;
	bool same = mesh_peek_faces(&target, path, MOST) && target.n_vertices == subject->n_vertices && target.n_faces == subject->n_faces
	            && !memcmp(target.faces, subject->faces, (size_t)target.n_faces * sizeof *target.faces);
	mesh_free(&target);
	return same;
}

void plan_characters(int *all, int *same, const char *capture)
{
	struct file_list list;
	struct err none = { 0 };
	struct mesh subject = { 0 };
	char *dir = mem_printf("%s/targets", capture), *subject_path = subject_of(capture);
	long vertices = subject_path ? mesh_peek_vertices(subject_path, MOST) : -1;
	*all = *same = 0;
	file_list(&list, dir, &none);
	for (int i = 0; i < list.n; i++) {
		const enum character_kind kind = character_kind_of(list.names[i]);
		if (kind == CHARACTER_NONE)
			continue;
		char *path = mem_printf("%s/%s", dir, list.names[i]);
		++*all;
		*same += kind == CHARACTER_PLAIN && is_same(&subject, subject_path, vertices, path);
		free(path);
	}
	mesh_free(&subject);
	file_list_free(&list);
	free(subject_path);
	free(dir);
}
