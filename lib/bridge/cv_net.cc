#include "bridge/cv_net.h"

#include <cstring>
#include <opencv2/dnn.hpp>

extern "C" {
#include "base/mem.h"
}

float *cv_net_run(const void *onnx, size_t bytes, const float *in, int size[3], struct err *err)
{
	const int threads = cv::getNumThreads();
	float *out = nullptr;
	cv::setNumThreads(1);
	try {
		cv::dnn::Net net = cv::dnn::readNetFromONNX(static_cast<const char *>(onnx), bytes);
		net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
		net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
		const int shape[4] = { 1, size[0], size[1], size[2] };
		net.setInput(cv::Mat(4, shape, CV_32F, const_cast<float *>(in)));
		const cv::Mat got = net.forward();
		if (got.dims == 4 && got.size[0] == 1 && got.type() == CV_32F && got.isContinuous()) {
			for (int i = 0; i < 3; i++)
				size[i] = got.size[i + 1];
			out = static_cast<float *>(mem_array(got.total(), sizeof(float)));
			std::memcpy(out, got.ptr<float>(), got.total() * sizeof(float));
		} else {
			err_set(err, "network: gives no picture");
		}
	} catch (const std::exception &e) {
		err_set(err, "OpenCV: %s", e.what());
	}
	cv::setNumThreads(threads);
	return out;
}
