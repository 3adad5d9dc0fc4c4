/* webp: pictures in WebP, by libwebp, which is loaded when it is first needed. */
#ifndef IMAGE_WEBP_H
#define IMAGE_WEBP_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct webp_head {
	int width, height;
	bool alpha, moves;
};

/* Why it cannot be read here; null: it can. Loads the library: to be called before a process gives up opening files (base/apart.h). */
const char *webp_missing(void);

/* What a file begins with; false where there is no WebP picture in it. webp_missing has to be null. */
bool webp_head(struct webp_head *head, const void *bytes, size_t size);

/* px[height][width][channels]: 3 (RGB) or 4 (and alpha), of what webp_head has accepted. False where it is damaged. */
bool webp_decode(uint8_t *px, int channels, const struct webp_head *head, const void *bytes, size_t size);

#endif
