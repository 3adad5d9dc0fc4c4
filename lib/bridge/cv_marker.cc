#include "bridge/cv_marker.h"

#include <cstring>
#include <opencv2/aruco.hpp>

namespace {

/* One family of each size of code, and the most common AprilTags. Families of one size share ids 0 to 49. */
const cv::aruco::PREDEFINED_DICTIONARY_NAME families[] = {
	cv::aruco::DICT_4X4_1000, cv::aruco::DICT_5X5_1000, cv::aruco::DICT_6X6_1000,
	cv::aruco::DICT_7X7_1000, cv::aruco::DICT_ARUCO_ORIGINAL, cv::aruco::DICT_APRILTAG_36h11,
};

}  // namespace

bool cv_markers(int *n, struct cv_marker *markers, int most, const uint8_t *grey, int width, int height, struct err *err)
{
	*n = 0;
	try {
		const cv::Mat picture(height, width, CV_8U, const_cast<uint8_t *>(grey));
		auto parameters = cv::aruco::DetectorParameters::create();
		parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
		for (int f = 0; f < static_cast<int>(sizeof families / sizeof *families); f++) {
			std::vector<std::vector<cv::Point2f>> corners;
			std::vector<int> ids;
			cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(families[f]), corners, ids, parameters);
			for (size_t i = 0; i < ids.size() && *n < most; i++) {
				struct cv_marker *m = &markers[(*n)++];
				m->family = f;
				m->id = ids[i];
				for (size_t k = 0; k < 4; k++) {
					m->corner[k][0] = static_cast<double>(corners[i][k].x) + 0.5;
					m->corner[k][1] = static_cast<double>(corners[i][k].y) + 0.5;
				}
			}
		}
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "markers: %s", e.what());
	}
}

bool cv_marker_draw(uint8_t *out, int size, int family, int id, struct err *err)
{
	try {
		cv::Mat marker, all(size, size, CV_8U, out);
		const int margin = size / 8;
		cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(families[family]), id, size - 2 * margin, marker, 1);
		all.setTo(255);
		marker.copyTo(all(cv::Rect(margin, margin, size - 2 * margin, size - 2 * margin)));
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "marker: %s", e.what());
	}
}
