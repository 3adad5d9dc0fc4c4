#include "bridge/cv_blur.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

static cv::Mat wrap(const float *px, int width, int height, int channels)
{
	return cv::Mat(height, width, CV_MAKETYPE(CV_32F, channels), const_cast<float *>(px));
}

static void blur(cv::Mat &to, const cv::Mat &from, double sigma)
{
	cv::GaussianBlur(from, to, cv::Size(), sigma, sigma, cv::BORDER_REFLECT_101);
}

bool cv_blur(float *out, const float *in, int width, int height, int channels, double sigma, struct err *err)
{
	try {
		cv::Mat from = wrap(in, width, height, channels), to = wrap(out, width, height, channels), part;
		if (!(sigma > 0.2)) {
			if (in != out)
				from.copyTo(to);
			return true;
		}
		if (sigma <= 6 || std::min(width, height) < 8 * sigma / 3) {
			blur(part, from, sigma);
			part.copyTo(to);
			return true;
		}
		int w = std::max(4, (int)std::lround(3 * width / sigma)), h = std::max(4, (int)std::lround(3 * height / sigma));
		double step = (double)width / w;
		// Averaging over a texel and interpolating linearly add (1/12 + 1/6) texel squared of variance.
		double rest = std::sqrt(std::max(0.1, sigma * sigma / (step * step) - 0.25 + 1 / (12 * step * step)));
		cv::resize(from, part, cv::Size(w, h), 0, 0, cv::INTER_AREA);
		blur(part, part, rest);
		cv::resize(part, to, cv::Size(width, height), 0, 0, cv::INTER_LINEAR);
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "blur of %d x %d: %s", width, height, e.what());
	}
}

bool cv_resize(float *out, int new_width, int new_height, const float *in, int width, int height, int channels,
               struct err *err)
{
	try {
		cv::Mat to = wrap(out, new_width, new_height, channels);
		cv::resize(wrap(in, width, height, channels), to, cv::Size(new_width, new_height), 0, 0,
		           new_width < width ? cv::INTER_AREA : cv::INTER_LINEAR);
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "resize of %d x %d: %s", width, height, e.what());
	}
}
