#include "bridge/cv_distance.h"

#include <opencv2/imgproc.hpp>

bool cv_distance(float *out, const uint8_t *from, int width, int height)
try {
	const cv::Mat in(height, width, CV_8U, const_cast<uint8_t *>(from));
	cv::Mat to(height, width, CV_32F, out);
	cv::distanceTransform(in, to, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
	return to.data == reinterpret_cast<uint8_t *>(out);
} catch (...) {
	return false;
}
