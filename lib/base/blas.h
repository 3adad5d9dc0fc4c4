/* blas: OpenBLAS, where a program is linked with it, made fit for a stage. */
#ifndef BASE_BLAS_H
#define BASE_BLAS_H
#include "base/err.h"

/* Gives it one thread: its sums depend on the number of its threads in the last digits, and its matrices here are small: a stage's own
 * threads want the cores. Where the address space is limited (ulimit -v) it reserves what as many threads of the stage's as that use in
 * it: OpenBLAS asks again for ever for memory that it does not get.
 * Returns false, err set, when the limit leaves no room. The program then has to end by _exit: a thread of OpenBLAS's may hang already. */
bool blas_prepare(int threads, struct err *err);

#endif
