/* onnx: tensors, attributes and operations of an ONNX file, as they stand in it. */
#ifndef NET_ONNX_H
#define NET_ONNX_H
#include "net/proto.h"

enum { ONNX_DIMS = 4, ONNX_INPUTS = 4, ONNX_ATTRIBUTES = 16, ONNX_FLOAT = 1, ONNX_INT64 = 7 };

struct onnx_tensor {
	struct proto name, raw;  // raw: its values, little-endian, unaligned
	int type, n_dims;
	long dim[ONNX_DIMS], count;
};

struct onnx_attribute {
	struct proto name, text, tensor;
	int64_t number[ONNX_DIMS];
	int n;  // of numbers, be it one
};

struct onnx_node {
	struct proto kind, in[ONNX_INPUTS], out;
	int n_in, n_out, n_attributes;
	struct onnx_attribute attribute[ONNX_ATTRIBUTES];
};

/* False where it is damaged, of more dimensions or values than fit, or does not hold the values that its dimensions ask for. */
bool onnx_tensor_read(struct onnx_tensor *t, struct proto message);

/* False where it is damaged, or has more inputs or attributes than fit. */
bool onnx_node_read(struct onnx_node *node, struct proto message);

/* Attribute `name`: n numbers of [low, high] into value; `otherwise` where there is no such attribute. False: it holds others. */
bool onnx_numbers(int value[], int n, const struct onnx_node *node, const char *name, int otherwise, int low, int high);

/* Null where there is none. */
const struct onnx_attribute *onnx_attribute(const struct onnx_node *node, const char *name);

#endif
