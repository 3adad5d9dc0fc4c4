/* page: work/review/index.html. Each page_* function reads what one part of the page needs and returns it as JSON for
 * page.html (base/template.h); what is missing is left out there and said so. */
#ifndef RENDER_PAGE_H
#define RENDER_PAGE_H
#include <jansson.h>

#include "base/template.h"
#include "render/render.h"

struct page {
	struct stage *stage;
	const struct capture *capture;
	const struct render_conf *conf;
	int width;          // of the pictures in it, px
	json_t *advice;     // what to photograph better: sentences
	json_t *missing;    // what the page cannot show, and why: sentences
};

/* The folder's file of that name if it is there, else null. Owned by the stage. */
__attribute__((format(printf, 2, 3)))
const char *page_file(struct page *page, const char *fmt, ...);

/* The JSON object in that file; null where there is none. json_decref. */
json_t *page_json(struct page *page, const char *path);

/* One sentence more in a list; each only once. */
__attribute__((format(printf, 2, 3)))
void page_say(json_t *list, const char *fmt, ...);

/* printf to a JSON string. */
__attribute__((format(printf, 1, 2)))
json_t *page_text(const char *fmt, ...);

json_t *page_photos(struct page *page);
json_t *page_eyes(struct page *page);
json_t *page_stages(struct page *page, double *seconds);

/* {uri, width, height} of a picture as JPEG in a data: URI, at most `width` px wide; null when it cannot be read. */
json_t *page_picture(struct page *page, const char *path, int width);
/* The same of pixels [height][width][3]. */
json_t *page_pixels(const uint8_t *px, int width, int height);
/* The same of a third of a comparison: 0 the photograph, 1 the rendering, 2 the difference. */
json_t *page_panel(struct page *page, const char *path, int panel);

/* Iris maps as pictures: colour with what was not seen hatched; marks of a mask on it; a number as colour; height as a
 * lit relief. *range (may be null): least and greatest value. */
json_t *page_colour_map(struct page *page, const char *path);
json_t *page_mask_map(struct page *page, const char *path, const char *colour_path);
json_t *page_scalar_map(struct page *page, const char *path, const char *channel, double range[2]);
json_t *page_relief_map(struct page *page, const char *path, double range[2]);

#endif
