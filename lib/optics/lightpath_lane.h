/* The solve of lightpath.c for many problems at once, without branches. Included by lightpath_batch.c once for
 * each type: REAL, SQRT, BLOCK and NAME(x) are defined there; hence no guard.
 */

/* A block of problems: structure of arrays. P inside; (x, y) the current K; w the direction, or nothing where
 * the light is a point C. */
struct NAME(block) {
	REAL px[BLOCK], py[BLOCK], pz[BLOCK], wx[BLOCK], wy[BLOCK], wz[BLOCK];
	REAL x[BLOCK], y[BLOCK], z[BLOCK], cos_i[BLOCK];
	REAL last2[BLOCK];  // square of the last step, mm²; huge where L is not convex
};

/* What all problems share. */
struct NAME(shared) {
	REAL R, R2, p, n, n2_1, reach2, C[3];
};

SIMD_INLINE REAL NAME(least)(REAL a, REAL b)
{
	return a < b ? a : b;
}

/* Unit direction from (x, y, z) to the light, and 1 / its distance. */
SIMD_INLINE REAL NAME(outward)(REAL u[3], const struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point,
                               REAL x, REAL y, REAL z)
{
	if (!point) {
		u[0] = b->wx[i];
		u[1] = b->wy[i];
		u[2] = b->wz[i];
		return 0;
	}
	REAL dx = c->C[0] - x, dy = c->C[1] - y, dz = c->C[2] - z, inv = 1 / SQRT(dx * dx + dy * dy + dz * dz);
	u[0] = dx * inv;
	u[1] = dy * inv;
	u[2] = dz * inv;
	return inv;
}

/* Where the ray from P in direction q leaves the surface. */
SIMD_INLINE void NAME(leave)(REAL K[3], const struct NAME(block) *b, int i, const struct NAME(shared) *c, const REAL q[3])
{
	REAL px = b->px[i], py = b->py[i], pz = b->pz[i], s = c->R - c->p * pz;
	REAL A = q[0] * q[0] + q[1] * q[1] + c->p * q[2] * q[2], B = px * q[0] + py * q[1] - s * q[2];
	REAL C = px * px + py * py - pz * (c->R + s), disc = B * B - A * C;
	REAL t = -C / (B + SQRT(disc > 0 ? disc : 0));
	K[0] = px + t * q[0];
	K[1] = py + t * q[1];
	K[2] = pz + t * q[2];
}

/* The closed-form start of lightpath.c. */
SIMD_INLINE void NAME(start)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point)
{
	REAL u[3], q[3], K[3];
	NAME(outward)(u, b, i, c, point, b->px[i], b->py[i], b->pz[i]);
	q[0] = u[0];
	q[1] = u[1];
	q[2] = u[2] - (REAL)LIGHTPATH_BEND;
	NAME(leave)(K, b, i, c, q);
	NAME(outward)(u, b, i, c, point, K[0], K[1], K[2]);
	REAL G[3] = { K[0], K[1], c->p * K[2] - c->R }, a = u[0] * G[0] + u[1] * G[1] + u[2] * G[2];
	REAL g2 = G[0] * G[0] + G[1] * G[1] + G[2] * G[2], f = (SQRT(a * a + c->n2_1 * g2) - a) / g2;
	for (int k = 0; k < 3; k++)
		q[k] = u[k] + f * G[k];
	NAME(leave)(K, b, i, c, q);
	b->x[i] = K[0];
	b->y[i] = K[1];
}

/* One Newton step on L in the chart (x, y), kept within `reach`. */
SIMD_INLINE void NAME(step)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point)
{
	REAL x = b->x[i], y = b->y[i], r2 = x * x + y * y, p = c->p, u[3];
	REAL over = r2 > c->reach2 ? SQRT(c->reach2 / r2) : 1;
	x *= over;
	y *= over;
	r2 *= over * over;
	REAL s = SQRT(c->R2 - p * r2), inv = 1 / (s * (c->R + s)), inv_s = inv * (c->R + s), z = r2 * inv * s;
	REAL out = NAME(outward)(u, b, i, c, point, x, y, z);
	REAL vx = x - b->px[i], vy = y - b->py[i], vz = z - b->pz[i], inv_d = 1 / SQRT(vx * vx + vy * vy + vz * vz);
	vx *= inv_d;
	vy *= inv_d;
	vz *= inv_d;
	REAL in = c->n * inv_d, sx = x * inv_s, sy = y * inv_s, gz = c->n * vz - u[2], bend = gz * inv_s;
	REAL gx = c->n * vx - u[0] + sx * gz, gy = c->n * vy - u[1] + sy * gz;
	REAL va = vx + sx * vz, vb = vy + sy * vz, f = in + out, e = f + bend * p;
	REAL hxx = f + bend + sx * sx * e - in * va * va, hyy = f + bend + sy * sy * e - in * vb * vb;
	REAL hxy = sx * sy * e - in * va * vb;
	if (point) {
		REAL ua = u[0] + sx * u[2], ub = u[1] + sy * u[2];
		hxx -= out * ua * ua;
		hyy -= out * ub * ub;
		hxy -= out * ua * ub;
	}
	REAL det = hxx * hyy - hxy * hxy, inv_det = 1 / det;
	REAL dx = (hxy * gy - hyy * gx) * inv_det, dy = (hxy * gx - hxx * gy) * inv_det;
	b->x[i] = x + dx;
	b->y[i] = y + dy;
	b->last2[i] = det > 0 && hxx > 0 ? dx * dx + dy * dy : 1;
}

/* K's depth, and the side on which the light stands. */
SIMD_INLINE void NAME(finish)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point)
{
	REAL x = b->x[i], y = b->y[i], r2 = x * x + y * y, s2 = c->R2 - c->p * r2, s = SQRT(s2 > 0 ? s2 : 0), u[3];
	b->z[i] = r2 / (c->R + s);
	NAME(outward)(u, b, i, c, point, x, y, b->z[i]);
	b->cos_i[i] = u[0] * x + u[1] * y - u[2] * s;
}
