/* glb_buffer: the bytes of a binary glTF and the JSON that points into them. */
#ifndef RIG_GLB_BUFFER_H
#define RIG_GLB_BUFFER_H
#include <jansson.h>
#include <stddef.h>

#include "base/err.h"

enum { GLB_FLOAT = 5126, GLB_UINT = 5125, GLB_ARRAY = 34962, GLB_INDICES = 34963 };

/* views, accessors: the caller's. bin: free(). */
struct glb_buffer {
	json_t *views, *accessors;
	char *bin;
	size_t size, room;
};

/* Each returns the index of what it has appended. target: GLB_ARRAY, GLB_INDICES or 0. */
int glb_add_view(struct glb_buffer *buffer, const void *data, size_t size, int target);
int glb_add_accessor(struct glb_buffer *buffer, json_t *accessor);

/* n rows of `width` floats, 1 to 4. range: with min and max. */
int glb_add_floats(struct glb_buffer *buffer, const float *x, size_t n, int width, bool range, int target);

/* Displacements [few][3] that are zero for all other vertices: a sparse accessor. index_view: the row of each. */
int glb_add_sparse(struct glb_buffer *buffer, const float *x, int few, int index_view, int all, bool range);

/* Header, JSON padded by spaces, bytes padded by zeros. */
bool glb_save(const char *path, struct glb_buffer *buffer, json_t *root, long *bytes, struct err *err);

#endif
