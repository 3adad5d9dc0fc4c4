#include "net/onnx.h"

static const int64_t COUNT_MOST = 1 << 28;

/* Appends a field's numbers, one or packed. False where there are more than fit, or they are damaged. */
static bool append(int64_t *number, int *n, int most, const struct proto_field *f)
{
	struct proto list = f->bytes;
	uint64_t value = f->value;
	const bool packed = proto_size(list) > 0;
	while (!packed || proto_number(&value, &list)) {
		if (*n == most)
			return false;
		number[(*n)++] = (int64_t)value;
		if (!packed)
			return true;
	}
	return list.at;
}

bool onnx_tensor_read(struct onnx_tensor *t, struct proto message)
{
	enum { DIMS = 1, TYPE = 2, NAME = 8, RAW = 9 };
	struct proto_field f;
	int64_t dim[ONNX_DIMS];
	*t = (struct onnx_tensor){ .count = 1 };
	while (proto_next(&f, &message)) {
		if (f.number == DIMS && !append(dim, &t->n_dims, ONNX_DIMS, &f))
			return false;
		if (f.number == TYPE)
			t->type = (int)f.value;
		if (f.number == NAME)
			t->name = f.bytes;
		if (f.number == RAW)
			t->raw = f.bytes;
	}
	for (int i = 0; i < t->n_dims; i++) {
		if (dim[i] < 0 || dim[i] > COUNT_MOST || t->count * dim[i] > COUNT_MOST)
			return false;
		t->dim[i] = dim[i];
		t->count *= dim[i];
	}
	const size_t each = t->type == ONNX_FLOAT ? sizeof(float) : sizeof(int64_t);
	return message.at && (t->type == ONNX_FLOAT || t->type == ONNX_INT64) && proto_size(t->raw) == (size_t)t->count * each;
}

static bool attribute_read(struct onnx_attribute *a, struct proto message)
{
	enum { NAME = 1, ONE = 3, TEXT = 4, TENSOR = 5, MANY = 8 };
	struct proto_field f;
	*a = (struct onnx_attribute){ 0 };
	while (proto_next(&f, &message)) {
		if ((f.number == ONE || f.number == MANY) && !append(a->number, &a->n, ONNX_DIMS, &f))
			return false;
		if (f.number == NAME)
			a->name = f.bytes;
		if (f.number == TEXT)
			a->text = f.bytes;
		if (f.number == TENSOR)
			a->tensor = f.bytes;
	}
	return message.at;
}

bool onnx_node_read(struct onnx_node *node, struct proto message)
{
	enum { IN = 1, OUT = 2, KIND = 4, ATTRIBUTE = 5 };
	struct proto_field f;
	*node = (struct onnx_node){ 0 };
	while (proto_next(&f, &message)) {
		if (f.number == IN) {
			if (node->n_in == ONNX_INPUTS)
				return false;
			node->in[node->n_in++] = f.bytes;
		}
		if (f.number == OUT && node->n_out++ == 0)
			node->out = f.bytes;
		if (f.number == KIND)
			node->kind = f.bytes;
		if (f.number == ATTRIBUTE)
			if (node->n_attributes == ONNX_ATTRIBUTES || !attribute_read(&node->attribute[node->n_attributes++], f.bytes))
				return false;
	}
	return message.at && node->n_out == 1;
}

const struct onnx_attribute *onnx_attribute(const struct onnx_node *node, const char *name)
{
	for (int i = 0; i < node->n_attributes; i++)
		if (proto_is(node->attribute[i].name, name))
			return &node->attribute[i];
	return 0;
}

bool onnx_numbers(int value[], int n, const struct onnx_node *node, const char *name, int otherwise, int low, int high)
{
	const struct onnx_attribute *a = onnx_attribute(node, name);
	if (a && a->n != n)
		return false;
	for (int i = 0; i < n; i++) {
		if (a && (a->number[i] < low || a->number[i] > high))
			return false;
		value[i] = a ? (int)a->number[i] : otherwise;
	}
	return true;
}
