/* The report of a training run: its warnings, and its memory. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "model/train/impl.h"

void train_warn(struct train *t, const char *fmt, ...)
{
	char *line = 0;
	va_list ap;
	va_start(ap, fmt);
	if (vasprintf(&line, fmt, ap) < 0)
		line = 0;
	va_end(ap);
	struct train_report *r = t->report;
	r->warnings = mem_grow(r->warnings, (size_t)r->n_warnings + 1, sizeof *r->warnings);
	r->warnings[r->n_warnings++] = line;
}

void train_report_free(struct train_report *r)
{
	for (int p = 0; p < TRAIN_PARTS; p++) {
		free(r->curve[p].linear);
		free(r->curve[p].rbf);
		free(r->curve[p].pca);
		free(r->curve[p].random);
		free(r->curve[p].linear_sigma);
		free(r->curve[p].rbf_sigma);
	}
	for (int i = 0; i < r->n_warnings; i++)
		free(r->warnings[i]);
	free(r->warnings);
	*r = (struct train_report){ 0 };
}
