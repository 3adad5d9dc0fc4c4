/* conv: against the sum as it stands in the textbook, in double precision; every version of the loop against the others. */
#include "base/mem.h"
#include "math/rng.h"
#include "net/conv.h"
#include "net/room.h"
#include "net/tile.h"
#include "tests/lib/unit.h"

static float *noise(struct rng *rng, size_t n)
{
	float *v = mem_array(n, sizeof *v);
	for (size_t i = 0; i < n; i++)
		v[i] = (float)rng_normal(rng);
	return v;
}

static struct net_planes filled(struct net_size size, int border, const float *px)
{
	// What is left of others must not show: it is as if it were there.
	const size_t n = net_planes_floats(size, border);
	float *floats = mem_array(n, sizeof *floats);
	for (size_t i = 0; i < n; i++)
		floats[i] = NAN;
	const struct net_planes p = net_planes_in(floats, size, border);
	for (int row = 0; row < size.channels * size.height && px; row++)
		memcpy(net_planes_row(&p, row / size.height, row % size.height), px + (long)row * size.width, (size_t)size.width * sizeof *px);
	return p;
}

static void drop(struct net_planes *p)
{
	free(p->px - p->border * p->pitch - p->border);
}

/* The result at (o, y, x), and the sum of its terms' sizes, of which rounding is a share. */
static double textbook(double *size, const struct net_conv *c, const float *weight, const float *bias, const float *in, struct net_size s, int o, int y, int x)
{
	const int each = c->in / c->groups, group = o / (c->out / c->groups);
	double sum = (double)bias[o];
	*size = fabs(sum);
	for (int k = 0; k < each; k++)
		for (int i = 0; i < c->height; i++)
			for (int j = 0; j < c->width; j++) {
				const int row = c->stride * y + i - c->pad, col = c->stride * x + j - c->pad;
				if (row < 0 || row >= s.height || col < 0 || col >= s.width)
					continue;
				const double term = (double)weight[((o * each + k) * c->height + i) * c->width + j] * (double)in[((group * each + k) * s.height + row) * s.width + col];
				sum += term;
				*size += fabs(term);
			}
	return c->act == NET_RELU ? fmax(sum, 0) : c->act == NET_TANH ? tanh(sum) : sum;
}

static void check(struct rng *rng, struct net_conv c, struct net_size s, int border)
{
	const size_t taps = (size_t)(c.in / c.groups * c.height * c.width);
	float *weight = noise(rng, (size_t)c.out * taps), *bias = noise(rng, (size_t)c.out), *in = noise(rng, (size_t)(s.channels * s.height * s.width));
	net_conv_make(&c, weight, bias);
	const struct net_size size = net_conv_size(&c, s);
	assert_int_equal(size.height, (s.height + 2 * c.pad - c.height) / c.stride + 1);
	struct net_planes from = filled(s, border, in), to = filled(size, border, 0);
	const size_t n = net_conv_floats(&c, s, border);
	float *work = mem_array(n, sizeof *work);
	for (size_t i = 0; i < n; i++)
		work[i] = NAN;
	net_conv_run(&to, &c, &from, work);
	for (int o = 0; o < size.channels; o++)
		for (int y = -border; y < size.height + border; y++)
			for (int x = -border; x < size.width + border; x++) {
				double most, want = 0, got = (double)net_planes_row(&to, o, y)[x];
				if (y < 0 || y >= size.height || x < 0 || x >= size.width) {
					assert_true(got == 0);
					continue;
				}
				want = textbook(&most, &c, weight, bias, in, s, o, y, x);
				if (!(fabs(got - want) <= 1e-6 * most))  // of some hundred terms, each rounded to 6e-8
					fail_msg("%d of %d to %d, kernel %d x %d, stride %d, %d x %d px: %g at %d %d, must be %g", c.groups, c.in, c.out, c.width, c.height, c.stride,
					         s.width, s.height, got, x, y, want);
			}
	drop(&from);
	drop(&to);
	net_conv_free(&c);
	free(work);
	free(weight);
	free(bias);
	free(in);
}

