/* cv_net: a neural network from ONNX run by OpenCV's dnn on the processor, one picture on one thread: what net/net.h is compared with. */
#ifndef BRIDGE_CV_NET_H
#define BRIDGE_CV_NET_H
#include <stddef.h>

#include "base/err.h"

#ifdef __cplusplus
extern "C" {
#endif

struct cv_net;

/* The network in these bytes; null, err set, when OpenCV does not take it. cv_net_close, which accepts null. */
struct cv_net *cv_net_open(const void *onnx, size_t bytes, struct err *err);
void cv_net_close(struct cv_net *net);

/* in: [size[0]][size[1]][size[2]] (channels, height, width). size: set to that of the result. Returns the result, free(); null, err set, when OpenCV does not take
 * the picture. A size other than the last one costs a set-up. */
float *cv_net_run(struct cv_net *net, const float *in, int size[3], struct err *err);

#ifdef __cplusplus
}
#endif
#endif
