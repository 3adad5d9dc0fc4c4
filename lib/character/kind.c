#include "character/kind.h"

#include <string.h>

#include "base/mem.h"

static bool ends(const char *name, const char *end)
{
	const size_t n = strlen(name), k = strlen(end);
	return n > k && !strcmp(name + n - k, end);
}

/* Whether a line that begins with `word` stands in data before one that begins with `stop`, null: anywhere. */
static bool has_line(const char *data, size_t size, const char *word, const char *stop)
{
	for (const char *at = data; at; at = memchr(at, '\n', (size_t)(data + size - at))) {
		at += *at == '\n';
		if (!strncmp(at, word, strlen(word)))
			return true;
		if (stop && !strncmp(at, stop, strlen(stop)))
			return false;
	}
	return false;
}

enum character_kind character_kind_of(const char *name)
{
	static const struct { const char *end; enum character_kind kind; } known[] = {
		{ ".ply", CHARACTER_PLAIN }, { ".obj", CHARACTER_PLAIN }, { ".glb", CHARACTER_SCENE }, { ".gltf", CHARACTER_SCENE }, { ".fbx", CHARACTER_SCENE },
	};
	for (int i = 0; i < COUNT(known); i++)
		if (ends(name, known[i].end))
			return known[i].kind;
	return CHARACTER_NONE;
}

bool character_is_gltf(const char *name)
{
	return ends(name, ".glb") || ends(name, ".gltf");
}

bool character_names_look(const char *name, const char *data, size_t size)
{
	if (character_kind_of(name) != CHARACTER_PLAIN)
		return character_kind_of(name) == CHARACTER_SCENE;
	// Assimp keeps one pair of coordinates a vertex: seams of a PLY that gives them to its faces' corners would be lost.
	return ends(name, ".obj") ? has_line(data, size, "mtllib ", 0)
	                          : has_line(data, size, "comment TextureFile ", "end_header")
	                                && !has_line(data, size, "property list uchar float texcoord", "end_header");
}
