/* glb_buffer: the binary chunk of a glTF 2.0 file and the JSON arrays that refer to it. */
#ifndef RIG_GLB_BUFFER_H
#define RIG_GLB_BUFFER_H
#include <jansson.h>
#include <stddef.h>

#include "base/err.h"

enum { GLB_MAGIC = 0x46546c67, GLB_FLOAT = 5126, GLB_UINT = 5125, GLB_ARRAY = 34962, GLB_INDICES = 34963 };

/* The caller makes views and accessors (JSON arrays) and gives them to the root; bin: free(). */
struct glb_buffer {
	json_t *views, *accessors;
	char *bin;
	size_t size, room;
};

/* Appends `size` bytes, aligned to 4; returns where they begin. */
size_t glb_add_bytes(struct glb_buffer *buffer, const void *data, size_t size);

/* Appends a buffer view of `size` bytes (aligned to 4) or an accessor; returns its index. target: GLB_ARRAY, GLB_INDICES or 0. */
int glb_add_view(struct glb_buffer *buffer, const void *data, size_t size, int target);
int glb_add_accessor(struct glb_buffer *buffer, json_t *accessor);

/* Appends n rows of `width` (1 to 4) floats as view and accessor; returns the accessor's index. range: with min and max. */
int glb_add_floats(struct glb_buffer *buffer, const float *x, size_t n, int width, bool range, int target);

/* Appends a sparse accessor of `all` vectors of three, zero but for x[few][3]. index_view: view of their rows, uint32, rising. Returns
 * its index. */
int glb_add_sparse(struct glb_buffer *buffer, const float *x, int few, int index_view, int all, bool range);

/* The file's bytes: header, JSON padded by spaces, buffer padded by zeros. out: free(). Returns false, err set, where that is larger than
 * a binary glTF can be. */
bool glb_pack(char **out, size_t *size, const struct glb_buffer *buffer, const json_t *root, struct err *err);

/* Writes them. *bytes: the file's length, out. Returns false, err set, when it cannot be written. */
bool glb_save(const char *path, const struct glb_buffer *buffer, const json_t *root, long *bytes, struct err *err);

#endif
