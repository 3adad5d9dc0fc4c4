/* page: work/review/index.html. Each page_* function reads what one part of the page needs and returns it as JSON for
 * page.html (base/template.h); what is missing is left out there and said so. */
#ifndef RENDER_PAGE_PAGE_H
#define RENDER_PAGE_PAGE_H
#include <jansson.h>

#include "base/template.h"
#include "render/render.h"

struct page {
	struct stage *stage;
	const struct capture *capture;
	const struct render_conf *conf;
	int width;          // of the pictures in it, px
	json_t *advice;     // what to photograph better: sentences
	json_t *film;       // what to film better
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

/* [{label, value}] of the numbers in a stage's log; an empty array where there are none. */
json_t *page_facts(const json_t *log);

json_t *page_photos(struct page *page);
/* Null where no cameras were found from views/. */
json_t *page_rig(struct page *page);
/* Null where the folder has no video. */
json_t *page_skin(struct page *page);
json_t *page_eyes(struct page *page);
json_t *page_stages(struct page *page, double *seconds);

/* {uri, width, height} of a picture as JPEG in a data: URI, at most `width` px wide; null when it cannot be read. */
json_t *page_picture(struct page *page, const char *path, int width);
/* The same of the thirds of a comparison: photograph, rendering, difference. False when it cannot be read. */
bool page_panels(json_t *out[3], struct page *page, const char *path);

/* Channels of an iris map, at most as wide as the page's pictures; false when there is none. image_free. */
bool page_map(struct image *out, struct page *page, const char *path, int n, const char *const names[]);

/* Iris maps as pictures: colour with what was not seen striped; the outlines of a mask on it; a channel as colour; the
 * first channel as a lit relief. range: what the colours span. */
json_t *page_colour_map(const struct image *rgbw);
json_t *page_mask_map(const struct image *mask, const struct image *rgbw);
json_t *page_scalar_map(const struct image *map, int channel, double range[2]);
json_t *page_relief_map(const struct image *map, double range[2]);

#endif
