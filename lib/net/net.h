/* net: a small neural network from an ONNX file (net/file.h, net/graph.h), run on the processor. */
#ifndef NET_NET_H
#define NET_NET_H
#include "base/err.h"

struct net;

/* Loads a network that must make, of takes[3] (channels, height, width), gives[3] (planes, height, width). False, err set (one line with the path), *net null, when the
 * file is missing, damaged, without a seal, of operations that are not run here, or of another shape. net_close, which accepts null. */
bool net_open(struct net **net, const char *path, const int takes[3], const int gives[3], struct err *err);
void net_close(struct net *net);

struct net_picture {
	const float *in;     // [channels][height][width]; any size that the network takes
	int height, width;
	float *out;          // set: [size[0]][size[1]][size[2]] (channels, height, width); free(); null where it failed
	int size[3];
};

/* Runs the network on n pictures, side by side on as many threads as OpenMP would take, each picture on one: the numbers are the same on any number of them.
 * Large pictures first keep all busy. Several threads may call it at once. What a picture is worked out in (some MiB) stays with the network, once for each at
 * once. False, err set, nothing to free, when the network does not take a size. */
bool net_run(struct net_picture picture[], int n, struct net *net, int channels, struct err *err);

#endif
