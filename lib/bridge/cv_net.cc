#include "bridge/cv_net.h"

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <omp.h>
#include <opencv2/dnn.hpp>

extern "C" {
#include "base/file.h"
#include "base/mem.h"
}

struct cv_net {
	cv::dnn::Net net;
};

namespace {

const size_t most_bytes = 64 << 20;
/* ModelProto field 14 (metadata_props) of 27 bytes: key (7 bytes), value (16 bytes). */
const char seal_head[] = "\x72\x1b\x0a\x07" "fnv1a64" "\x12\x10";
const size_t head_size = sizeof seal_head - 1, digits = 16, seal_size = head_size + digits;

/* Fowler, Noll and Vo, 64 bits. */
uint64_t fnv1a(const char *data, size_t n)
{
	uint64_t hash = 0xcbf29ce484222325;
	for (size_t i = 0; i < n; i++)
		hash = (hash ^ static_cast<unsigned char>(data[i])) * 0x100000001b3;
	return hash;
}

bool sealed(const char *data, size_t size)
{
	if (size <= seal_size || std::memcmp(data + size - seal_size, seal_head, head_size) != 0)
		return false;
	char value[digits + 1];
	std::snprintf(value, sizeof value, "%016" PRIx64, fnv1a(data, size - seal_size));
	return std::memcmp(value, data + size - digits, digits) == 0;
}

int silent(int, const char *, const char *, const char *, int, void *)
{
	return 0;
}

/* OpenCV prints what it throws; what it throws is turned into an err here. */
struct quiet {
	cv::ErrorCallback was;
	void *data = nullptr;
	quiet() : was(cv::redirectError(silent, nullptr, &data)) {}
	~quiet() { cv::redirectError(was, data); }
};

bool load(cv_net **net, const char *path, const char *data, size_t size, err *err)
{
	if (!sealed(data, size))
		return err_set(err, "%s: damaged, or no network of this program: its bytes do not fit its seal", path);
	const quiet hush;
	cv_net *n = nullptr;
	try {
		n = new cv_net;
		n->net = cv::dnn::readNetFromONNX(data, size);
		n->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
		n->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
	} catch (const std::exception &e) {
		delete n;
		return err_set(err, "%s: OpenCV cannot use this network: %s", path, e.what());
	}
	*net = n;
	return true;
}

}  // namespace

bool cv_net_open(struct cv_net **net, const char *path, struct err *err)
{
	*net = nullptr;
	char *data = nullptr;
	size_t size = 0;
	if (!file_read(&data, &size, path, most_bytes, err))
		return false;
	const bool ok = load(net, path, data, size, err);
	std::free(data);
	return ok;
}

void cv_net_close(struct cv_net *net)
{
	delete net;
}

bool cv_net_run(float **out, int size[3], struct cv_net *net, const float *in, int channels, int height, int width, struct err *err)
{
	const quiet hush;
	*out = nullptr;
	try {
		if (cv::getNumThreads() != omp_get_max_threads())
			cv::setNumThreads(omp_get_max_threads());
		const int shape[4] = { 1, channels, height, width };
		net->net.setInput(cv::Mat(4, shape, CV_32F, const_cast<float *>(in)));
		const cv::Mat got = net->net.forward();
		if (got.dims != 4 || got.size[0] != 1 || got.type() != CV_32F || !got.isContinuous())
			return err_set(err, "network: gives no picture");
		for (int i = 0; i < 3; i++)
			size[i] = got.size[i + 1];
		*out = static_cast<float *>(mem_array(got.total(), sizeof(float)));
		std::memcpy(*out, got.ptr<float>(), got.total() * sizeof(float));
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "network: does not take %d x %d px of %d channels: %s", width, height, channels, e.what());
	}
}
