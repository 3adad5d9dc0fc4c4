/* Blocks of problems. Included by lightpath_batch.c after lightpath_lane.h, once for each type. */

#define LOOP(m, call)                                                                                                  \
	SIMD_LOOP                                                                                                      \
	for (int i = 0; i < (m); i++)                                                                                  \
		call

SIMD_CLONES static void NAME(start_directional)(struct NAME(block) *b, const struct NAME(shared) *c, int m)
{
	LOOP(m, NAME(bent)(b, i, c, false));
	LOOP(m, NAME(refracted)(b, i, c, false));
	LOOP(m, NAME(started)(b, i, c));
}

SIMD_CLONES static void NAME(start_along)(struct NAME(block) *b, const struct NAME(shared) *c, int m)
{
	LOOP(m, NAME(started)(b, i, c));
}

SIMD_CLONES static void NAME(start_point)(struct NAME(block) *b, const struct NAME(shared) *c, int m)
{
	LOOP(m, NAME(bent)(b, i, c, true));
	LOOP(m, NAME(refracted)(b, i, c, true));
	LOOP(m, NAME(started)(b, i, c));
}

SIMD_CLONES static void NAME(polish_directional)(struct NAME(block) *b, const struct NAME(shared) *c, int m, int steps)
{
	for (int k = 0; k < steps; k++) {
		LOOP(m, NAME(lengths)(b, i, c));
		LOOP(m, NAME(curve)(b, i, c, false));
		LOOP(m, NAME(move)(b, i, c));
	}
	LOOP(m, NAME(finish)(b, i, c, false));
}

SIMD_CLONES static void NAME(polish_point)(struct NAME(block) *b, const struct NAME(shared) *c, int m, int steps)
{
	for (int k = 0; k < steps; k++) {
		LOOP(m, NAME(lengths)(b, i, c));
		LOOP(m, NAME(curve)(b, i, c, true));
		LOOP(m, NAME(move)(b, i, c));
	}
	LOOP(m, NAME(finish)(b, i, c, true));
}

#undef LOOP

/* Lanes work in whole vectors: the last problem is repeated, with where it starts: in the chart, or along a direction.
 * Returns how many lanes are filled. */
static int NAME(pad)(struct NAME(block) *b, int m, bool chart)
{
	int whole = (m + 7) / 8 * 8;
	REAL *const all[] = { b->px, b->py, b->pz, b->wx, b->wy, b->wz, chart ? b->x : b->gx, chart ? b->y : b->gy, b->hxx };
	for (int k = 0; k < COUNT(all) - chart; k++)
		for (int i = m; i < whole; i++)
			all[k][i] = all[k][m - 1];
	return whole;
}

static struct NAME(shared) NAME(share)(const struct cornea *c, const double C[3])
{
	struct NAME(shared) shared = { .R = c->R, .p = c->p, .n = c->n, .n2_1 = c->n * c->n - 1, .inv_2R = 0.5 / c->R,
		                       .rim2 = c->rim * c->rim, .bend = path_bend(c->n) };
	// Near n = 1 the law of refraction bends sharply at grazing incidence: a step leaves more.
	shared.far2 = FAR * FAR * fmin(fmax(4 * (c->n * c->n - 1), 0.01), 1);
	shared.ill = ILL;
	for (int k = 0; k < 3 && C; k++)
		shared.C[k] = C[k];
	return shared;
}

/* The arrays of a call, whichever of w and C it has. */
struct NAME(batch) {
	const REAL *px, *py, *pz, *wx, *wy, *wz;
	REAL *kx, *ky, *kz;
	unsigned char *status;
	const struct cornea *cornea;
	const double *C;
	const REAL *q[3];   // where to start: along these directions from P; or null
	double error;       // mm; 0: as good as the type is
};

/* The one lane, by the scalar solver. */
static void NAME(alone)(struct NAME(block) *b, int i, const struct NAME(batch) *in)
{
	double P[3] = { b->px[i], b->py[i], b->pz[i] }, w[3] = { b->wx[i], b->wy[i], b->wz[i] }, K[3];
	b->status[i] = path_shortest(K, &(struct path){ in->cornea, P, in->C, in->C ? 0 : w });
	b->kx[i] = K[0];
	b->ky[i] = K[1];
	b->kz[i] = K[2];
}

