/* net: the four networks against OpenCV's dnn; sizes, pictures side by side, threads; files that are damaged, or of what is not run here. */
#include <omp.h>

#include "base/mem.h"
#include "bridge/cv_net.h"
#include "math/rng.h"
#include "net/file.h"
#include "net/net.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

/* Each with a size that it takes and what it makes of that, and others, odd ones where it takes them. */
static const struct {
	const char *path;
	int takes[3], gives[3], n, size[4][2];  // height, width
} nets[] = {
	{ "config/evidence.onnx", { 3, 32, 32 }, { 6, 16, 16 }, 4, { { 32, 32 }, { 96, 128 }, { 160, 256 }, { 224, 32 } } },
	{ "config/strip.onnx", { 8, 64, 160 }, { 1, 65, 160 }, 3, { { 64, 160 }, { 64, 16 }, { 64, 208 } } },
	{ "config/odds.onnx", { 36, 1, 1 }, { 9, 1, 1 }, 3, { { 1, 1 }, { 3, 5 }, { 1, 57 } } },
	{ "config/occlusion.onnx", { 8, 128, 128 }, { 4, 64, 64 }, 3, { { 128, 128 }, { 64, 96 }, { 16, 160 } } },
	{ "config/turn.onnx", { 3, 96, 96 }, { 4, 1, 1 }, 4, { { 96, 96 }, { 97, 101 }, { 71, 133 }, { 200, 65 } } },
};

static struct net *open_net(int i)
{
	struct net *net;
	struct err err = { 0 };
	if (!net_open(&net, nets[i].path, nets[i].takes, nets[i].gives, &err))
		fail_msg("%s", err.msg);
	return net;
}

static float *noise(struct rng *rng, int channels, int height, int width)
{
	const size_t n = (size_t)channels * (size_t)height * (size_t)width;
	float *v = mem_array(n, sizeof *v);
	for (size_t i = 0; i < n; i++)
		v[i] = (float)rng_uniform(rng);
	return v;
}

static void test_opencv(void **state)
{
	(void)state;
	struct rng rng = { 3 };
	for (int i = 0; i < COUNT(nets); i++) {
		struct net *net = open_net(i);
		struct err err = { 0 };
		char *onnx;
		size_t bytes;
		assert_true(net_file_read(&onnx, &bytes, nets[i].path, &err));
		struct cv_net *peer = cv_net_open(onnx, bytes, &err);
		if (!peer)
			fail_msg("%s: %s", nets[i].path, err.msg);
		for (int s = 0; s < nets[i].n; s++) {
			const int channels = nets[i].takes[0], height = nets[i].size[s][0], width = nets[i].size[s][1];
			float *in = noise(&rng, channels, height, width);
			int size[3] = { channels, height, width };
			struct net_picture p = { .in = in, .height = height, .width = width };
			float *want = cv_net_run(peer, in, size, &err);
			if (!want || !net_run(&p, 1, net, channels, &err))
				fail_msg("%s: %s", nets[i].path, err.msg);
			assert_memory_equal(p.size, size, sizeof size);
			for (int k = 0; k < size[0] * size[1] * size[2]; k++)
				if (!(fabs((double)p.out[k] - (double)want[k]) <= 1e-4 * fmax(1, fabs((double)want[k]))))  // other orders of the sums, through some twenty layers
					fail_msg("%s, %d x %d px: %g, OpenCV %g", nets[i].path, width, height, (double)p.out[k], (double)want[k]);
			free(want);
			free(p.out);
			free(in);
		}
		free(onnx);
		cv_net_close(peer);
		net_close(net);
	}
}

