/* cv_net: a small neural network from an ONNX file, run by OpenCV's dnn on the processor.
 * The file ends in a seal: an entry of ONNX's own metadata, "fnv1a64", whose value is the FNV-1a hash of all bytes before the
 * entry. A cut or changed file fails it before any parser sees it; tests/evidence/train.py writes it.
 */
#ifndef BRIDGE_CV_NET_H
#define BRIDGE_CV_NET_H
#ifdef __cplusplus
extern "C" {
#endif
#include "base/err.h"

struct cv_net;

/* Loads the network. False, err set (one line with the path), when the file is missing, damaged, without a seal or of
 * operations that OpenCV cannot run. cv_net_close, which accepts null. */
bool cv_net_open(struct cv_net **net, const char *path, struct err *err);
void cv_net_close(struct cv_net *net);

/* Runs the network on one picture.
 * in    [channels][height][width]; any size that the network takes; a new size costs a set-up
 * out   set to [size[0]][size[1]][size[2]] values (channels, height, width); free()
 * On as many threads as OpenMP would take, with the same numbers on any number of them. One call at a time for each net. False, err set, when the network does not take
 * this size. */
bool cv_net_run(float **out, int size[3], struct cv_net *net, const float *in, int channels, int height, int width, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