/* Whether a lane needs another look: not converged; or past grazing incidence though the light comes from behind or may have
 * met a focus before it came so deep: a step may have gone past the path, to where the surface turns its back. clear:
 * lightpath_clear_depth(), or 0 as long as nobody asked. */
static bool NAME(doubtful)(const struct NAME(block) *b, int i, const struct cornea *cornea, const double *C,
                           double *clear)
{
	if (b->again[i] || b->status[i] != LIGHTPATH_GRAZING)
		return b->again[i];
	if (!*clear)
		*clear = lightpath_clear_depth(cornea);
	return b->pz[i] > *clear || (C ? C[2] > b->kz[i] : b->wz[i] > 0);
}

/* Those lanes, or that float cannot tell well enough, gathered and polished in double; their number. */
static int NAME(redo)(struct NAME(block) *b, int m, const struct NAME(batch) *in, double *clear)
{
	int lane[BLOCK + 1], n = 0, any = 0;
#pragma omp simd reduction(| : any)
	for (int i = 0; i < m; i++)
		any |= b->again[i] | (b->status[i] == LIGHTPATH_GRAZING);
	if (!any)
		return 0;
	for (int i = 0; i < m; i++) {
		lane[n] = i;
		n += NAME(doubtful)(b, i, in->cornea, in->C, clear);
	}
	if (!n)
		return 0;
	struct double_block again;
	for (int j = 0; j < n; j++) {
		int i = lane[j];
		again.px[j] = b->px[i], again.py[j] = b->py[i], again.pz[j] = b->pz[i];
		again.wx[j] = b->wx[i], again.wy[j] = b->wy[i], again.wz[j] = b->wz[i];
		again.x[j] = b->x[i], again.y[j] = b->y[i];
	}
	struct double_shared shared = double_share(in->cornea, in->C);
	(in->C ? double_polish_point : double_polish_directional)(&again, &shared, double_pad(&again, n, true), 4);
	for (int j = 0; j < n; j++) {
		int i = lane[j];
		b->kx[i] = again.kx[j], b->ky[i] = again.ky[j], b->kz[i] = again.kz[j];
		b->status[i] = again.status[j];
		if (double_doubtful(&again, j, in->cornea, in->C, clear) || again.status[j] != LIGHTPATH_OK)
			NAME(alone)(b, i, in);
	}
	return n;
}

/* The effort that an error allows: after a last step of s mm, s² mm are left at most. */
static void NAME(spare)(struct NAME(shared) *shared, double error)
{
	if (!(error > FAR * FAR))
		return;
	shared->far2 = error < 0.04 ? error : 0.04;
	shared->ill = error < ILL ? ILL * FAR * FAR / error : 0;
}

static long NAME(run)(const struct NAME(batch) *batch, int n, int steps)
{
	struct NAME(shared) shared = NAME(share)(batch->cornea, batch->C);
	NAME(spare)(&shared, batch->error);
	struct NAME(block) block;
	const REAL *const *q = batch->q;
	const REAL *const src[] = { batch->px, batch->py, batch->pz, batch->wx, batch->wy, batch->wz, q[0], q[1], q[2] };
	REAL *const dst[] = { block.px, block.py, block.pz, block.wx, block.wy, block.wz, block.gx, block.gy, block.hxx };
	long redone = 0;
	double clear = 0;
	for (int from = 0; from < n; from += BLOCK) {
		int m = n - from < BLOCK ? n - from : BLOCK;
		for (int k = 0; k < (q[0] ? 9 : 6); k++)
			memcpy(dst[k], (src[k] ? src[k] : src[0]) + from, m * sizeof(REAL));
		int whole = m % 8 ? NAME(pad)(&block, m, false) : m;
		(q[0] ? NAME(start_along) : batch->C ? NAME(start_point) : NAME(start_directional))(&block, &shared, whole);
		(batch->C ? NAME(polish_point) : NAME(polish_directional))(&block, &shared, whole, steps);
		redone += NAME(redo)(&block, m, batch, &clear);
		memcpy(batch->kx + from, block.kx, m * sizeof(REAL));
		memcpy(batch->ky + from, block.ky, m * sizeof(REAL));
		memcpy(batch->kz + from, block.kz, m * sizeof(REAL));
		if (batch->status)
			memcpy(batch->status + from, block.status, m);
	}
	return redone;
}
