/* strip_net: the network that reads strips (config/strip.onnx). */
#ifndef LIMBUS_STRIP_NET_H
#define LIMBUS_STRIP_NET_H
#include "limbus/strip.h"

struct strip_net;

/* Loads the network that comes with the programs. False, err set: the file is missing, damaged or of another shape. strip_close, which accepts
 * null. */
bool strip_open(struct strip_net **net, const char *path, struct err *err);
bool strip_open_shipped(struct strip_net **net, struct err *err);
void strip_close(struct strip_net *net);

/* How a strip is read: once; the mean of what the strip and its mirror image say, so that a mirrored photograph has a mirrored strip; the same without
 * what the evidence says of its pixels. */
enum strip_way { STRIP_ONCE, STRIP_MIRRORED, STRIP_BLIND };

/* Reads the strip round an ellipse. False, err set, where the network does not run. */
bool strip_read(struct strip *out, struct strip_net *net, const struct photo *photo, const struct evidence *evidence, const struct ellipse *e,
                enum strip_way way, const struct strip_conf *conf, struct err *err);

#endif
