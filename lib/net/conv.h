/* conv: a convolution, computed directly: eight channels of the result at a time, some vectors of neighbouring pixels of each, which stay in registers while
 * all that goes into them is added up. Nothing is unfolded (im2row), which costs as much as the sums where channels are few.
 *
 *   out[o][y][x] = act(bias[o] + sum over c, i, j of weight[o][c][i][j] in[c][stride y + i - pad][stride x + j - pad])
 *
 * in this order (c, i, j), whatever the processor: those with a fused multiply-add give the same bits.
 */
#ifndef NET_CONV_H
#define NET_CONV_H
#include "net/planes.h"

enum { NET_CONV_TAPS = 225 };  // of a kernel, at most

enum net_act { NET_PLAIN, NET_RELU, NET_TANH };

struct net_conv {
	int in, out, groups;      // channels: those of a group of `out` see in / groups
	int height, width;        // of the kernel
	int stride, pad;
	enum net_act act;
	float *weight, *bias;     // as they are read, eight channels side by side: net_conv_free
};

/* Takes weight[out][in / groups][height][width] and bias[out] over, as they are read: unaligned, copied. c: all but weight and bias. */
void net_conv_make(struct net_conv *c, const void *weight, const void *bias);
void net_conv_free(struct net_conv *c);

/* Size of the result; height or width below 1 where the picture is smaller than the kernel. */
struct net_size net_conv_size(const struct net_conv *c, struct net_size in);

/* Floats that net_conv_run wants to work in; 0: none. */
size_t net_conv_floats(const struct net_conv *c, struct net_size in, int border);

/* out: of net_conv_size, set. in: its border, and out's, at least c->pad; of c->in channels. work: net_conv_floats. */
void net_conv_run(const struct net_planes *out, const struct net_conv *c, const struct net_planes *in, float *work);

#endif
