/* The end of a run: contact sheets and the two pages. Little of it is parallel in itself, and the interactive page needs nothing of the
 * rest: they are made at the same time. */
#include <omp.h>

#include "render/page/index.h"
#include "render/viewer/viewer.h"

static bool sheets(struct jobs *eyes, struct err *err)
{
	bool ok = true;
	for (int i = 0; ok && i < eyes->n; i++)
		ok = !eyes->job[i].usable || sheet_contact(&eyes->job[i], err);
	return ok;
}

bool show(struct skin_job *faces, bool drawn, struct err *err)
{
	struct err of_viewer = { 0 }, of_sheets = { 0 }, of_page = { 0 };
	struct page_work page;
	int levels = omp_get_max_active_levels();
	omp_set_max_active_levels(2);
#pragma omp parallel sections num_threads(faces->stage->threads > 1 ? 2 : 1)
	{
#pragma omp section
		{
			if (drawn)
				viewer_make(faces, &of_viewer);
		}
#pragma omp section
		{
			// The page is made even where a picture failed: it lists what is missing and why.
			if (drawn)
				sheets(faces->photographed, &of_sheets);
			page_begin(&page, faces->stage, faces->capture, faces->render, &of_page);
		}
	}
	omp_set_max_active_levels(levels);
	page_end(&page, &of_page);
	const struct err *const all[] = { &of_viewer, &of_sheets, &of_page };
	for (int i = 0; i < 3 && !err_is(err); i++)
		*err = *all[i];
	return !err_is(err);
}
