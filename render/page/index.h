/* index: work/review/index.html, the review page: which files it shows, and page.html filled with what the parts read of them.
 */
#ifndef RENDER_PAGE_INDEX_H
#define RENDER_PAGE_INDEX_H
#include "render/page/page.h"

/* work/review/index.html on its way. */
struct page_work {
	struct page page;
	json_t *data;       // null: nothing to do
	char **in;          // every file that it shows
	int n_in;
};

/* Reads and shrinks what the page shows, all but the interactive page, which it only links to and which may be written
 * meanwhile; then writes it. page_end after page_begin in any case: it frees. */
bool page_begin(struct page_work *work, struct stage *stage, const struct capture *capture, const struct render_conf *conf, struct err *err);
bool page_end(struct page_work *work, struct err *err);

#endif
