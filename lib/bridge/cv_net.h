/* cv_net: a small neural network from an ONNX file, run by OpenCV's dnn on the processor.
 * The file ends in a seal: an entry of ONNX's own metadata, "fnv1a64", whose value is the FNV-1a hash of all bytes before the
 * entry. A cut or changed file fails it before any parser sees it; tests/evidence/train.py writes it. The whole may be compressed (gzip).
 */
#ifndef BRIDGE_CV_NET_H
#define BRIDGE_CV_NET_H
#ifdef __cplusplus
extern "C" {
#endif
#include "base/err.h"

struct cv_net;

/* Loads a network that must make, of takes[3] (channels, height, width), gives[3] (planes, height, width): it is tried on zeros. False, err set (one line with the
 * path), when the file is missing, damaged, without a seal, of operations that OpenCV cannot run, or of another shape. cv_net_close, which accepts null. */
bool cv_net_open(struct cv_net **net, const char *path, const int takes[3], const int gives[3], struct err *err);
void cv_net_close(struct cv_net *net);

struct cv_net_picture {
	const float *in;      // [channels][height][width]; any size that the network takes
	int height, width;
	float *out;           // set: [size[0]][size[1]][size[2]] (channels, height, width); free(); null where it failed
	int size[3];
};

/* Runs the network on n pictures, side by side on as many threads as OpenMP would take, each picture on one: the numbers are the
 * same on any number of them. Large pictures first keep all busy. Several threads may call it at once. A network for each picture at once is
 * read when it is first needed, and a size other than its last costs a set-up of some ms. False, err set, nothing to free, when the network does not take a size. */
bool cv_net_run(struct cv_net_picture *picture, int n, struct cv_net *net, int channels, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
