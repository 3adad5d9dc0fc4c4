/* lane: the method of lightpath.c for many problems at once, without branches. Included by batch.c once for each type, which
 * defines REAL, SQRT, NAME(x) and BLOCK; hence no include guard.
 */

/* A block of problems: structure of arrays. Inputs and outputs stay in the caller's arrays. */
struct NAME(block) {
	const REAL *px, *py, *pz;              // P, mm
	const REAL *wx, *wy, *wz;              // direction to the light; unused where it is a point
	const REAL *qx, *qy, *qz;              // where to start: along these directions from P; unused in the closed form
	REAL *kx, *ky, *kz;                    // K, mm
	REAL x[BLOCK], y[BLOCK];               // the current K in the chart of lengths()
	REAL tau[BLOCK], inv_d[BLOCK];         // one step's intermediate results
	REAL gx[BLOCK], gy[BLOCK], hxx[BLOCK], hxy[BLOCK], hyy[BLOCK];
	REAL last2[BLOCK];                     // square of the last step, mm²; huge where L is not convex
	REAL gain[BLOCK];
	int status[BLOCK], again[BLOCK];
};

/* What all problems share. */
struct NAME(shared) {
	REAL R, p, n, n2_1, inv_2R, rim2, bend, C[3];
	REAL far2, ill;  // a lane whose last step² is above far2 (mm²) or whose curvature is below ill (1/mm) is solved again
};

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

/* Length, in units of |q|, that the ray from P in direction q is inside the surface: num / den. */
SIMD_INLINE void NAME(reach)(REAL *num, REAL *den, const struct NAME(block) *b, int i, const struct NAME(shared) *c, const REAL q[3])
{
	REAL px = b->px[i], py = b->py[i], pz = b->pz[i], s = c->R - c->p * pz;
	REAL A = q[0] * q[0] + q[1] * q[1] + c->p * q[2] * q[2], B = px * q[0] + py * q[1] - s * q[2];
	REAL C = px * px + py * py - pz * (c->R + s), disc = B * B - A * C;
	*num = -C;
	*den = B + SQRT(disc > 0 ? disc : 0);
}

/* The point where it leaves the surface. */
SIMD_INLINE void NAME(leave)(REAL K[3], const struct NAME(block) *b, int i, const struct NAME(shared) *c, const REAL q[3])
{
	REAL num, den;
	NAME(reach)(&num, &den, b, i, c, q);
	REAL t = num / den;
	K[0] = b->px[i] + t * q[0];
	K[1] = b->py[i] + t * q[1];
	K[2] = b->pz[i] + t * q[2];
}

/* The closed-form start of lightpath.c in three loops (why: see lengths()): bent(), refracted(), started(). */
SIMD_INLINE void NAME(bent)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point)
{
	REAL q[3], K[3];
	NAME(outward)(q, b, i, c, point, b->px[i], b->py[i], b->pz[i]);
	q[2] -= c->bend;
	NAME(leave)(K, b, i, c, q);
	b->kx[i] = K[0];
	b->ky[i] = K[1];
	b->kz[i] = K[2];
}

SIMD_INLINE void NAME(refracted)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point)
{
	REAL kx = b->kx[i], ky = b->ky[i], kz = b->kz[i], u[3];
	NAME(outward)(u, b, i, c, point, kx, ky, kz);
	REAL gz = c->p * kz - c->R, a = u[0] * kx + u[1] * ky + u[2] * gz, g2 = kx * kx + ky * ky + gz * gz;
	REAL f = (SQRT(a * a + c->n2_1 * g2) - a) / g2;
	b->gx[i] = u[0] + f * kx;
	b->gy[i] = u[1] + f * ky;
	b->hxx[i] = u[2] + f * gz;
}

