#include "bridge/imf_read.h"

#include "base/file.h"

#include <cstring>
#include <exception>

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

static const uint64_t FILE_MOST = (uint64_t)4 << 30;  // bytes

static bool read(struct image *out, Imf::InputFile &file, const char *path, long limit_px, struct err *err)
{
	static const char *const names[] = { "R", "G", "B" };
	const Imath::Box2i window = file.header().dataWindow();
	const long width = (long)window.max.x - window.min.x + 1, height = (long)window.max.y - window.min.y + 1;
	if (width < 1 || height < 1 || width > 1 << 16 || height > 1 << 16 || width * height > limit_px)
		return err_set(err, "%s: %ld x %ld px, must be at most %ld in all", path, width, height, limit_px);
	for (const char *name : names)
		if (!file.header().channels().findChannel(name))
			return err_set(err, "%s: has no channel %s", path, name);
	*out = image_new((int)width, (int)height, 3);
	Imf::FrameBuffer frame;
	for (int c = 0; c < 3; c++) {
		char *base = (char *)(out->px + c) - ((long)window.min.y * width + window.min.x) * 3 * (long)sizeof(float);
		frame.insert(names[c], Imf::Slice(Imf::FLOAT, base, 3 * sizeof(float), 3 * sizeof(float) * (size_t)width));
	}
	file.setFrameBuffer(frame);
	file.readPixels(window.min.y, window.max.y);
	return true;
}

bool imf_read_rgb(struct image *out, const char *path, long limit_px, struct err *err)
{
	std::memset(out, 0, sizeof *out);
	if (!file_opens(path, FILE_MOST, err))
		return false;
	try {
		Imf::InputFile file(path, 1);
		return read(out, file, path, limit_px, err);
	} catch (const std::exception &e) {
		image_free(out);
		return err_set(err, "%s: cannot be read as OpenEXR: %.200s", path, e.what());
	}
}
