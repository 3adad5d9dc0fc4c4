#include "field.h"

#include <stdlib.h>

#include "math/rng.h"

static float lattice(uint64_t seed, int i, int j, int nx, int ny)
{
	struct rng r = { seed * 0x9e3779b97f4a7c15 + (uint64_t)(((j % ny) + ny) % ny) * 7919 + (uint64_t)(((i % nx) + nx) % nx) };
	return (float)rng_uniform(&r);
}

/* Value noise with nx x ny cells over the texture. */
static void add_noise(struct field *f, uint64_t seed, int nx, int ny, float weight, bool ridged)
{
	float *grid = malloc((size_t)nx * ny * sizeof(float));
	for (int j = 0; j < ny; j++)
		for (int i = 0; i < nx; i++)
			grid[j * nx + i] = lattice(seed, i, j, nx, ny);
	for (int y = 0; y < FIELD_SIDE; y++)
		for (int x = 0; x < FIELD_SIDE; x++) {
			const float u = (float)x * (float)nx / FIELD_SIDE, v = (float)y * (float)ny / FIELD_SIDE;
			const int i = (int)u, j = (int)v, k = (i + 1) % nx, l = (j + 1) % ny;
			float a = u - (float)i, b = v - (float)j;
			a = a * a * (3 - 2 * a);
			b = b * b * (3 - 2 * b);
			const float top = grid[j * nx + i] + a * (grid[j * nx + k] - grid[j * nx + i]);
			const float bottom = grid[l * nx + i] + a * (grid[l * nx + k] - grid[l * nx + i]);
			const float value = top + b * (bottom - top);
			f->px[y][x] += weight * (ridged ? 1 - fabsf(2 * value - 1) : value);
		}
	free(grid);
}

static void add_cells(struct field *f, uint64_t seed)
{
	enum { N = 16 };
	struct rng rng = { seed };
	float at[N][N][2];
	for (int j = 0; j < N; j++)
		for (int i = 0; i < N; i++)
			for (int c = 0; c < 2; c++)
				at[j][i][c] = (float)rng_uniform(&rng);
	for (int y = 0; y < FIELD_SIDE; y++)
		for (int x = 0; x < FIELD_SIDE; x++) {
			const float u = (float)x * N / FIELD_SIDE, v = (float)y * N / FIELD_SIDE;
			float least = 9;
			for (int j = (int)v - 1; j <= (int)v + 1; j++)
				for (int i = (int)u - 1; i <= (int)u + 1; i++) {
					const float *p = at[(j + N) % N][(i + N) % N];
					const float dx = (float)i + p[0] - u, dy = (float)j + p[1] - v, d = dx * dx + dy * dy;
					least = d < least ? d : least;
				}
			f->px[y][x] = fminf(sqrtf(least) / 0.9F, 1);
		}
}

static void stretch(struct field *f)
{
	double sum = 0, square = 0;
	const float *p = &f->px[0][0];
	for (int i = 0; i < FIELD_SIDE * FIELD_SIDE; i++) {
		sum += p[i];
		square += (double)p[i] * p[i];
	}
	const double n = FIELD_SIDE * FIELD_SIDE, mean = sum / n, sd = sqrt(square / n - mean * mean);
	for (int i = 0; i < FIELD_SIDE * FIELD_SIDE; i++) {
		float *v = &f->px[0][0] + i;
		*v = (float)(0.5 + 0.22 * (*v - mean) / sd);
		*v = *v < 0 ? 0 : *v > 1 ? 1 : *v;
	}
}

static void make(struct field *f, enum field_kind kind, uint64_t seed)
{
	switch (kind) {
	case FIELD_SMOOTH:
		for (int o = 0; o < 5; o++)
			add_noise(f, seed + (uint64_t)o, 4 << o, 4 << o, 1.0F / (float)(1 << o), false);
		break;
	case FIELD_FINE:
		for (int o = 0; o < 3; o++)
			add_noise(f, seed + (uint64_t)o, 32 << o, 32 << o, 1, false);
		break;
	case FIELD_RIDGE:
		for (int o = 0; o < 4; o++)
			add_noise(f, seed + (uint64_t)o, 6 << o, 6 << o, 1.0F / (float)(1 << o), true);
		break;
	case FIELD_CELL:
		add_cells(f, seed);
		break;
	default:
		for (int o = 0; o < 3; o++)
			add_noise(f, seed + (uint64_t)o, 4 << o, 32 << o, 1.0F / (float)(1 + o), o == 0);
	}
	stretch(f);
}

const struct field *field_of(enum field_kind kind, int seed, bool test)
{
	static struct field *pool[2][FIELD_KINDS][FIELD_SEEDS];
	struct field **f = &pool[test][kind][seed];
	if (!*f) {
		*f = calloc(1, sizeof(struct field));
		make(*f, kind, (uint64_t)(1000 * kind + 10 * seed + (test ? 500000 : 1)));
	}
	return *f;
}