SIMD_INLINE void NAME(started)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool given)
{
	REAL q[3] = { given ? b->qx[i] : b->gx[i], given ? b->qy[i] : b->gy[i], given ? b->qz[i] : b->hxx[i] }, num, den;
	NAME(reach)(&num, &den, b, i, c, q);
	// The chart: where the line from the far end of the axis meets the plane z = 0, over 2R: K_x / (2 R - p K_z).
	REAL inv_t = 1 / (2 * c->R * den - c->p * (den * b->pz[i] + num * q[2]));
	b->x[i] = (den * b->px[i] + num * q[0]) * inv_t;
	b->y[i] = (den * b->py[i] + num * q[1]) * inv_t;
}

/* One Newton step on L, in the rational chart K = t (x, y, rho²), t = R tau, tau = 2 / (1 + p rho²), rho² = x² + y², which needs
 * no root and has no end at the equator. It is done in three loops, lengths(), curve() and move(): each is short enough that a
 * processor works on several vectors of lanes at a time, instead of waiting for the roots and quotients of one. */
SIMD_INLINE void NAME(lengths)(struct NAME(block) *b, int i, const struct NAME(shared) *c)
{
	// (1 + p rho²) / 2 times K - P, and one quotient for both.
	REAL x = b->x[i], y = b->y[i], rho2 = x * x + y * y, inv_tau = (REAL)0.5 + (REAL)0.5 * c->p * rho2;
	REAL vx = c->R * x - inv_tau * b->px[i], vy = c->R * y - inv_tau * b->py[i], vz = c->R * rho2 - inv_tau * b->pz[i];
	REAL far = SQRT(vx * vx + vy * vy + vz * vz), q = 1 / (inv_tau * far);
	b->tau[i] = far * q;
	b->inv_d[i] = inv_tau * inv_tau * q;
}

/* Gradient and Hessian of L over the tangents e + (x, y) m, m = tau (−p x, −p y, 1), of length 1 / t against the
 * chart's own. Terms of the second derivatives that vanish with the gradient are left out: it keeps the order and
 * converges a third of a step faster. */
SIMD_INLINE void NAME(curve)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point)
{
	REAL x = b->x[i], y = b->y[i], p = c->p, n = c->n, rho2 = x * x + y * y, tau = b->tau[i], inv_d = b->inv_d[i], u[3];
	REAL t = c->R * tau, kx = t * x, ky = t * y, kz = t * rho2;
	REAL out = NAME(outward)(u, b, i, c, point, kx, ky, kz);
	REAL vx = (kx - b->px[i]) * inv_d, vy = (ky - b->py[i]) * inv_d, vz = (kz - b->pz[i]) * inv_d;
	REAL g1 = n * vx - u[0], g2 = n * vy - u[1], g3 = n * vz - u[2];
	REAL gm = tau * (g3 - p * (x * g1 + y * g2)), vm = tau * (vz - p * (x * vx + y * vy));
	REAL va = vx + x * vm, vb = vy + y * vm, in = n * inv_d, f = in + out;
	REAL bend = f + gm * (1 + p * rho2) * c->inv_2R, m2 = f * tau * (tau * (1 + p * p * rho2) - 2 * p);
	b->gx[i] = g1 + x * gm;
	b->gy[i] = g2 + y * gm;
	REAL hxx = bend + m2 * x * x - in * va * va, hyy = bend + m2 * y * y - in * vb * vb;
	REAL hxy = m2 * x * y - in * va * vb;
	if (point) {
		REAL um = tau * (u[2] - p * (x * u[0] + y * u[1])), ua = u[0] + x * um, ub = u[1] + y * um;
		hxx -= out * ua * ua;
		hyy -= out * ub * ub;
		hxy -= out * ua * ub;
	}
	b->hxx[i] = hxx;
	b->hyy[i] = hyy;
	b->hxy[i] = hxy;
}

