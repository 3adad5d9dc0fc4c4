/* tile: the sums of a convolution for eight channels of its result, along a row: in vectors of the processor's width. */
#ifndef NET_TILE_H
#define NET_TILE_H
#include <stdbool.h>

enum { NET_TILE = 8 };

struct net_tile {
	int channels, taps;           // what is added up: `taps` pixels of each channel that is read
	const long *tap;              // [taps] floats from the first of them
	long channel;                 // floats from a channel that is read to the next
	const float *weight, *bias;   // [channels][taps][NET_TILE], [NET_TILE]
	long plane;                   // floats from a channel of the result to the next
	int count;                    // channels of the result that are written, the first of the eight
	bool relu;
};

/* out: n floats of each of t->count channels. in: may be read up to 63 floats beyond what the n pixels need. */
typedef void net_tile_version(float *out, const struct net_tile *t, const float *in, long n);

/* The versions that this processor runs, the fastest first; how many they are. All but the last one of x86 fuse multiplication and addition: they give the same bits. */
enum { NET_TILE_VERSIONS = 3 };
int net_tile_versions(net_tile_version *version[NET_TILE_VERSIONS]);

/* The fastest. */
net_tile_version net_tile_run;

#endif
