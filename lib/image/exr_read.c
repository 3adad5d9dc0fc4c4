#include "image/exr.h"

#include <stdlib.h>
#include <string.h>

#include <openexr.h>

#include "base/mem.h"

static void quiet(exr_const_context_t ctxt, exr_result_t code, const char *message)
{
	(void)ctxt;
	(void)code;
	(void)message;
}

static bool open_part(exr_context_t *file, const char *path, struct err *err)
{
	exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
	init.error_handler_fn = quiet;
	init.max_image_width = init.max_image_height = 1 << 16;
	*file = 0;
	if (exr_start_read(file, path, &init))
		return err_set(err, "%s: cannot be read as OpenEXR", path);
	exr_storage_t storage;
	if (exr_get_storage(*file, 0, &storage) || storage != EXR_STORAGE_SCANLINE) {
		exr_finish(file);
		return err_set(err, "%s: must be a scan-line OpenEXR file (not tiled, not deep)", path);
	}
	return true;
}

/* Where each channel of the chunk goes. Those nobody asked for go to `spare`, which takes one channel's lines:
 * OpenEXRCore (3.1) would leave them out by a null pointer, but its fast paths for three and four half channels then
 * write through it. False for subsampled channels. */
static bool aim(exr_decode_pipeline_t *pipe, const struct image *image, int line, int n, const char *const channels[],
                float *spare)
{
	for (int i = 0; i < pipe->channel_count; i++) {
		exr_coding_channel_info_t *from = &pipe->channels[i];
		if (from->x_samples != 1 || from->y_samples != 1)
			return false;
		from->decode_to_ptr = (uint8_t *)spare;
		from->user_pixel_stride = sizeof(float);
		for (int c = 0; c < n; c++)
			if (!strcmp(channels[c], from->channel_name)) {
				from->decode_to_ptr = (uint8_t *)(image_at(image, 0, line) + c);
				from->user_pixel_stride = n * (int)sizeof(float);
			}
		from->user_data_type = EXR_PIXEL_FLOAT;
		from->user_bytes_per_element = sizeof(float);
		from->user_line_stride = image->width * from->user_pixel_stride;
	}
	return true;
}

static bool read_chunk(exr_context_t file, int part, int y, const struct image *image, int n,
                       const char *const channels[], exr_decode_pipeline_t *pipe)
{
	exr_chunk_info_t chunk;
	if (exr_read_scanline_chunk_info(file, part, y, &chunk))
		return false;
	exr_attr_box2i_t window;
	exr_get_data_window(file, part, &window);
	if (exr_decoding_initialize(file, part, &chunk, pipe))
		return false;
	float *spare = mem_array((size_t)image->width * (size_t)chunk.height, sizeof *spare);
	bool ok = aim(pipe, image, y - window.min.y, n, channels, spare)
	          && !exr_decoding_choose_default_routines(file, part, pipe) && !exr_decoding_run(file, part, pipe);
	free(spare);
	return ok;
}

static bool read_chunks(exr_context_t file, const struct image *image, int n, const char *const channels[])
{
	exr_attr_box2i_t window;
	int lines, bad = 0;
	if (exr_get_data_window(file, 0, &window) || exr_get_scanlines_per_chunk(file, 0, &lines))
		return false;
	int chunks = (image->height + lines - 1) / lines;
#pragma omp parallel for schedule(static, 1) reduction(| : bad)
	for (int i = 0; i < chunks; i++) {
		exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
		if (!read_chunk(file, 0, window.min.y + i * lines, image, n, channels, &pipe))
			bad |= 1;
		exr_decoding_destroy(file, &pipe);
	}
	return !bad;
}

static bool has_channels(exr_context_t file, int n, const char *const channels[], const char *path, struct err *err)
{
	const exr_attr_chlist_t *list;
	if (exr_get_channels(file, 0, &list))
		return err_set(err, "%s: has no channels", path);
	for (int c = 0; c < n; c++) {
		bool found = false;
		for (int i = 0; i < list->num_channels; i++)
			found |= !strcmp(list->entries[i].name.str, channels[c]);
		if (!found)
			return err_set(err, "%s: has no channel %s", path, channels[c]);
	}
	return true;
}

static bool size_of(struct image *image, exr_context_t file, int n, long limit_px, const char *path, struct err *err)
{
	exr_attr_box2i_t w;
	if (exr_get_data_window(file, 0, &w))
		return err_set(err, "%s: has no data window", path);
	long long width = (long long)w.max.x - w.min.x + 1, height = (long long)w.max.y - w.min.y + 1;
	if (width < 1 || height < 1 || width > 1 << 16 || height > 1 << 16 || width * height > limit_px)
		return err_set(err, "%s: %lld x %lld px, must be 1 to %ld px in all", path, width, height, limit_px);
	*image = image_new((int)width, (int)height, n);
	return true;
}

bool exr_read(struct image *image, const char *path, int n, const char *const channels[], long limit_px,
              struct exr_info *info, struct err *err)
{
	exr_context_t file;
	*image = (struct image){ 0 };
	if (!open_part(&file, path, err))
		return false;
	bool ok = has_channels(file, n, channels, path, err) && size_of(image, file, n, limit_px, path, err)
	          && (read_chunks(file, image, n, channels) || err_set(err, "%s: damaged or cut off", path));
	float extent = 0;
	if (info)
		*info = (struct exr_info){ .extent_mm = exr_attr_get_float(file, 0, "extentMm", &extent) ? 0 : (double)extent };
	exr_finish(&file);
	if (!ok)
		image_free(image);
	return ok;
}

bool exr_channels(char **names, const char *path, struct err *err)
{
	exr_context_t file;
	const exr_attr_chlist_t *list;
	*names = 0;
	if (!open_part(&file, path, err))
		return false;
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
