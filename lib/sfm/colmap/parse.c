#include <stdlib.h>

#include "sfm/colmap/parse_impl.h"

bool colmap_parse(struct colmap_model *model, enum colmap_format format, const char *const data[3], const size_t size[3],
                  const char *const where[3], struct err *err)
{
	struct colmap_raw raw = { 0 };
	*model = (struct colmap_model){ 0 };
	bool ok = (format == COLMAP_TEXT ? colmap_parse_text : colmap_parse_binary)(model, &raw, data, size, where, err)
	          && colmap_link(model, &raw, where, err);
	free(raw.seen_point);
	free(raw.image_camera);
	free(raw.track);
	if (!ok)
		colmap_free(model);
	return ok;
}
