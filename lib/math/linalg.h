/* linalg: the number of threads of BLAS and LAPACK (OpenBLAS), whose sums depend on it in the last digits. */
#ifndef MATH_LINALG_H
#define MATH_LINALG_H

/* Sets BLAS and LAPACK to one thread, so that results have the same bits on any machine. Returns how many there were, to be handed
 * to linalg_threads when done. Holds for the whole process. */
int linalg_serial(void);

/* Sets their number of threads. */
void linalg_threads(int n);

#endif
