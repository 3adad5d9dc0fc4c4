#include "bridge/cv_stereo.h"

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

bool cv_stereo(float *disparity, const uint8_t *left, const uint8_t *right, const uint8_t *mask, int width, int height,
               int min_disparity, int range, const struct cv_stereo_conf *conf, struct err *err)
{
	try {
		const int n = (range + 15) / 16 * 16, b = conf->block;
		// A border as wide as the range, so that the left picture gets values where the right one ends.
		const int pad_left = std::max(0, min_disparity + n), pad_right = std::max(0, -min_disparity);
		cv::Mat l, r, d;
		cv::copyMakeBorder(cv::Mat(height, width, CV_8U, const_cast<uint8_t *>(left)), l, 0, 0, pad_left, pad_right,
		                   cv::BORDER_REPLICATE);
		cv::copyMakeBorder(cv::Mat(height, width, CV_8U, const_cast<uint8_t *>(right)), r, 0, 0, pad_left, pad_right,
		                   cv::BORDER_REPLICATE);
		// P1 and P2 as OpenCV's documentation recommends, for one channel.
		auto sgbm = cv::StereoSGBM::create(min_disparity, n, b, 8 * b * b, 32 * b * b, conf->left_right, 31, conf->uniqueness,
		                                   conf->speckle, 1, cv::StereoSGBM::MODE_SGBM);
		sgbm->compute(l, r, d);
		for (int y = 0; y < height; y++)
			for (int x = 0; x < width; x++) {
				int v = d.at<int16_t>(y, x + pad_left);
				bool found = v >= min_disparity * 16 && mask[static_cast<long>(y) * width + x];
				disparity[static_cast<long>(y) * width + x] = found ? static_cast<float>(v) / 16 : std::numeric_limits<float>::quiet_NaN();
			}
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "stereo of %d x %d: %s", width, height, e.what());
	}
}

bool cv_mask_plain(uint8_t *mask, const uint8_t *grey, int width, int height, int reach, int least, struct err *err)
{
	try {
		const cv::Mat from(height, width, CV_8U, const_cast<uint8_t *>(grey));
		const cv::Mat window = cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U);
		cv::Mat low, high, to(height, width, CV_8U, mask);
		cv::erode(from, low, window);
		cv::dilate(from, high, window);
		to.setTo(0, high - low < least);
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "plain parts of %d x %d: %s", width, height, e.what());
	}
}

bool cv_warp8(uint8_t *out, uint8_t *mask, int width, int height, const float *x, const float *y, const uint8_t *px,
              int px_width, int px_height, struct err *err)
{
	try {
		cv::Mat mx, my, to(height, width, CV_8U, out);
		cv::Mat(height, width, CV_32F, const_cast<float *>(x)).convertTo(mx, CV_32F, 1, -0.5);
		cv::Mat(height, width, CV_32F, const_cast<float *>(y)).convertTo(my, CV_32F, 1, -0.5);
		cv::remap(cv::Mat(px_height, px_width, CV_8U, const_cast<uint8_t *>(px)), to, mx, my, cv::INTER_LINEAR,
		          cv::BORDER_REPLICATE);
		for (long i = 0; i < static_cast<long>(width) * height; i++)
			mask[i] = x[i] >= 1 && y[i] >= 1 && x[i] <= px_width - 1 && y[i] <= px_height - 1 ? 255 : 0;
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "warp of %d x %d: %s", px_width, px_height, e.what());
	}
}
