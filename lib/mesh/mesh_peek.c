#include "mesh/mesh_peek.h"

#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "mesh/mesh_clean.h"
#include "mesh/mesh_clean_obj.h"
#include "mesh/mesh_ply.h"

/* The first bytes of a regular file of at most `most` bytes, with a zero byte behind them; free(). Null: it cannot be read. */
static char *head_of(size_t *n, const char *path, size_t most)
{
	enum { HEAD = 1 << 16 };
	struct stat st;
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0)
		return 0;
	char *head = mem_new(HEAD + 1, 1);
	bool is_file = !fstat(fd, &st) && S_ISREG(st.st_mode) && (size_t)st.st_size <= most;
	ssize_t got = is_file ? read(fd, head, HEAD) : -1;
	close(fd);
	*n = got > 0 ? (size_t)got : 0;
	if (got > 0)
		return head;
	free(head);
	return 0;
}

static long lines_of_vertices(const char *path, size_t most)
{
	char *data;
	size_t size;
	struct err err = { 0 };
	if (!file_read(&data, &size, path, most, &err))
		return -1;
	long n = mesh_clean_obj_vertices(data, size);
	free(data);
	return n;
}

long mesh_peek_vertices(const char *path, size_t most)
{
	size_t n;
	enum mesh_kind kind;
	struct err err = { 0 };
	char *head = head_of(&n, path, most);
	if (!head)
		return -1;
	long count = -1;
	bool known = mesh_kind_of(&kind, head, n, &err);
	if (known && kind == MESH_PLY) {
		struct ply *ply = mem_new(1, sizeof *ply);
		*ply = (struct ply){ .at = head, .end = head + n, .format = -1 };
		count = ply_head(ply, &err) ? ply->element[0].count : -1;
		free(ply);
	} else if (known)
		count = lines_of_vertices(path, most);
	free(head);
	return count;
}

bool mesh_peek_faces(struct mesh *mesh, const char *path, size_t most)
{
	char *data;
	size_t size;
	struct err err = { 0 };
	*mesh = (struct mesh){ 0 };
	if (!file_read(&data, &size, path, most, &err))
		return false;
	bool ok = mesh_clean(mesh, data, size, INT_MAX / 4, &err);
	free(data);
	if (!ok)
		mesh_free(mesh);
	return ok;
}
