/* series: the numbers of an artifact, whatever its kind, as named series; and its texts. For comparing two builds' artifacts. */
#ifndef TESTS_SERIES_H
#define TESTS_SERIES_H
#include "base/err.h"

struct series {
	char *name;
	long n;
	double *v;
};

struct series_list {
	int n;
	struct series *of;
	char *text;  // all strings one after the other, without what names programs and inputs
};

/* EXR, PNG, JSON, CSV, NPY, NPZ, PLY, MP4 and GLB by the ending. series_free in any case. */
bool series_read(struct series_list *out, const char *path, struct err *err);
void series_free(struct series_list *list);

#endif
