/* simd: one loop, compiled for several instruction sets, the best chosen when the program starts.
 * The bits do not depend on which: floating-point contraction is off for all of them (Makefile). Where a file turns it on (the
 * renderer's and skin's, whose pictures round to 1 / 255 or to half precision), a multiplication and a sum are one rounding on processors
 * that have it, and the versions differ in the last digit. Not where such a digit decides what is seen: in where a ray meets the
 * eye, in which texels it looks, in Newton's steps that end before they have settled (draw/eye/exact/sight.c, draw/eye/quick/quick.c,
 * draw/eye/quick/colour.c, draw/eye/march/tile_ground.c, draw/eye/march/node.c).
 */
#ifndef MATH_SIMD_H
#define MATH_SIMD_H

_Static_assert(sizeof(float) == 4, "lanes are of 32 bits");

#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && (!defined(__clang__) || __clang_major__ >= 17)
#define SIMD_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
// Elsewhere the compiler's baseline is the one version (on arm64 it has vectors anyway); sanitisers cannot run
// before the choice is made, and what older clangs make of clones other files cannot call.
#define SIMD_CLONES
#endif

// For loops written in vectors of 64 bytes, which compilers take to pieces badly where a processor has shorter ones: a function
// to call if SIMD_IS_WIDE, beside one in shorter vectors.
#if defined(__x86_64__) && defined(__linux__) && (!defined(__clang__) || __clang_major__ >= 17)
#define SIMD_WIDE __attribute__((target("arch=x86-64-v4")))
#define SIMD_IS_WIDE \
	(__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") \
	 && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
#else
#define SIMD_WIDE
#define SIMD_IS_WIDE 0
#endif

#define SIMD_LOOP _Pragma("omp simd")
#define SIMD_INLINE static inline __attribute__((always_inline))

#endif
