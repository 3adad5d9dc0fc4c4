/* simd: loops compiled for several instruction sets, the best of which is chosen when the program starts.
 *
 * Results have the same bits with each, since floating-point contraction (fused multiply-add) is off (Makefile). Some files of the
 * renderer and the skin turn it on, where pictures are rounded to 1 / 255 or to half precision anyway: there the versions differ
 * in the last digit. It stays off where that digit decides what is seen: where a ray meets the eye, which texel it looks up,
 * Newton's steps that end before they converge (draw/eye/exact/sight.c, draw/eye/quick/quick.c, draw/eye/quick/colour.c,
 * draw/eye/march/tile_ground.c, draw/eye/march/node.c).
 */
#ifndef MATH_SIMD_H
#define MATH_SIMD_H

_Static_assert(sizeof(float) == 4, "lanes are of 32 bits");

#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) \
	&& (!defined(__clang__) || __clang_major__ >= 17)
#define SIMD_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
// Elsewhere there is one version, the compiler's baseline (on arm64 it has vectors anyway). Sanitisers cannot run before the choice is
// made, and clones made by older clangs cannot be called from other files.
#define SIMD_CLONES
#endif

// For loops written in vectors of 64 bytes, which compilers split badly for processors with shorter ones: a function marked SIMD_WIDE, to
// be called if SIMD_IS_WIDE, stands beside one in shorter vectors.
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
