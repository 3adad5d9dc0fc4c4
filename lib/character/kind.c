#include "character/kind.h"

#include <string.h>

#include "base/mem.h"

enum character_kind character_kind_of(const char *name)
{
	static const struct { const char *end; enum character_kind kind; } known[] = {
		{ ".ply", CHARACTER_PLAIN }, { ".obj", CHARACTER_PLAIN }, { ".glb", CHARACTER_SCENE }, { ".gltf", CHARACTER_SCENE }, { ".fbx", CHARACTER_SCENE },
	};
	const size_t n = strlen(name);
	for (int i = 0; i < COUNT(known); i++) {
		const size_t k = strlen(known[i].end);
		if (n > k && !strcmp(name + n - k, known[i].end))
			return known[i].kind;
	}
	return CHARACTER_NONE;
}
