#include "math/linalg.h"

#include <cblas.h>

int linalg_serial(void)
{
	int n = openblas_get_num_threads();
	openblas_set_num_threads(1);
	return n;
}

void linalg_threads(int n)
{
	openblas_set_num_threads(n);
}
