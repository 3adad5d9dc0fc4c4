#include "bridge/cv_ellipse.h"

#include <opencv2/imgproc.hpp>
#include <cmath>
#include <vector>

namespace {

bool from_rect(struct ellipse *e, const cv::RotatedRect &r, double shift)
{
	double a = r.size.width / 2.0, b = r.size.height / 2.0, angle = r.angle * M_PI / 180;
	if (a < b) {
		std::swap(a, b);
		angle += M_PI / 2;
	}
	angle = std::fmod(angle + 2 * M_PI, M_PI);
	*e = { r.center.x + shift, r.center.y + shift, a, b, angle };
	return b > 0 && std::isfinite(a + r.center.x + r.center.y);
}

}

bool cv_ellipse_fit(struct ellipse *e, int n, const double *xy, enum cv_ellipse_method method)
{
	try {
		std::vector<cv::Point2f> p;
		for (int i = 0; i < n; i++)
			p.emplace_back(static_cast<float>(xy[2 * i]), static_cast<float>(xy[2 * i + 1]));
		return from_rect(e, method == CV_ELLIPSE_LS ? cv::fitEllipse(p) : method == CV_ELLIPSE_AMS ? cv::fitEllipseAMS(p)
		                    : cv::fitEllipseDirect(p), 0);
	} catch (...) {
		return false;
	}
}

bool cv_otsu_ellipse(struct ellipse *e, const uint8_t *grey, int width, int height)
{
	try {
		cv::Mat in(height, width, CV_8U, const_cast<uint8_t *>(grey)), smooth, dark;
		cv::GaussianBlur(in, smooth, cv::Size(0, 0), 2);
		cv::threshold(smooth, dark, 0, 255, cv::THRESH_BINARY_INV | cv::THRESH_OTSU);
		std::vector<std::vector<cv::Point>> outlines;
		cv::findContours(dark, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
		double best = 0;
		for (const auto &o : outlines)
			if (o.size() >= 5 && cv::contourArea(o) > best) {
				best = cv::contourArea(o);
				if (!from_rect(e, cv::fitEllipse(o), 0.5))
					return false;
			}
		return best > 0;
	} catch (...) {
		return false;
	}
}

bool cv_hough_circle(struct ellipse *e, const uint8_t *grey, int width, int height, double r_min, double r_max)
{
	try {
		cv::Mat in(height, width, CV_8U, const_cast<uint8_t *>(grey)), smooth;
		cv::GaussianBlur(in, smooth, cv::Size(0, 0), 2);
		std::vector<cv::Vec3f> circles;
		cv::HoughCircles(smooth, circles, cv::HOUGH_GRADIENT, 2, r_min, 100, 30, static_cast<int>(r_min),
		                 static_cast<int>(r_max));
		if (circles.empty())
			return false;
		*e = { circles[0][0] + 0.5, circles[0][1] + 0.5, circles[0][2], circles[0][2], 0 };
		return e->b > 0;
	} catch (...) {
		return false;
	}
}
