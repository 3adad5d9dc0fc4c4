/* glb_buffer: the binary chunk of a glTF 2.0 file and the JSON arrays that refer to it. */
#ifndef RIG_GLB_BUFFER_H
#define RIG_GLB_BUFFER_H
#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

enum { GLB_MAGIC = 0x46546c67, GLB_BYTE = 5120, GLB_SHORT = 5122, GLB_USHORT = 5123, GLB_UINT = 5125, GLB_FLOAT = 5126, GLB_ARRAY = 34962,
	   GLB_INDICES = 34963 };

/* The caller makes views and accessors (JSON arrays) and gives them to the root; bin: free(). */
struct glb_buffer {
	json_t *views, *accessors;
	char *bin;
	size_t size, room;
	int rows_view;   // of the rows that glb_add_rows had last, rows_size bytes; 0 bytes: of none
	size_t rows_size;
};

/* Appends `size` bytes, aligned to 4; returns where they begin. */
size_t glb_add_bytes(struct glb_buffer *buffer, const void *data, size_t size);

/* Appends a buffer view of `size` bytes (aligned to 4) or an accessor; returns its index. target: GLB_ARRAY, GLB_INDICES or 0. */
int glb_add_view(struct glb_buffer *buffer, const void *data, size_t size, int target);
int glb_add_accessor(struct glb_buffer *buffer, json_t *accessor);

/* Appends the corners of triangles, indices of two bytes where there are few vertices, as view and accessor; returns the accessor's index. */
int glb_add_corners(struct glb_buffer *buffer, const uint32_t *corner, size_t n_corners, int n_vertices);

/* Appends unit vectors[n][3] as 8 bits an axis (normalized); returns the accessor's index. */
int glb_add_normals(struct glb_buffer *buffer, const float (*normal)[3], size_t n);

/* Appends x[n], within -1 .. 1, as 16 bits each (normalized); returns the accessor's index. */
int glb_add_shares(struct glb_buffer *buffer, const float *x, size_t n);

/* Appends n rows of `width` (1 to 4) floats as view and accessor; returns the accessor's index. range: with min and max. */
int glb_add_floats(struct glb_buffer *buffer, const float *x, size_t n, int width, bool range, int target);

/* A view of the rows in which a sparse accessor of `all` vectors of three is not zero: row[few], rising. The same rows as the last ones
 * are there once. Returns the view's index. */
int glb_add_rows(struct glb_buffer *buffer, const uint32_t *row, int few, int all);

/* Appends a sparse accessor of `all` vectors of three, zero but for x[few][3] in the rows of a view. Returns its index,
 * with min and max. steps: the same of whole numbers of 16 or 8 bits, which stand for shares of their largest (normalized); range: with min
 * and max. */
int glb_add_sparse(struct glb_buffer *buffer, const float *x, int few, int rows_view, int all);
int glb_add_sparse_steps(struct glb_buffer *buffer, const int16_t *step, int few, int rows_view, int all, int bits, bool range);

/* The file's bytes: header, JSON padded by spaces, buffer padded by zeros. out: free(). Returns false, err set, where that is larger than
 * a binary glTF can be. */
bool glb_pack(char **out, size_t *size, const struct glb_buffer *buffer, const json_t *root, struct err *err);

/* Writes them. *bytes: the file's length, out. Returns false, err set, when it cannot be written. */
bool glb_save(const char *path, const struct glb_buffer *buffer, const json_t *root, long *bytes, struct err *err);

#endif
