/* plain: a glTF file whose numbers and pictures are packed by extensions becomes one that any reader of glTF 2.0 knows: buffers compressed by
 * meshoptimizer (EXT_meshopt_compression, KHR_meshopt_compression), whole numbers in place of floats (KHR_mesh_quantization), transformed texture coordinates
 * (KHR_texture_transform), WebP textures (EXT_texture_webp; the picture stays WebP). It reads strangers' bytes: in a process of its own (base/apart.h).
 */
#ifndef CHARACTER_PLAIN_PLAIN_H
#define CHARACTER_PLAIN_PLAIN_H
#include <stdbool.h>
#include <stddef.h>

#include "base/err.h"

/* The file that a buffer names: data of `size` bytes, free(). False, err set, when it cannot be read. */
typedef bool gltf_load(void *ctx, char **data, size_t *size, const char *name, struct err *err);

/* out, out_size   a .glb that holds all buffers, free(); null where there is nothing to unpack, or where file[size] is no glTF at all
 * load, ctx       give the other files that it names
 * Colours, weights, coordinates and displacements come out as floats; indices and joints as they are. A material's textures are taken to share the
 * transform of the first of them that has coordinates of the first set. Animations of packed files are left out.
 * Returns false, err set, when what is packed is damaged. */
bool gltf_plain(char **out, size_t *out_size, const char *file, size_t size, gltf_load *load, void *ctx, struct err *err);

#endif
