#include "net/tile.h"

#include <string.h>

#include "math/simd.h"

#if defined(__clang__)
#pragma clang fp contract(fast)
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=fast")  // see math/simd.h
#endif

/* A function `name` for vectors of `mask`'s size: HIGH channels of the tile, from `from` on, times WIDE vectors are added up at once, as many as there are
 * registers for. */
#define TILE(name, lanes, mask, HIGH, WIDE)                                                                               \
	typedef float lanes __attribute__((vector_size(sizeof(mask))));                                                   \
	typedef float lanes##_loose __attribute__((vector_size(sizeof(mask)), aligned(4), may_alias));                    \
	SIMD_INLINE void name(float *out, const struct net_tile *t, const float *in, long n, int from)                    \
	{                                                                                                                 \
		enum { EACH = sizeof(lanes) / sizeof(float), STEP = EACH * (WIDE) };                                      \
		for (long x = 0; x < n; x += STEP) {                                                                      \
			lanes sum[HIGH][WIDE];                                                                            \
			const float *weight = t->weight + from;                                                           \
			for (int i = 0; i < (HIGH); i++)                                                                  \
				for (int j = 0; j < (WIDE); j++)                                                          \
					sum[i][j] = t->bias[from + i] - (lanes){ 0 };                                     \
			for (int c = 0; c < t->channels; c++)                                                             \
				for (int k = 0; k < t->taps; k++, weight += NET_TILE) {                                   \
					const float *at = in + c * t->channel + t->tap[k] + x;                            \
					lanes px[WIDE];                                                                   \
					for (int j = 0; j < (WIDE); j++)                                                  \
						px[j] = *(const lanes##_loose *)(at + j * EACH);                          \
					for (int i = 0; i < (HIGH); i++)                                                  \
						for (int j = 0; j < (WIDE); j++)                                          \
							sum[i][j] += weight[i] * px[j];                                   \
				}                                                                                         \
			const long left = n - x < STEP ? n - x : STEP;                                                    \
			for (int i = 0; i < (HIGH) && from + i < t->count; i++) {                                         \
				for (int j = 0; j < (WIDE) && t->relu; j++)                                               \
					sum[i][j] = (lanes)((mask)sum[i][j] & (sum[i][j] > 0));                           \
				memcpy(out + (from + i) * t->plane + x, sum[i], (size_t)left * sizeof *out);              \
			}                                                                                                 \
		}                                                                                                         \
	}

typedef int mask_4 __attribute__((vector_size(16)));
typedef int mask_8 __attribute__((vector_size(32)));
typedef int mask_16 __attribute__((vector_size(64)));

#if defined(__x86_64__)
TILE(tile_4, lanes_4, mask_4, 4, 3)
TILE(tile_8, lanes_8, mask_8, 4, 3)
TILE(tile_16, lanes_16, mask_16, 8, 3)

SIMD_WIDE static void wide(float *out, const struct net_tile *t, const float *in, long n)
{
	tile_16(out, t, in, n, 0);
}

__attribute__((target("avx2,fma"))) static void middle(float *out, const struct net_tile *t, const float *in, long n)
{
	for (int from = 0; from < t->count; from += 4)
		tile_8(out, t, in, n, from);
}

static void narrow(float *out, const struct net_tile *t, const float *in, long n)
{
	for (int from = 0; from < t->count; from += 4)
		tile_4(out, t, in, n, from);
}

int net_tile_versions(net_tile_version *version[NET_TILE_VERSIONS])
{
	int n = 0;
	if (SIMD_IS_WIDE)
		version[n++] = wide;
	if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		version[n++] = middle;
	version[n++] = narrow;
	return n;
}
#else
TILE(tile_4, lanes_4, mask_4, 8, 3)

static void narrow(float *out, const struct net_tile *t, const float *in, long n)
{
	tile_4(out, t, in, n, 0);
}

int net_tile_versions(net_tile_version *version[NET_TILE_VERSIONS])
{
	version[0] = narrow;
	return 1;
}
#endif

void net_tile_run(float *out, const struct net_tile *t, const float *in, long n)
{
	net_tile_version *version[NET_TILE_VERSIONS];
	net_tile_versions(version);
	version[0](out, t, in, n);
}
