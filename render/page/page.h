/* page: what the parts of the review page share. Each part (page_photos, page_eyes ...) reads what it shows and returns it as JSON for
 * page.html (base/template.h). What is missing is left out there and listed in page->missing. json_decref what is returned.
 */
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

/* Path of the capture folder's file of that name; null where there is none. Owned by the stage. */
__attribute__((format(printf, 2, 3)))
const char *page_file(struct page *page, const char *fmt, ...);

/* The JSON in that file; null where path is null, or where it cannot be read, which is listed as missing. */
json_t *page_json(struct page *page, const char *path);

/* Appends a sentence to a list (page->advice, film, missing) that does not hold it yet. */
__attribute__((format(printf, 2, 3)))
void page_say(json_t *list, const char *fmt, ...);

/* A JSON string of formatted text; bytes that are not UTF-8 are replaced. */
__attribute__((format(printf, 1, 2)))
json_t *page_text(const char *fmt, ...);

/* page_words.c: plain words. page_number: a number as text of four digits that count (two below 0.001), without an exponent, thousands
 * apart. page_sentence: another program's text, numbers with exponents written so. page_figure: {label, value, unit} of a figure of a
 * stage's log or of a character's record by its key; unit may be null. */
json_t *page_number(double value);
json_t *page_sentence(const char *text);
json_t *page_figure(const char *key, double value, const char *unit);

/* page_figure of all numbers in a stage's log; an empty array where there are none. */
json_t *page_facts(const json_t *log);

/* The photographs with their fits, each beside its rendering. */
json_t *page_photos(struct page *page);
/* The cameras found from views/ and the mesh; null where there are none. */
json_t *page_rig(struct page *page);
/* What was tracked and learnt, and the characters; null where the folder has no video. */
json_t *page_skin(struct page *page);
/* Maps, pigments and pictures of each eye. */
json_t *page_eyes(struct page *page);
/* Each stage's time, figures and what it left out; seconds: out, of all. */
json_t *page_stages(struct page *page, double *seconds);

/* {uri, width, height, whole} of a picture file as JPEG in a data: URI, at most `width` px wide; null when it cannot be read. whole: the
 * file as the review page links it, where browsers show files of its kind. */
json_t *page_picture(struct page *page, const char *path, int width);

/* The same of a part of it, {x, y, width, height} px, which no link leads beyond. Null where it does not lie in the picture. */
json_t *page_picture_part(struct page *page, const char *path, const int box[4], int width);
/* The same of the thirds of a comparison (draw/photo): photograph, rendering, difference; third: 0, 1, 2. False when it cannot be read. */
bool page_panels(json_t *out[3], struct page *page, const char *path);

/* Reads n channels of an iris map, reduced to the width of the page's pictures; false when there is none. image_free. */
bool page_map(struct image *out, struct page *page, const char *path, int n, const char *const names[]);

/* Iris maps as {uri, width, height}, in the colours of draw/web/pseudocolour.h. range: out, what they span. */
json_t *page_colour_map(const struct image *rgbw);
json_t *page_mask_map(const struct image *mask, const struct image *rgbw);
json_t *page_scalar_map(const struct image *map, int channel, double range[2]);
json_t *page_relief_map(const struct image *map, double range[2]);

#endif
