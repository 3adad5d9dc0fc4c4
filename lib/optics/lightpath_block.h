/* Blocks of problems, and what the lanes leave over. Included after lightpath_lane.h, once for each type; TOO_FAR2 is the
 * square of the longest last step (mm) after which a solve counts as converged. */

SIMD_CLONES static void NAME(solve_directional)(struct NAME(block) *b, const struct NAME(shared) *c, int m, int steps)
{
	SIMD_LOOP
	for (int i = 0; i < m; i++)
		NAME(start)(b, i, c, false);
	for (int k = 0; k < steps; k++) {
		SIMD_LOOP
		for (int i = 0; i < m; i++)
			NAME(step)(b, i, c, false);
	}
	SIMD_LOOP
	for (int i = 0; i < m; i++)
		NAME(finish)(b, i, c, false);
}

SIMD_CLONES static void NAME(solve_point)(struct NAME(block) *b, const struct NAME(shared) *c, int m, int steps)
{
	SIMD_LOOP
	for (int i = 0; i < m; i++)
		NAME(start)(b, i, c, true);
	for (int k = 0; k < steps; k++) {
		SIMD_LOOP
		for (int i = 0; i < m; i++)
			NAME(step)(b, i, c, true);
	}
	SIMD_LOOP
	for (int i = 0; i < m; i++)
		NAME(finish)(b, i, c, true);
}

/* The arrays of a call, whichever of w and C it has. */
struct NAME(batch) {
	const REAL *px, *py, *pz, *wx, *wy, *wz;
	REAL *kx, *ky, *kz;
	unsigned char *status;
	const struct cornea *cornea;
	const double *C;
};

/* The lanes from `from` on into a block; rounded up to whole vectors by repeating the last. Returns their number. */
static int NAME(load)(struct NAME(block) *b, const struct NAME(batch) *in, int from, int n)
{
	int m = n - from < BLOCK ? n - from : BLOCK, whole = (m + 15) / 16 * 16;
	size_t size = m * sizeof(REAL);
	const REAL *const src[] = { in->px, in->py, in->pz, in->wx, in->wy, in->wz };
	REAL *const dst[] = { b->px, b->py, b->pz, b->wx, b->wy, b->wz };
	for (int k = 0; k < (in->C ? 3 : 6); k++) {
		memcpy(dst[k], src[k] + from, size);
		for (int i = m; i < whole; i++)
			dst[k][i] = dst[k][m - 1];
	}
	return whole;
}

/* One problem, by the solver that always ends well. */
static void NAME(alone)(const struct NAME(batch) *in, int i, unsigned char *status)
{
	double P[3] = { in->px[i], in->py[i], in->pz[i] }, K[3];
	if (in->C) {
		*status = lightpath_solve(K, in->cornea, P, in->C);
	} else {
		double w[3] = { in->wx[i], in->wy[i], in->wz[i] };
		*status = lightpath_solve_directional(K, in->cornea, P, w);
	}
	in->kx[i] = K[0];
	in->ky[i] = K[1];
	in->kz[i] = K[2];
}

static void NAME(store)(const struct NAME(batch) *out, const struct NAME(block) *b, int from, int n)
{
	int m = n - from < BLOCK ? n - from : BLOCK;
	double edge = cornea_edge(out->cornea), rim2 = edge * edge;
	memcpy(out->kx + from, b->x, m * sizeof(REAL));
	memcpy(out->ky + from, b->y, m * sizeof(REAL));
	memcpy(out->kz + from, b->z, m * sizeof(REAL));
	for (int i = 0; i < m; i++) {
		unsigned char status = b->cos_i[i] < 0 ? LIGHTPATH_GRAZING
		                       : b->x[i] * b->x[i] + b->y[i] * b->y[i] > rim2 ? LIGHTPATH_BEYOND_RIM
		                                                                      : LIGHTPATH_OK;
		if (!(b->last2[i] <= TOO_FAR2))
			NAME(alone)(out, from + i, &status);
		if (out->status)
			out->status[from + i] = status;
	}
}

static void NAME(run)(const struct NAME(batch) *batch, int n, int steps)
{
	const struct cornea *c = batch->cornea;
	double reach = lightpath_reach(c);
	struct NAME(shared) shared = { c->R, c->R * c->R, c->p, c->n, c->n * c->n - 1, reach * reach, { 0 } };
	for (int k = 0; k < 3 && batch->C; k++)
		shared.C[k] = batch->C[k];
	struct NAME(block) block;
	for (int from = 0; from < n; from += BLOCK) {
		int m = NAME(load)(&block, batch, from, n);
		if (batch->C)
			NAME(solve_point)(&block, &shared, m, steps);
		else
			NAME(solve_directional)(&block, &shared, m, steps);
		NAME(store)(batch, &block, from, n);
	}
}
