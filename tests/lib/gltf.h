/* gltf: what Khronos's own validator says of a file. */
#ifndef TESTS_LIB_GLTF_H
#define TESTS_LIB_GLTF_H
#include <stdbool.h>

/* Whether the validator is there: installed by npm beside the build, once; false where there is neither node nor a network. */
bool gltf_validator_there(void);

/* Whether it finds neither errors nor warnings; else they are printed. */
bool gltf_is_valid(const char *path);

#endif
