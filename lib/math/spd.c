#include "math/spd.h"

#include <stdlib.h>
#include <string.h>

#include <suitesparse/cholmod.h>

#include "base/mem.h"

struct spd {
	cholmod_common common;
	cholmod_sparse *matrix;   // upper triangle by columns, which is the lower one by rows
	cholmod_factor *factor;
	int32_t *from;            // index of each entry's value in the caller's array
	cholmod_dense *y, *e;     // work space of the solves
	cholmod_dense *x;
};

struct spd *spd_new(int n, const int32_t *start, const int32_t *column)
{
	struct spd *s = mem_new(1, sizeof *s);
	size_t entries = 0;
	for (int i = 0; i < n; i++)
		for (int32_t k = start[i]; k < start[i + 1]; k++)
			entries += column[k] <= i;
	cholmod_start(&s->common);
	s->common.print = 0;
	s->common.final_ll = 1;  // L L', unlike L D L', fails for a matrix that is not positive definite
	s->common.error_handler = 0;
	s->matrix = cholmod_allocate_sparse((size_t)n, (size_t)n, entries, 0, 1, 1, CHOLMOD_REAL, &s->common);
	s->from = mem_array(entries + 1, sizeof *s->from);
	int32_t *p = s->matrix->p, *rows = s->matrix->i, at = 0;
	for (int i = 0; i < n; i++) {
		p[i] = at;
		for (int32_t k = start[i]; k < start[i + 1]; k++)
			if (column[k] <= i) {
				rows[at] = column[k];
				s->from[at++] = k;
			}
	}
	p[n] = at;
	s->factor = cholmod_analyze(s->matrix, &s->common);
	return s;
}

void spd_free(struct spd *s)
{
	if (!s)
		return;
	cholmod_free_dense(&s->y, &s->common);
	cholmod_free_dense(&s->e, &s->common);
	cholmod_free_dense(&s->x, &s->common);
	cholmod_free_factor(&s->factor, &s->common);
	cholmod_free_sparse(&s->matrix, &s->common);
	cholmod_finish(&s->common);
	free(s->from);
	free(s);
}

bool spd_factor(struct spd *s, const double *value)
{
	double *x = s->matrix->x;
	int32_t entries = ((int32_t *)s->matrix->p)[s->matrix->ncol];
	for (int32_t k = 0; k < entries; k++)
		x[k] = value[s->from[k]];
	return s->factor && cholmod_factorize(s->matrix, s->factor, &s->common) && s->common.status == CHOLMOD_OK
	       && s->factor->minor == s->matrix->ncol;
}

void spd_solve(struct spd *s, double *x, const double *b)
{
	size_t n = s->matrix->ncol;
	cholmod_dense rhs = { .nrow = n, .ncol = 1, .nzmax = n, .d = n, .x = (void *)b, .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE };
	cholmod_solve2(CHOLMOD_A, s->factor, &rhs, 0, &s->x, 0, &s->y, &s->e, &s->common);
	memcpy(x, s->x->x, n * sizeof *x);
}