static void test_textbook(void **state)
{
	(void)state;
	struct rng rng = { 11 };
	static const int kernels[][3] = { { 1, 1, 0 }, { 3, 3, 1 }, { 3, 3, 0 }, { 5, 5, 2 }, { 3, 1, 1 }, { 2, 4, 1 }, { 1, 1, 1 } };
	static const int widths[] = { 1, 2, 5, 16, 47, 50, 97 };
	for (int k = 0; k < COUNT(kernels); k++)
		for (int w = 0; w < COUNT(widths); w++)
			for (int stride = 1; stride <= 3; stride++) {
				const int groups = 1 + rng_below(&rng, 3), in = groups * (1 + rng_below(&rng, 12)), out = groups * (1 + rng_below(&rng, 18));
				const struct net_conv c = { in, out, groups, kernels[k][0], kernels[k][1], stride, kernels[k][2], (enum net_act)rng_below(&rng, 3), 0, 0 };
				const struct net_size s = { in, 1 + rng_below(&rng, 12), widths[w] };
				const struct net_size size = net_conv_size(&c, s);
				if (size.height > 0 && size.width > 0)
					check(&rng, c, s, kernels[k][2] + rng_below(&rng, 2));
			}
}

static void test_too_small(void **state)
{
	(void)state;
	const struct net_conv c = { 1, 1, 1, 5, 5, 2, 1, NET_PLAIN, 0, 0 };
	assert_int_equal(net_conv_size(&c, (struct net_size){ 1, 2, 9 }).height, 0);
	assert_int_equal(net_conv_size(&c, (struct net_size){ 1, 9, 2 }).width, 0);
	assert_int_equal(net_conv_size(&c, (struct net_size){ 1, 3, 3 }).width, 1);
}

/* Those that fuse give the same bits; the last one of x86 rounds twice as often. */
static void test_versions(void **state)
{
	(void)state;
	enum { N = 101, CHANNELS = 7, TAPS = 3, ROW = N + TAPS + 64, OUT = N + 5 };
	struct rng rng = { 5 };
	static const long tap[TAPS] = { 0, 1, 2 };
	net_tile_version *version[NET_TILE_VERSIONS];
	const int n = net_tile_versions(version);
	float *in = noise(&rng, CHANNELS * ROW), *weight = noise(&rng, CHANNELS * TAPS * NET_TILE), *bias = noise(&rng, NET_TILE);
	for (int count = 1; count <= NET_TILE; count++) {
		float out[NET_TILE_VERSIONS][NET_TILE * OUT] = { 0 };
		const struct net_tile t = { CHANNELS, TAPS, tap, ROW, weight, bias, OUT, count, count % 2 };
		for (int v = 0; v < n; v++)
			version[v](out[v], &t, in, N);
		for (int v = 1; v < n; v++)
			for (int i = 0; i < NET_TILE * OUT; i++) {
				if (v < n - 1)
					assert_memory_equal(&out[v][i], &out[0][i], sizeof(float));
				NEAR((double)out[v][i], (double)out[0][i], 1e-5);  // 22 terms of up to 10, each rounded to 6e-8
			}
		for (int i = 0; i < NET_TILE * OUT; i++)
			if (i / OUT >= count || i % OUT >= N)
				assert_true(out[0][i] == 0);
	}
	free(in);
	free(weight);
	free(bias);
}

/* What is left is taken again, the smallest that is large enough, or the largest, which grows. */
static void test_room(void **state)
{
	(void)state;
	struct net_room room = { 0 };
	const int a = net_room_take(&room, 100), b = net_room_take(&room, 1000);
	assert_int_not_equal(a, b);
	room.piece[a].floats[99] = room.piece[b].floats[999] = 1;
	net_room_leave(&room, a);
	net_room_leave(&room, b);
	assert_int_equal(net_room_take(&room, 90), a);
	net_room_leave(&room, a);
	assert_int_equal(net_room_take(&room, 101), b);
	assert_int_equal(net_room_take(&room, 2000), a);
	room.piece[a].floats[1999] = 1;
	assert_true(net_room_take(&room, 1) != a && room.n == 3);
	net_room_free(&room);
	net_room_free(&room);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_textbook), cmocka_unit_test(test_too_small), cmocka_unit_test(test_versions), cmocka_unit_test(test_room) };
	return cmocka_run_group_tests(tests, 0, 0);
}
