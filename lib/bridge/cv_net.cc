#include "bridge/cv_net.h"

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <omp.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <vector>
#include <zlib.h>

extern "C" {
#include "base/file.h"
#include "base/mem.h"
}

/* One of OpenCV's networks runs one picture at a time: as many as were ever needed at once. Those that rest remember the size of their last picture. */
struct resting {
	std::unique_ptr<cv::dnn::Net> net;
	int height, width;
};

struct cv_net {
	std::vector<char> data;
	std::mutex busy;
	std::vector<resting> rest;
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

/* How all of OpenCV is set while networks are read or run here, be it in several threads: what it throws is turned into an err, so it neither prints nor logs
 * that, and its own threads rest while pictures run side by side. The last one out sets it back. */
struct quiet {
	static std::mutex busy;
	static int inside;
	static cv::ErrorCallback callback;
	static void *data;
	static cv::utils::logging::LogLevel level;
	static int threads;
	quiet()
	{
		const std::lock_guard<std::mutex> hold(busy);
		if (inside++)
			return;
		level = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
		callback = cv::redirectError(silent, nullptr, &data);
		threads = cv::getNumThreads();
		cv::setNumThreads(1);
	}
	~quiet()
	{
		const std::lock_guard<std::mutex> hold(busy);
		if (--inside)
			return;
		cv::setNumThreads(threads);
		cv::redirectError(callback, data);
		cv::utils::logging::setLogLevel(level);
	}
};
std::mutex quiet::busy;
int quiet::inside, quiet::threads;
cv::ErrorCallback quiet::callback;
void *quiet::data;
cv::utils::logging::LogLevel quiet::level;

cv::dnn::Net read_net(const std::vector<char> &data)
{
	cv::dnn::Net net = cv::dnn::readNetFromONNX(data.data(), data.size());
	net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
	net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
	return net;
}

/* What a gzip file holds; empty: it is none, damaged, with something behind it, or longer than most_bytes. */
std::vector<char> expanded(const char *data, size_t size)
{
	enum { GZIP = 16 };  // zlib: with gzip's header and trailer
	z_stream z = {};
	if (size < 18 || std::memcmp(data, "\x1f\x8b", 2) != 0 || inflateInit2(&z, MAX_WBITS + GZIP) != Z_OK)
		return {};
	std::vector<char> out;
	int state = Z_OK;
	z.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(data));
	z.avail_in = static_cast<uInt>(size);
	while (state == Z_OK && out.size() < most_bytes) {
		const size_t piece = 1 << 16, before = out.size();
		out.resize(before + piece);
		z.next_out = reinterpret_cast<Bytef *>(out.data() + before);
		z.avail_out = static_cast<uInt>(piece);
		state = inflate(&z, Z_NO_FLUSH);
		out.resize(before + piece - z.avail_out);
	}
	inflateEnd(&z);
	return state == Z_STREAM_END && z.avail_in == 0 ? out : std::vector<char>();
}

bool load(cv_net **net, const char *path, const char *data, size_t size, err *err)
{
	if (!sealed(data, size))
		return err_set(err, "%s: damaged, or no network of this program: its bytes do not fit its seal", path);
	const quiet hush;
	cv_net *n = nullptr;
	try {
		n = new cv_net;
		n->data.assign(data, data + size);
		n->rest.push_back({ std::make_unique<cv::dnn::Net>(read_net(n->data)), 0, 0 });
	} catch (const std::exception &e) {
		delete n;
		return err_set(err, "%s: OpenCV cannot use this network: %s", path, e.what());
	}
	*net = n;
	return true;
}

/* A network that rests, best one that has run the picture's size: another one costs a set-up. A new one where none rests. */
resting borrow(cv_net *net, const cv_net_picture *p)
{
	{
		const std::lock_guard<std::mutex> hold(net->busy);
		size_t at = net->rest.size();
		while (at > 0 && !(net->rest[at - 1].height == p->height && net->rest[at - 1].width == p->width))
			at--;
		if (!net->rest.empty()) {
			std::swap(net->rest[at > 0 ? at - 1 : net->rest.size() - 1], net->rest.back());
			resting got = std::move(net->rest.back());
			net->rest.pop_back();
			return got;
		}
	}
	return { std::make_unique<cv::dnn::Net>(read_net(net->data)), 0, 0 };
}

