#include "bridge/cv_inpaint.h"

#include <exception>
#include <opencv2/photo.hpp>

bool cv_inpaint(uint8_t *rgb, const uint8_t *mask, int width, int height, double radius, enum cv_inpaint_method method,
                struct err *err)
{
	try {
		cv::Mat image(height, width, CV_8UC3, rgb), out;
		cv::Mat hole = cv::Mat(height, width, CV_8UC1, const_cast<uint8_t *>(mask)) != 0;
		cv::inpaint(image, hole, out, radius, method == CV_INPAINT_TELEA ? cv::INPAINT_TELEA : cv::INPAINT_NS);
		out.copyTo(image);
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "inpainting: %s", e.what());
	}
}
