#include "bridge/cv_flow.h"

#include <algorithm>
#include <exception>
#include <opencv2/video/tracking.hpp>

static void sparse(double (*to)[2], const double (*from)[2], int n, const cv::Mat &before, const cv::Mat &after)
{
	std::vector<cv::Point2f> a((size_t)n), b((size_t)n);
	std::vector<uchar> found;
	std::vector<float> off;
	for (int i = 0; i < n; i++) {
		a[(size_t)i] = cv::Point2f((float)(from[i][0] - 0.5), (float)(from[i][1] - 0.5));
		b[(size_t)i] = cv::Point2f((float)(to[i][0] - 0.5), (float)(to[i][1] - 0.5));
	}
	cv::calcOpticalFlowPyrLK(before, after, a, b, found, off, cv::Size(21, 21), 3,
	                         cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01), cv::OPTFLOW_USE_INITIAL_FLOW);
	for (int i = 0; i < n; i++)
		if (found[(size_t)i]) {
			to[i][0] = (double)b[(size_t)i].x + 0.5;
			to[i][1] = (double)b[(size_t)i].y + 0.5;
		}
}

/* The flow field at a point, bilinear between pixels' centres. */
static cv::Vec2f at(const cv::Mat &flow, double x, double y)
{
	double u = std::clamp(x - 0.5, 0.0, flow.cols - 1.001), v = std::clamp(y - 0.5, 0.0, flow.rows - 1.001);
	int i = (int)u, j = (int)v;
	float s = (float)(u - i), t = (float)(v - j);
	const cv::Vec2f *top = flow.ptr<cv::Vec2f>(j) + i, *low = flow.ptr<cv::Vec2f>(j + 1) + i;
	return (1 - t) * ((1 - s) * top[0] + s * top[1]) + t * ((1 - s) * low[0] + s * low[1]);
}

static void dense(double (*to)[2], const double (*from)[2], int n, const cv::Mat &before, const cv::Mat &after, enum cv_flow_method method)
{
	cv::Mat flow;
	if (method == CV_FLOW_FARNEBACK)
		cv::calcOpticalFlowFarneback(before, after, flow, 0.5, 3, 15, 3, 5, 1.2, 0);
	else
		cv::DISOpticalFlow::create(method == CV_FLOW_DIS_FAST ? cv::DISOpticalFlow::PRESET_FAST : cv::DISOpticalFlow::PRESET_MEDIUM)
			->calc(before, after, flow);
	for (int i = 0; i < n; i++) {
		cv::Vec2f d = at(flow, from[i][0], from[i][1]);
		double x = from[i][0] + (double)d[0], y = from[i][1] + (double)d[1];
		to[i][0] = x;
		to[i][1] = y;
	}
}

bool cv_flow(double (*to)[2], const double (*from)[2], int n, const uint8_t *before, const uint8_t *after, int width, int height,
             enum cv_flow_method method, struct err *err)
{
	try {
		cv::Mat a(height, width, CV_8UC1, const_cast<uint8_t *>(before)), b(height, width, CV_8UC1, const_cast<uint8_t *>(after));
		if (method == CV_FLOW_LUCAS_KANADE)
			sparse(to, from, n, a, b);
		else
			dense(to, from, n, a, b, method);
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "flow between pictures of %d x %d: %s", width, height, e.what());
	}
}
