#include "bridge/cv_face.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <vector>

struct cv_face_finder {
	cv::CascadeClassifier face, eye[2], mouth;
};

namespace {

const char *const folders[] = { "/usr/share/opencv4/haarcascades/", "/usr/share/opencv/haarcascades/",
	                            "/usr/local/share/opencv4/haarcascades/" };

/* Size, px, to which the picture is scaled for detecting faces, and a face for detecting eyes: several times that of the cascades'
 * training samples (20 px). */
const int picture_px = 640, face_px = 300;
/* Size of the smallest face, as a share of the picture's shorter side. */
const double least_face = 0.12;
/* Where eyes lie in a face's square, in shares of its side: rows, and least and greatest width of an eye's square. */
const double eye_rows[2] = { 0.18, 0.60 }, eye_side[2] = { 0.13, 0.40 };
/* Distance of the mouth below the middle of the eyes, over the distance of the eyes: mean of adults (Farkas 1994: 63 mm apart; 68
 * to 72 mm down). */
const double mouth_below = 1.1;
/* How far from there the mouth may lie, below the eyes and to the side, and the extent of the region searched, over the distance
 * of the eyes. */
const double mouth_least = 0.85, mouth_most = 1.45, mouth_aside = 0.25, mouth_region[2] = { 2, 1.4 };

bool load(cv::CascadeClassifier *c, const char *folder, const char *name)
{
	return c->load(std::string(folder) + name);
}

/* Sorts detections, since OpenCV's threads return them in any order. */
void sort(std::vector<cv::Rect> *r)
{
	std::sort(r->begin(), r->end(), [](const cv::Rect &a, const cv::Rect &b) {
		return a.width != b.width ? a.width > b.width : a.y != b.y ? a.y < b.y : a.x < b.x;
	});
}

/* Chooses the pair of eye detections that fits a face best: nearly level and symmetric about the middle. Positions as shares of
 * the face's square. */
bool pair_of(cv::Point2d eye[2], const std::vector<cv::Rect> &found, double side, double top)
{
	double best = 0.35;
	for (const cv::Rect &a : found)
		for (const cv::Rect &b : found) {
			const cv::Point2d p((a.x + 0.5 * a.width) / side, (a.y + 0.5 * a.height) / side + top);
			const cv::Point2d q((b.x + 0.5 * b.width) / side, (b.y + 0.5 * b.height) / side + top);
			const double apart = q.x - p.x;
			if (apart < 0.25 || apart > 0.6 || p.x > 0.5 || q.x < 0.5)
				continue;
			const double cost = std::abs(p.y - q.y) / apart + 0.5 * std::abs(p.x + q.x - 1) / apart
			                    + std::abs(std::log(static_cast<double>(a.width) / b.width)) / 2;
			if (cost < best) {
				best = cost;
				// The picture's left eye is the person's right one.
				eye[1] = p;
				eye[0] = q;
			}
		}
	return best < 0.35;
}

bool eyes_of(cv::Point2d eye[2], cv_face_finder *finder, const cv::Mat &grey, const cv::Rect &face)
{
	const cv::Rect strip(face.x, face.y + static_cast<int>(eye_rows[0] * face.height), face.width,
	                     static_cast<int>((eye_rows[1] - eye_rows[0]) * face.height));
	cv::Mat part;
	const double scale = static_cast<double>(face_px) / face.width;
	cv::resize(grey(strip & cv::Rect(0, 0, grey.cols, grey.rows)), part, cv::Size(), scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
	const cv::Size least(static_cast<int>(eye_side[0] * face_px), static_cast<int>(eye_side[0] * face_px));
	const cv::Size most(static_cast<int>(eye_side[1] * face_px), static_cast<int>(eye_side[1] * face_px));
	// The first cascade was trained on eyes with glasses too and errs least; the second detects more.
	for (cv::CascadeClassifier &c : finder->eye) {
		std::vector<cv::Rect> found;
		c.detectMultiScale(part, found, 1.05, 3, 0, least, most);
		sort(&found);
		if (pair_of(eye, found, face_px, eye_rows[0]))
			return true;
	}
	return false;
}

/* Finds the mouth by the cascade for smiles, which detects mouths at rest too, and noses, which lie too high: of the detections
 * below the eyes that with the most neighbours. */
bool mouth_of(cv::Point2d *mouth, cv_face_finder *finder, const cv::Mat &grey, const cv::Point2d &middle, const cv::Point2d &across)
{
	const double apart = std::hypot(across.x, across.y), scale = 0.4 * face_px / apart;
	const cv::Point2d down(-across.y, across.x), at = middle + mouth_below * down;
	const cv::Rect around(static_cast<int>(at.x - 0.5 * mouth_region[0] * apart), static_cast<int>(at.y - 0.5 * mouth_region[1] * apart),
	                      static_cast<int>(mouth_region[0] * apart), static_cast<int>(mouth_region[1] * apart));
	const cv::Rect inside = around & cv::Rect(0, 0, grey.cols, grey.rows);
	if (inside.width < 0.5 * around.width || inside.height < 0.5 * around.height)
		return false;
	cv::Mat part;
	cv::resize(grey(inside), part, cv::Size(), scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
	std::vector<cv::Rect> found;
	std::vector<int> times;
	finder->mouth.detectMultiScale(part, found, times, 1.05, 3, 0, cv::Size(face_px / 5, face_px / 10));
	int most = 0;
	double nearest = 0;
	for (size_t i = 0; i < found.size(); i++) {
		const cv::Point2d c(inside.x + (found[i].x + 0.5 * found[i].width) / scale, inside.y + (found[i].y + 0.5 * found[i].height) / scale);
		const double below = (c - middle).dot(down) / (apart * apart), aside = std::abs((c - middle).dot(across)) / (apart * apart);
		const double off = std::hypot(below - mouth_below, aside);
		if (below < mouth_least || below > mouth_most || aside > mouth_aside || times[i] < most || (times[i] == most && off >= nearest))
			continue;
		most = times[i];
		nearest = off;
		*mouth = c;
	}
	return most > 0;
}

/* Of a picture after `turn` quarter turns clockwise, width x height before. */
void turn_back(double out[2], double x, double y, int turn, int width, int height)
{
	const double at[4][2] = { { x, y }, { y, height - x }, { width - x, height - y }, { width - y, x } };
	out[0] = at[turn][0];
	out[1] = at[turn][1];
}

}  // namespace

bool cv_face_open(struct cv_face_finder **finder, struct err *err)
{
	*finder = nullptr;
	try {
		cv_face_finder *f = new cv_face_finder;
		for (const char *folder : folders)
			if (load(&f->face, folder, "haarcascade_frontalface_alt2.xml") && load(&f->eye[0], folder, "haarcascade_eye_tree_eyeglasses.xml")
			    && load(&f->eye[1], folder, "haarcascade_eye.xml") && load(&f->mouth, folder, "haarcascade_smile.xml")) {
				*finder = f;
				return true;
			}
		delete f;
		return err_set(err, "OpenCV's cascades are not installed: apt-get install opencv-data");
	} catch (const std::exception &e) {
		return err_set(err, "OpenCV's cascades: %s", e.what());
	}
}

void cv_face_close(struct cv_face_finder *finder)
{
	delete finder;
}

bool cv_face_find(int *n, struct cv_face *faces, int most, struct cv_face_finder *finder, const uint8_t *grey, int width,
                  int height, int turn, struct err *err)
{
	static const int turns[4] = { -1, cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_COUNTERCLOCKWISE };
	*n = 0;
	try {
		const cv::Mat whole(height, width, CV_8U, const_cast<uint8_t *>(grey));
		const double small = std::min(1.0, static_cast<double>(picture_px) / std::max(width, height));
		cv::Mat picture;
		if (turn)
			cv::rotate(whole, picture, turns[turn & 3]);
		else
			picture = whole;
		cv::Mat reduced;
		cv::resize(picture, reduced, cv::Size(), small, small, cv::INTER_AREA);
		const int least = std::max(20, static_cast<int>(least_face * std::min(reduced.cols, reduced.rows)));
		std::vector<cv::Rect> found;
		finder->face.detectMultiScale(reduced, found, 1.1, 3, 0, cv::Size(least, least));
		sort(&found);
		const double sx = static_cast<double>(picture.cols) / reduced.cols, sy = static_cast<double>(picture.rows) / reduced.rows;
		for (const cv::Rect &r : found) {
			const cv::Rect face(static_cast<int>(r.x * sx), static_cast<int>(r.y * sy), static_cast<int>(r.width * sx),
			                    static_cast<int>(r.height * sy));
			cv::Point2d eye[2];
			if (*n == most || !eyes_of(eye, finder, picture, face))
				continue;
			cv_face *out = &faces[(*n)++];
			for (cv::Point2d &e : eye)
				e = cv::Point2d(face.x + e.x * face.width, face.y + e.y * face.height);
			const cv::Point2d middle = 0.5 * (eye[0] + eye[1]), across = eye[0] - eye[1];
			for (int e = 0; e < 2; e++)
				turn_back(out->eye[e], eye[e].x, eye[e].y, turn & 3, width, height);
			cv::Point2d mouth(middle.x - mouth_below * across.y, middle.y + mouth_below * across.x);
			out->mouth_found = mouth_of(&mouth, finder, picture, middle, across);
			turn_back(out->mouth, mouth.x, mouth.y, turn & 3, width, height);
		}
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "faces: %s", e.what());
	}
}