/* Pictures of several sizes side by side, on any number of threads, in memory that others have used: what each gives by itself in a network just opened. */
static void test_side_by_side(void **state)
{
	(void)state;
	enum { N = 7 };
	const int most = omp_get_max_threads();
	struct rng rng = { 4 };
	for (int i = 0; i < COUNT(nets); i++) {
		struct net_picture alone[N], p[N];
		struct net *net = open_net(i);
		struct err err = { 0 };
		for (int k = 0; k < N; k++) {
			const int *size = nets[i].size[k % nets[i].n];
			struct net *own = open_net(i);
			alone[k] = p[k] = (struct net_picture){ .in = noise(&rng, nets[i].takes[0], size[0], size[1]), .height = size[0], .width = size[1] };
			assert_true(net_run(&alone[k], 1, own, nets[i].takes[0], &err));
			net_close(own);
		}
		for (int threads = 1; threads <= 3; threads++) {
			omp_set_num_threads(threads);
			assert_true(net_run(p, N, net, nets[i].takes[0], &err));
			for (int k = 0; k < N; k++) {
				assert_memory_equal(p[k].size, alone[k].size, sizeof p[k].size);
				assert_memory_equal(p[k].out, alone[k].out, sizeof(float) * (size_t)(p[k].size[0] * p[k].size[1] * p[k].size[2]));
				free(p[k].out);
			}
		}
		for (int k = 0; k < N; k++) {
			free((float *)alone[k].in);
			free(alone[k].out);
		}
		net_close(net);
	}
	omp_set_num_threads(most);
}

/* A size that does not fit among others: none gets a result. */
static void test_sizes(void **state)
{
	(void)state;
	struct rng rng = { 5 };
	struct net *net = open_net(0);
	float *in = noise(&rng, 4, 64, 64);
	static const int bad[][2] = { { 33, 64 }, { 64, 40 }, { 0, 32 }, { 1 << 20, 1 << 10 }, { 1, 1 } };
	for (int i = 0; i < COUNT(bad); i++) {
		struct err err = { 0 };
		struct net_picture p[3] = { { .in = in, .height = 32, .width = 64 }, { .in = in, .height = bad[i][0], .width = bad[i][1] }, { .in = in, .height = 64, .width = 64 } };
		assert_false(net_run(p, 3, net, 3, &err));
		ERR_HAS(err, "does not take");
		assert_null(strchr(err.msg, '\n'));
		for (int k = 0; k < 3; k++)
			assert_null(p[k].out);
	}
	struct err err = { 0 };
	struct net_picture p = { .in = in, .height = 32, .width = 32 };
	assert_false(net_run(&p, 1, net, 4, &err));
	ERR_HAS(err, "4 channels");
	free(in);
	net_close(net);
}

/* The seal's sixteen digits, for what stands before it. */
static void seal(char *data, size_t size)
{
	enum { DIGITS = 16, SEALED = 29 };
	char value[DIGITS + 1];
	uint64_t hash = 0xcbf29ce484222325;
	for (size_t i = 0; i < size - SEALED; i++)
		hash = (hash ^ (unsigned char)data[i]) * 0x100000001b3;
	snprintf(value, sizeof value, "%016llx", (unsigned long long)hash);
	memcpy(data + size - DIGITS, value, DIGITS);
}

static bool opens(struct net **net, const char *path, int i, struct err *err)
{
	*err = (struct err){ 0 };
	const bool ok = net_open(net, path, nets[i].takes, nets[i].gives, err);
	assert_true(ok == (*net != 0));
	if (!ok) {
		assert_null(strchr(err->msg, '\n'));
		ERR_HAS(*err, path);
	}
	return ok;
}

/* A byte near words: those of names, attributes and shapes; weights hardly read like words. */
static size_t among_words(const char *data, size_t size, struct rng *rng)
{
	for (;;) {
		const size_t at = 16 + (size_t)rng_below(rng, (int)size - 32);
		int letters = 0;
		while (letters < 6 && data[at + (size_t)letters] >= '_' && data[at + (size_t)letters] <= 'z')
			letters++;
		if (letters == 6)
			return at + (size_t)rng_below(rng, 32) - 16;
	}
}

