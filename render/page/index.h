/* index: work/review/index.html, the review page: which files it shows, and page.html filled with what the parts read of them.
 */
#ifndef RENDER_PAGE_INDEX_H
#define RENDER_PAGE_INDEX_H
#include "render/page/page.h"

/* The page between reading and writing. */
struct page_work {
	struct page page;
	json_t *data;       // null: nothing to do
	char **in;          // every file that it shows
	int n_in;
};

/* page_begin reads and shrinks what the page shows; page_end writes it. The interactive page, which is only linked to, may be written
 * between them. page_end after page_begin in any case: it frees. Both return false, err set. */
bool page_begin(struct page_work *work, struct stage *stage, const struct capture *capture, const struct render_conf *conf, struct err *err);
bool page_end(struct page_work *work, struct err *err);

#endif