SIMD_INLINE void NAME(move)(struct NAME(block) *b, int i, const struct NAME(shared) *c)
{
	REAL gx = b->gx[i], gy = b->gy[i], hxx = b->hxx[i], hxy = b->hxy[i], hyy = b->hyy[i], t = c->R * b->tau[i];
	REAL det = hxx * hyy - hxy * hxy, inv = 1 / (det * t);
	REAL dx = (hxy * gy - hyy * gx) * inv, dy = (hxy * gx - hxx * gy) * inv;
	b->x[i] += dx;
	b->y[i] += dy;
	b->last2[i] = det > c->ill * (hxx + hyy) && hxx + hyy > 0 ? t * t * (dx * dx + dy * dy) : 1e9f;
}

/* K in mm, its status, and whether the lane has to be solved again. */
SIMD_INLINE void NAME(finish)(struct NAME(block) *b, int i, const struct NAME(shared) *c, bool point, REAL *restrict out[3])
{
	REAL x = b->x[i], y = b->y[i], rho2 = x * x + y * y, t = 2 * c->R / (1 + c->p * rho2), u[3];
	REAL kx = t * x, ky = t * y, kz = t * rho2;
	out[0][i] = kx;
	out[1][i] = ky;
	out[2][i] = kz;
	REAL near = NAME(outward)(u, b, i, c, point, kx, ky, kz);
	REAL cos_i = u[0] * kx + u[1] * ky - u[2] * (c->R - c->p * kz);
	int beyond = kx * kx + ky * ky > c->rim2 ? LIGHTPATH_BEYOND_RIM : LIGHTPATH_OK;
	beyond = c->p * kz > c->R ? LIGHTPATH_BEYOND_RIM : beyond;
	b->status[i] = cos_i < 0 ? LIGHTPATH_GRAZING : beyond;
	// Newton's method leaves an error of about the last step squared over 2 mm; more where the light is near. At the surface's far end steps
	// look small wherever they lead.
	int far = c->p * kz > (REAL)1.9 * c->R;
	b->again[i] = b->last2[i] * (1 + 4 * near * near) <= c->far2 ? far : 1;
}

/* Irradiance gain of lightpath_gain_batch(), from the Hessian of curve() at K. */
SIMD_INLINE void NAME(caustic)(struct NAME(block) *b, int i, const struct NAME(shared) *c)
{
	REAL x = b->x[i], y = b->y[i], p = c->p, tau = b->tau[i], inv_d = b->inv_d[i], t = c->R * tau, rho2 = x * x + y * y;
	REAL vx = (t * x - b->px[i]) * inv_d, vy = (t * y - b->py[i]) * inv_d, vz = (t * rho2 - b->pz[i]) * inv_d;
	REAL vm = tau * (vz - p * (x * vx + y * vy)), va = vx + x * vm, vb = vy + y * vm, f = c->n * inv_d;
	REAL mx = -tau * p * x, my = -tau * p * y;
	REAL m11 = 1 + x * mx - va * vx, m12 = x * my - va * vy, m21 = y * mx - vb * vx, m22 = 1 + y * my - vb * vy;
	REAL det = b->hxx[i] * b->hyy[i] - b->hxy[i] * b->hxy[i], moved = f * f * (m11 * m22 - m12 * m21) / det;
	// The tangents' cross product over |N_z| of it: their area in the plane, 1 + x m_x + y m_y, over N_z.
	REAL gz = c->R - p * t * rho2, g2 = t * t * rho2 + gz * gz, a = b->wx[i] * t * x + b->wy[i] * t * y - b->wz[i] * gz;
	REAL cos_i = a / SQRT(g2), area = (1 + x * mx + y * my) * SQRT(g2) / gz;
	REAL cos_t = SQRT(c->n2_1 + cos_i * cos_i), rs = (cos_i - cos_t) / (cos_i + cos_t), n2 = c->n2_1 + 1;
	REAL rp = (n2 * cos_i - cos_t) / (n2 * cos_i + cos_t), T = 1 - (REAL)0.5 * (rs * rs + rp * rp);
	REAL gain = T * cos_i * (moved < 0 ? -moved : moved) * area;
	b->gain[i] = cos_i > 0 ? gain : 0;
}