void give_back(cv_net *net, resting &&used, const cv_net_picture *p)
{
	used.height = p->height;
	used.width = p->width;
	const std::lock_guard<std::mutex> hold(net->busy);
	net->rest.push_back(std::move(used));
}

bool run_one(cv_net_picture *p, cv_net *net, int channels, err *err)
{
	try {
		resting own = borrow(net, p);
		const int shape[4] = { 1, channels, p->height, p->width };
		own.net->setInput(cv::Mat(4, shape, CV_32F, const_cast<float *>(p->in)));
		{
			const cv::Mat got = own.net->forward();
			if (got.dims != 4 || got.size[0] != 1 || got.type() != CV_32F || !got.isContinuous())
				return err_set(err, "network: gives no picture");
			for (int i = 0; i < 3; i++)
				p->size[i] = got.size[i + 1];
			p->out = static_cast<float *>(mem_array(got.total(), sizeof(float)));
			std::memcpy(p->out, got.ptr<float>(), got.total() * sizeof(float));
		}
		give_back(net, std::move(own), p);
		return true;
	} catch (const std::exception &e) {
		return err_set(err, "network: does not take %d x %d px of %d channels: %s", p->width, p->height, channels, e.what());
	}
}

/* Reads a file, gzip or not, and loads the network in it. */
bool open_file(cv_net **net, const char *path, err *err)
{
	*net = nullptr;
	char *data = nullptr;
	size_t size = 0;
	if (!file_read(&data, &size, path, most_bytes, err))
		return false;
	const std::vector<char> plain = expanded(data, size);
	const bool ok = plain.empty() ? load(net, path, data, size, err) : load(net, path, plain.data(), plain.size(), err);
	std::free(data);
	return ok;
}

}  // namespace

void cv_net_close(struct cv_net *net)
{
	delete net;
}

bool cv_net_open(struct cv_net **net, const char *path, const int takes[3], const int gives[3], struct err *err)
{
	if (!open_file(net, path, err))
		return false;
	const std::vector<float> zeros(static_cast<size_t>(takes[0]) * static_cast<size_t>(takes[1]) * static_cast<size_t>(takes[2]));
	struct cv_net_picture p = {};
	p.in = zeros.data();
	p.height = takes[1];
	p.width = takes[2];
	bool ok = cv_net_run(&p, 1, *net, takes[0], err);
	if (ok && std::memcmp(p.size, gives, sizeof p.size) != 0)
		ok = err_set(err, "%d planes of %d x %d, must be %d of %d x %d", p.size[0], p.size[2], p.size[1], gives[0], gives[2], gives[1]);
	std::free(p.out);
	if (ok)
		return true;
	cv_net_close(*net);
	*net = nullptr;
	return err_wrap(err, "%s", path);
}

bool cv_net_run(struct cv_net_picture *picture, int n, struct cv_net *net, int channels, struct err *err)
{
	const int threads = n < omp_get_max_threads() ? n : omp_get_max_threads();
	for (int i = 0; i < n; i++)
		picture[i].out = nullptr;
	std::vector<struct err> errs(static_cast<size_t>(n));
	int failed = n;
	const quiet hush;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) reduction(min : failed)
	for (int i = 0; i < n; i++)
		if (!run_one(&picture[i], net, channels, &errs[static_cast<size_t>(i)]))
			failed = i < failed ? i : failed;
	if (failed == n)
		return true;
	*err = errs[static_cast<size_t>(failed)];
	for (int i = 0; i < n; i++) {
		std::free(picture[i].out);
		picture[i].out = nullptr;
	}
	return false;
}
