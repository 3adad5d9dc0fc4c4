#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/eye/quick/hits.h"

struct scene_hits {
	const struct scene *scene;
	struct scene_view view;  // that they belong to
	int tiles;
	struct quick_found **found;  // of each tile; null: not traced yet
};

struct scene_hits *scene_hits_new(void)
{
	return mem_new(1, sizeof(struct scene_hits));
}

static void clear(struct scene_hits *h)
{
	for (int i = 0; i < h->tiles; i++)
		free(h->found[i]);
	free(h->found);
	*h = (struct scene_hits){ 0 };
}

void scene_hits_free(struct scene_hits *h)
{
	if (h)
		clear(h);
	free(h);
}

static bool same_view(const struct scene_view *a, const struct scene_view *b)
{
	return a->camera.focal_px == b->camera.focal_px && !memcmp(a->camera.center_px, b->camera.center_px, sizeof a->camera.center_px)
	       && !memcmp(a->camera.distortion, b->camera.distortion, sizeof a->camera.distortion)
	       && !memcmp(a->cam_from_eye, b->cam_from_eye, sizeof a->cam_from_eye) && !memcmp(a->slip, b->slip, sizeof a->slip)
	       && a->x0 == b->x0 && a->y0 == b->y0 && a->scale == b->scale && a->width == b->width && a->height == b->height;
}

void scene_hits_for(struct scene_hits *h, const struct scene *scene, const struct scene_view *view, int tiles)
{
	if (h->scene == scene && h->tiles == tiles && same_view(&h->view, view))
		return;
	clear(h);
	h->scene = scene;
	h->view = *view;
	h->tiles = tiles;
	h->found = mem_new((size_t)tiles, sizeof *h->found);
}

static void ask(const char *from, size_t size)
{
	for (size_t i = 0; i < size; i += 64)
		__builtin_prefetch(from + i);
}

/* Prefetches: this tile's places are read a tile later, the next one's nodes at once. */
struct quick_found *scene_hits_tile(const struct scene_hits *h, int tile)
{
	struct quick_found *found = h->found[tile];
	if (found && tile + 1 < h->tiles && h->found[tile + 1])
		ask((const char *)h->found[tile + 1], offsetof(struct quick_found, nodes.place));
	if (found && found->kind != QUICK_MIXED && found->seen)
		ask((const char *)found->nodes.place, sizeof found->nodes.place);
	return found;
}

/* Copies only the part that is read again. */
void scene_hits_keep(struct scene_hits *h, int tile, const struct quick_found *found)
{
	size_t size = sizeof *found;
	if (found->kind != QUICK_MIXED)
		size = found->seen ? offsetof(struct quick_found, spots) : offsetof(struct quick_found, nodes.place);
	h->found[tile] = mem_array(1, size);
	memcpy(h->found[tile], found, size);
}
