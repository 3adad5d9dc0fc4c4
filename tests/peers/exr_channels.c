#include "tests/peers/exr_channels.h"

#include <stdlib.h>

#include <openexr.h>

#include "base/mem.h"

static void quiet(exr_const_context_t ctxt, exr_result_t code, const char *message)
{
	(void)ctxt;
	(void)code;
	(void)message;
}

bool exr_channels(char **names, const char *path, struct err *err)
{
	exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
	exr_context_t file = 0;
	const exr_attr_chlist_t *list;
	init.error_handler_fn = quiet;
	*names = 0;
	if (exr_start_read(&file, path, &init))
		return err_set(err, "%s: cannot be read as OpenEXR", path);
	char *all = mem_str("");
	if (!exr_get_channels(file, 0, &list))
		for (int i = 0; i < list->num_channels; i++) {
			char *more = mem_printf("%s%s%s", all, i ? "," : "", list->entries[i].name.str);
			free(all);
			all = more;
		}
	exr_finish(&file);
	*names = all;
	return true;
}
