#include "bridge/cv_draw.h"

#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

static cv::Mat view(const cv_picture *p)
{
	return cv::Mat(p->height, p->width, CV_8UC(p->channels), p->px);
}

static cv::Scalar scalar(const uint8_t colour[3])
{
	return cv::Scalar(colour[0], colour[1], colour[2]);
}

void cv_draw_line(const cv_picture *picture, int n, const float (*xy)[2], bool closed, int thickness,
                  const uint8_t colour[3])
{
	const int shift = 4, far = 1 << 20;  // beyond that, fixed point overflows
	try {
		std::vector<cv::Point> points;
		for (int i = 0; i < n; i++) {
			double x = (xy[i][0] - 0.5) * (1 << shift), y = (xy[i][1] - 0.5) * (1 << shift);
			if (std::fabs(x) < far && std::fabs(y) < far)
				points.emplace_back((int)std::lrint(x), (int)std::lrint(y));
		}
		if (points.size() < 2)
			return;
		cv::Mat m = view(picture);
		cv::polylines(m, points, closed, scalar(colour), thickness, cv::LINE_AA, shift);
	} catch (const std::exception &) {
		// A line less in a picture; nothing else depends on it.
	}
}

int cv_draw_text(const cv_picture *picture, double x, double y, double height, const char *text,
                 const uint8_t colour[3])
{
	try {
		std::string s;
		for (const unsigned char *p = (const unsigned char *)text; *p; p++)
			if ((*p & 0xc0) != 0x80)  // one mark for each UTF-8 character
				s += *p >= 0x20 && *p < 0x7f ? (char)*p : '?';
		const int font = cv::FONT_HERSHEY_DUPLEX, thickness = height > 17 ? 2 : 1;
		double scale = height / 22.0;  // capitals of this font are 22 px high at scale 1
		int base = 0;
		cv::Size size = cv::getTextSize(s, font, scale, thickness, &base);
		if (colour) {
			cv::Mat m = view(picture);
			cv::putText(m, s, cv::Point((int)std::lrint(x), (int)std::lrint(y)), font, scale, scalar(colour), thickness,
			            cv::LINE_AA);
		}
		return size.width;
	} catch (const std::exception &) {
		return 0;
	}
}
