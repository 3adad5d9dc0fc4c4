/* rng: seeded random numbers, the same on every machine (splitmix64). struct rng is initialised with the seed: { seed }. */
#ifndef MATH_RNG_H
#define MATH_RNG_H
#include <math.h>
#include <stdint.h>

struct rng {
	uint64_t state;
};

/* 64 random bits. */
static inline uint64_t rng_bits(struct rng *rng)
{
	uint64_t z = rng->state += 0x9e3779b97f4a7c15;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
	z = (z ^ z >> 27) * 0x94d049bb133111eb;
	return z ^ z >> 31;
}

/* Uniform in [0, 1). */
static inline double rng_uniform(struct rng *rng)
{
	return (double)(rng_bits(rng) >> 11) * 0x1p-53;
}

/* Uniform in [lo, hi). */
static inline double rng_range(struct rng *rng, double lo, double hi)
{
	return lo + (hi - lo) * rng_uniform(rng);
}

/* Normal, mean 0, variance 1 (Box and Muller). */
static inline double rng_normal(struct rng *rng)
{
	double u = 1 - rng_uniform(rng), v = rng_uniform(rng);
	return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

/* A whole number in 0 .. n - 1. */
static inline int rng_below(struct rng *rng, int n)
{
	return (int)(rng_uniform(rng) * n);
}

#endif
