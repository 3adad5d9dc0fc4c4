#include "bridge/cv_ridge.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

/* Samples of a Gaussian and its derivatives, scaled so that they are exact on 1, x and x^2 / 2. */
static cv::Mat kernel(double sigma, int order)
{
	int r = (int)std::ceil(4 * sigma);
	cv::Mat k(2 * r + 1, 1, CV_32F);
	std::vector<double> v((size_t)(2 * r + 1));
	double sum = 0, moment = 0;
	for (int i = -r; i <= r; i++) {
		double x = i / sigma, g = std::exp(-0.5 * x * x);
		v[(size_t)(i + r)] = order == 0 ? g : order == 1 ? i * g : (x * x - 1) * g;
		sum += v[(size_t)(i + r)];
	}
	for (int i = -r; i <= r; i++) {
		double &w = v[(size_t)(i + r)];
		if (order == 2)
			w -= sum / (2 * r + 1);
		moment += order == 0 ? w : order == 1 ? i * w : 0.5 * i * i * w;
	}
	for (int i = 0; i <= 2 * r; i++)
		k.at<float>(i) = (float)(v[(size_t)i] / moment);
	return k;
}

bool cv_ridge(float *const out[CV_DERIVATIVES], const float *in, int width, int height, double sigma, struct err *err)
{
	static const int orders[CV_DERIVATIVES][2] = { { 1, 0 }, { 0, 1 }, { 2, 0 }, { 1, 1 }, { 0, 2 } };
	try {
		cv::Mat from(height, width, CV_32F, const_cast<float *>(in)), k[3];
		for (int i = 0; i < 3; i++)
			k[i] = kernel(sigma, i);
		for (int i = 0; i < CV_DERIVATIVES; i++) {
			if (!out[i])
				continue;
			cv::Mat one(height, width, CV_32F, out[i]);
			cv::sepFilter2D(from, one, CV_32F, k[orders[i][0]], k[orders[i][1]], cv::Point(-1, -1), 0, cv::BORDER_REFLECT_101);
		}
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "derivatives of %d x %d: %s", width, height, e.what());
	}
}
