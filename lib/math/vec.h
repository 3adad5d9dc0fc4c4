/* vec: vectors of 3 and matrices of 3 x 3 numbers, row-major, double; vecf_: float. `out` may be an argument too. */
#ifndef MATH_VEC_H
#define MATH_VEC_H
#include <math.h>

static inline double vec_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vec_norm(const double a[3])
{
	return sqrt(vec_dot(a, a));
}

static inline void vec_cross(double out[3], const double a[3], const double b[3])
{
	double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
	out[0] = x;
	out[1] = y;
	out[2] = z;
}

/* out = a + s b */
static inline void vec_add(double out[3], const double a[3], double s, const double b[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] + s * b[i];
}

/* out = a / |a| */
static inline void vec_unit(double out[3], const double a[3])
{
	double n = vec_norm(a);
	for (int i = 0; i < 3; i++)
		out[i] = a[i] / n;
}

/* The same in float, in place; a vector of no length stays one. */
static inline void vecf_unit(float v[3])
{
	const float len = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 1e-12f;
	for (int c = 0; c < 3; c++)
		v[c] /= len;
}

/* out may not be an argument. */
static inline void vecf_cross(float out[3], const float a[3], const float b[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void mat_vec(double out[3], const double m[3][3], const double a[3])
{
	double t[3] = { vec_dot(m[0], a), vec_dot(m[1], a), vec_dot(m[2], a) };
	for (int i = 0; i < 3; i++)
		out[i] = t[i];
}

/* out = mᵀ a */
static inline void mat_tvec(double out[3], const double m[3][3], const double a[3])
{
	double t[3];
	for (int i = 0; i < 3; i++)
		t[i] = m[0][i] * a[0] + m[1][i] * a[1] + m[2][i] * a[2];
	for (int i = 0; i < 3; i++)
		out[i] = t[i];
}

static inline void mat_mul(double out[3][3], const double a[3][3], const double b[3][3])
{
	double t[3][3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			t[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = t[i][j];
}

/* The rotation of smallest angle with out a = b; a and b are unit vectors. */
void mat_smallest_rotation(double out[3][3], const double a[3], const double b[3]);

#endif
