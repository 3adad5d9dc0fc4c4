#include "bridge/cv_net.h"

#include <cstring>
#include <opencv2/dnn.hpp>

extern "C" {
#include "base/mem.h"
}

struct cv_net {
	cv::dnn::Net net;
};

namespace {

float *forward(cv::dnn::Net &net, const float *in, int size[3], err *err)
{
	const int shape[4] = { 1, size[0], size[1], size[2] };
	net.setInput(cv::Mat(4, shape, CV_32F, const_cast<float *>(in)));
	const cv::Mat got = net.forward();
	if (got.dims != 4 || got.size[0] != 1 || got.type() != CV_32F || !got.isContinuous()) {
		err_set(err, "OpenCV: gives no picture");
		return nullptr;
	}
	for (int i = 0; i < 3; i++)
		size[i] = got.size[i + 1];
	float *out = static_cast<float *>(mem_array(got.total(), sizeof(float)));
	std::memcpy(out, got.ptr<float>(), got.total() * sizeof(float));
	return out;
}

}  // namespace

struct cv_net *cv_net_open(const void *onnx, size_t bytes, struct err *err)
{
	cv_net *net = nullptr;
	try {
		net = new cv_net;
		net->net = cv::dnn::readNetFromONNX(static_cast<const char *>(onnx), bytes);
		net->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
		net->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
		return net;
	} catch (const std::exception &e) {
		delete net;
		err_set(err, "OpenCV: %s", e.what());
		return nullptr;
	}
}

void cv_net_close(struct cv_net *net)
{
	delete net;
}

float *cv_net_run(struct cv_net *net, const float *in, int size[3], struct err *err)
{
	const int threads = cv::getNumThreads();
	float *out = nullptr;
	cv::setNumThreads(1);
	try {
		out = forward(net->net, in, size, err);
	} catch (const std::exception &e) {
		err_set(err, "OpenCV: %s", e.what());
	}
	cv::setNumThreads(threads);
	return out;
}