/* Sealed anew, so that the reader sees what was changed: it refuses, or what it takes runs. */
static void test_damaged(void **state)
{
	(void)state;
	struct rng rng = { 6 };
	int refused = 0;
	for (int i = 0; i < COUNT(nets); i++) {
		char *data;
		size_t size;
		struct err err = { 0 };
		struct net *net;
		float *in = noise(&rng, nets[i].takes[0], nets[i].takes[1], nets[i].takes[2]);
		assert_true(net_file_read(&data, &size, nets[i].path, &err));
		char *changed = mem_array(size, 1);
		for (int k = 0; k < (SANITISED ? 24 : 150); k++) {
			const size_t at = k % 8 ? among_words(data, size, &rng) : (size_t)rng_below(&rng, (int)size);
			memcpy(changed, data, size);
			changed[at] ^= (char)(1 << rng_below(&rng, 8));
			seal(changed, size);
			if (!opens(&net, scratch_write("changed.onnx", changed, size), i, &err)) {
				refused++;
				continue;
			}
			struct net_picture p = { .in = in, .height = nets[i].takes[1], .width = nets[i].takes[2] };
			if (net_run(&p, 1, net, nets[i].takes[0], &err))
				free(p.out);
			net_close(net);
		}
		for (int k = 1; k < 20; k++) {
			const size_t keep = (size_t)k * size / 20;
			memcpy(changed, data, keep);
			memcpy(changed + keep - 29, data + size - 29, 29);
			seal(changed, keep);
			assert_false(opens(&net, scratch_write("cut.onnx", changed, keep), i, &err));
		}
		free(changed);
		free(data);
		free(in);
	}
	assert_true(refused > (SANITISED ? 20 : 100));
}

/* The first place of `what` behind the first operation of a kind (field 4 of a node). */
static char *place(char *data, size_t size, const char *kind, const char *what)
{
	char head[32];
	snprintf(head, sizeof head, "\x22%c%s", (int)strlen(kind), kind);
	char *at = memmem(data, size, head, strlen(head));
	assert_non_null(at);
	at = memmem(at, size - (size_t)(at - data), what, strlen(what));
	assert_non_null(at);
	return at;
}

/* Each is one line that says what is not as it should be. */
static void test_not_run(void **state)
{
	(void)state;
	static const struct { int net; const char *kind, *what, *by, *says; } cases[] = {
		{ 2, "Tanh", "Tanh", "Tanx", "kind that is not run here" },
		{ 0, "Resize", "nearest", "nearesT", "Resize" },
		{ 0, "Resize", "floor", "round", "Resize" },
		{ 1, "AveragePool", "kernel_shape", "kernel_shapf", "AveragePool" },
		{ 4, "Conv", "strides", "stridez", "must be 4 of 1 x 1" },
		{ 4, "Relu", "Relu", "Tanh", 0 },
	};
	struct err err = { 0 };
	struct net *net;
	for (int i = 0; i < COUNT(cases); i++) {
		char *data;
		size_t size;
		err = (struct err){ 0 };
		assert_true(net_file_read(&data, &size, nets[cases[i].net].path, &err));
		memcpy(place(data, size, cases[i].kind, cases[i].what), cases[i].by, strlen(cases[i].by));
		seal(data, size);
		assert_true(opens(&net, scratch_write("other.onnx", data, size), cases[i].net, &err) == !cases[i].says);
		if (cases[i].says)
			ERR_HAS(err, cases[i].says);
		net_close(net);
		free(data);
	}
	err = (struct err){ 0 };
	assert_false(net_open(&net, nets[0].path, (const int[3]){ 3, 32, 32 }, (const int[3]){ 6, 16, 15 }, &err));
	ERR_HAS(err, "6 planes of 16 x 16, must be 6 of 15 x 16");
	err = (struct err){ 0 };
	assert_false(net_open(&net, nets[0].path, (const int[3]){ 4, 32, 32 }, (const int[3]){ 6, 16, 16 }, &err));
	ERR_HAS(err, "4 planes of 32 x 32");
	err = (struct err){ 0 };
	assert_false(net_open(&net, scratch_path("none.onnx"), nets[0].takes, nets[0].gives, &err));
	assert_null(net);
	net_close(net);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_opencv), cmocka_unit_test(test_side_by_side), cmocka_unit_test(test_sizes), SCRATCH_TEST(test_damaged),
		                            SCRATCH_TEST(test_not_run) };
	return cmocka_run_group_tests(tests, 0, 0);
}
