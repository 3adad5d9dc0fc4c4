#include "bridge/cv_photo.h"

#include <opencv2/imgproc.hpp>

extern "C" {
#include "base/mem.h"
}

uint8_t *cv_resize8(const uint8_t *px, int width, int height, int channels, int new_width, int new_height)
{
	size_t n = (size_t)new_width * (size_t)new_height * (size_t)channels;
	uint8_t *out = (uint8_t *)mem_array(n, 1);
	try {
		cv::Mat from(height, width, CV_8UC(channels), const_cast<uint8_t *>(px));
		cv::Mat to(new_height, new_width, CV_8UC(channels), out);
		bool smaller = new_width <= width && new_height <= height;
		cv::resize(from, to, to.size(), 0, 0, smaller ? cv::INTER_AREA : cv::INTER_CUBIC);
	} catch (...) {
		assert(!"sizes a caller must not pass");
	}
	return out;
}
