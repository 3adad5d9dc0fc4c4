/* block: blocks of problems for lane.h. Included by batch.c after lane.h, once for each type; hence no include guard. */

#define LOOP(m, call)                                                                                                  \
	SIMD_LOOP                                                                                                      \
	for (int i = 0; i < (m); i++)                                                                                  \
		call

SIMD_CLONES static void NAME(start_directional)(struct NAME(block) *b, const struct NAME(shared) *c, int m)
{
	LOOP(m, NAME(bent)(b, i, c, false));
	LOOP(m, NAME(refracted)(b, i, c, false));
	LOOP(m, NAME(started)(b, i, c, false));
}

SIMD_CLONES static void NAME(start_along)(struct NAME(block) *b, const struct NAME(shared) *c, int m)
{
	LOOP(m, NAME(started)(b, i, c, true));
}

SIMD_CLONES static void NAME(start_point)(struct NAME(block) *b, const struct NAME(shared) *c, int m)
{
	LOOP(m, NAME(bent)(b, i, c, true));
	LOOP(m, NAME(refracted)(b, i, c, true));
	LOOP(m, NAME(started)(b, i, c, false));
}

SIMD_CLONES static void NAME(polish_directional)(struct NAME(block) *b, const struct NAME(shared) *c, int m, int steps)
{
	for (int k = 0; k < steps; k++) {
		LOOP(m, NAME(lengths)(b, i, c));
		LOOP(m, NAME(curve)(b, i, c, false));
		LOOP(m, NAME(move)(b, i, c));
	}
	struct NAME(shared) own = *c;  // a copy that stores to K cannot alias
	REAL *restrict K[] = { b->kx, b->ky, b->kz };
	LOOP(m, NAME(finish)(b, i, &own, false, K));
}

SIMD_CLONES static void NAME(polish_point)(struct NAME(block) *b, const struct NAME(shared) *c, int m, int steps)
{
	for (int k = 0; k < steps; k++) {
		LOOP(m, NAME(lengths)(b, i, c));
		LOOP(m, NAME(curve)(b, i, c, true));
		LOOP(m, NAME(move)(b, i, c));
	}
	struct NAME(shared) own = *c;  // a copy that stores to K cannot alias
	REAL *restrict K[] = { b->kx, b->ky, b->kz };
	LOOP(m, NAME(finish)(b, i, &own, true, K));
}

#undef LOOP

enum { NAME(IN) = 9, NAME(OUT) = 3 };

/* Loops work on whole vectors of 8 lanes: a block that is not a multiple of 8 is copied here and padded by repeating its last
 * problem. */
struct NAME(spare_lanes) {
	REAL in[NAME(IN)][BLOCK], out[NAME(OUT)][BLOCK];
};

/* Points the block to the problems [from, from + m) of a call: in the caller's arrays, or copied to the spare lanes. in: null
 * where not used. Returns the number of lanes, padded. */
static int NAME(load)(struct NAME(block) *b, struct NAME(spare_lanes) *spare, const REAL *const in[NAME(IN)],
                      REAL *const out[NAME(OUT)], long from, int m)
{
	const REAL **const to[] = { &b->px, &b->py, &b->pz, &b->wx, &b->wy, &b->wz, &b->qx, &b->qy, &b->qz };
	REAL **const K[] = { &b->kx, &b->ky, &b->kz };
	int whole = (m + 7) / 8 * 8;
	for (int k = 0; k < NAME(IN); k++) {
		*to[k] = in[k] ? in[k] + from : in[0] + from;
		if (whole == m)
			continue;
		for (int i = 0; i < whole; i++)
			spare->in[k][i] = (*to[k])[i < m ? i : m - 1];
		*to[k] = spare->in[k];
	}
	for (int k = 0; k < NAME(OUT); k++)
		*K[k] = whole != m ? spare->out[k] : out[k] ? out[k] + from : 0;
	return whole;
}

static struct NAME(shared) NAME(share)(const struct cornea *c, const double C[3])
{
	struct NAME(shared) shared = { .R = c->R, .p = c->p, .n = c->n, .n2_1 = c->n * c->n - 1, .inv_2R = 0.5 / c->R,
		                       .rim2 = c->rim * c->rim, .bend = path_bend(c->n) };
	// Near n = 1 the law of refraction has a sharp bend at grazing incidence: a step leaves a larger error.
	shared.far2 = FAR * FAR * fmin(fmax(4 * (c->n * c->n - 1), 0.01), 1);
	shared.ill = ILL;
	for (int k = 0; k < 3 && C; k++)
		shared.C[k] = C[k];
	return shared;
}

/* The arrays of a call, whichever of w and C it has. */
struct NAME(batch) {
	const REAL *in[NAME(IN)];  // P, w, and where to start: along these directions from P, or null
	REAL *out[NAME(OUT)];      // K
	unsigned char *status;
	const struct cornea *cornea;
	const double *C;
	double error;              // mm; 0: as good as the type is
};

/* Solves one lane by the scalar solver. */
static void NAME(alone)(struct NAME(block) *b, int i, const struct NAME(batch) *in)
{
	double P[3] = { b->px[i], b->py[i], b->pz[i] }, w[3] = { b->wx[i], b->wy[i], b->wz[i] }, K[3];
	b->status[i] = path_shortest(K, &(struct path){ in->cornea, P, in->C, in->C ? 0 : w });
	b->kx[i] = K[0];
	b->ky[i] = K[1];
	b->kz[i] = K[2];
}

/* Whether a lane has to be solved again: it has not converged; or it ended past grazing incidence although the light comes from
 * behind or may have passed a focus above P, so that a step may have overshot the path to where the surface faces away. *clear:
 * lightpath_clear_depth(), computed at first need; 0 before. */
static bool NAME(doubtful)(const struct NAME(block) *b, int i, const struct cornea *cornea, const double *C,
                           double *clear)
{
	if (b->again[i] || b->status[i] != LIGHTPATH_GRAZING)
		return b->again[i];
	if (!*clear)
		*clear = lightpath_clear_depth(cornea);
	return b->pz[i] > *clear || (C ? C[2] > b->kz[i] : b->wz[i] > 0);
}

/* Lists the lanes that have not converged or ended past grazing incidence; returns their number. */
static int NAME(unsure)(int lane[BLOCK + 1], const struct NAME(block) *b, int m)
{
	int n = 0;
	for (int from = 0; from < m; from += 8) {
		int any = 0, to = from + 8 < m ? from + 8 : m;
		for (int i = from; i < to; i++)
			any |= b->again[i] | (b->status[i] == LIGHTPATH_GRAZING);
		for (int i = from; any && i < to; i++) {
			lane[n] = i;
			n += b->again[i] | (b->status[i] == LIGHTPATH_GRAZING);
		}
	}
	return n;
}

/* Gathers n lanes of a block, of either type, into a block of their own, padded to whole vectors by repeating the last. */
#define GATHER(few, spare, b, lane, n)                                                                                 \
	for (int j = 0; j < ((n) + 7) / 8 * 8; j++) {                                                                  \
		int i = (lane)[j < (n) ? j : (n) - 1];                                                                 \
		(spare).in[0][j] = (b)->px[i], (spare).in[1][j] = (b)->py[i], (spare).in[2][j] = (b)->pz[i];           \
		(spare).in[3][j] = (b)->wx[i], (spare).in[4][j] = (b)->wy[i], (spare).in[5][j] = (b)->wz[i];           \
		(few).x[j] = (b)->x[i], (few).y[j] = (b)->y[i];                                                        \
	}

/* Further Newton steps for the lanes that have not converged, which are few. Returns their number. */
static int NAME(persist)(struct NAME(block) *b, const int lane[], int all, const struct NAME(batch) *batch, const struct NAME(shared) *shared)
{
	enum { STEPS = 3 };
	int late[BLOCK + 1], n = 0;
	for (int j = 0; j < all; j++) {
		late[n] = lane[j];
		n += b->again[lane[j]];
	}
	if (!n)
		return 0;
	struct NAME(block) few;
	struct NAME(spare_lanes) spare;
	GATHER(few, spare, b, late, n)
	const REAL *const in[] = { spare.in[0], spare.in[1], spare.in[2], spare.in[3], spare.in[4], spare.in[5], 0, 0, 0 };
	REAL *const out[] = { spare.out[0], spare.out[1], spare.out[2] };
	int whole = NAME(load)(&few, &spare, in, out, 0, (n + 7) / 8 * 8);
	(batch->C ? NAME(polish_point) : NAME(polish_directional))(&few, shared, whole, STEPS);
	for (int j = 0; j < n; j++) {
		int i = late[j];
		b->x[i] = few.x[j], b->y[i] = few.y[j];
		b->kx[i] = few.kx[j], b->ky[i] = few.ky[j], b->kz[i] = few.kz[j];
		b->status[i] = few.status[j];
		b->again[i] = few.again[j];
	}
	return n;
}

/* Solves lanes that are still doubtful, for instance because float is not precise enough, again in double. */
static void NAME(redo)(struct NAME(block) *b, int m, const struct NAME(batch) *batch, const struct NAME(shared) *shared, double *clear,
                       struct lightpath_again *count)
{
	int lane[BLOCK + 1], all = NAME(unsure)(lane, b, m), n = 0;
	if (!all)
		return;
	if (sizeof(REAL) < sizeof(double))
		count->longer += NAME(persist)(b, lane, all, batch, shared);
	for (int j = 0; j < all; j++)
		if (NAME(doubtful)(b, lane[j], batch->cornea, batch->C, clear))
			lane[n++] = lane[j];
	if (!n)
		return;
	count->in_double += n;
	struct double_block again;
	struct double_spare_lanes spare;
	GATHER(again, spare, b, lane, n)
	const double *const in[] = { spare.in[0], spare.in[1], spare.in[2], spare.in[3], spare.in[4], spare.in[5], 0, 0, 0 };
	double *const out[] = { spare.out[0], spare.out[1], spare.out[2] };
	struct double_shared exact = double_share(batch->cornea, batch->C);
	(batch->C ? double_polish_point : double_polish_directional)(&again, &exact, double_load(&again, &spare, in, out, 0, (n + 7) / 8 * 8), 4);
	for (int j = 0; j < n; j++) {
		int i = lane[j];
		b->kx[i] = again.kx[j], b->ky[i] = again.ky[j], b->kz[i] = again.kz[j];
		b->status[i] = again.status[j];
		if (double_doubtful(&again, j, batch->cornea, batch->C, clear) || again.status[j] != LIGHTPATH_OK)
			NAME(alone)(b, i, batch);
	}
}
#undef GATHER

/* Relaxes the criteria of convergence to a tolerance of `error` mm: after a last step of s mm, the error is s² mm at most. */
static void NAME(spare)(struct NAME(shared) *shared, double error)
{
	if (!(error > FAR * FAR))
		return;
	shared->far2 = error < 0.04 ? error : 0.04;
	shared->ill = error < ILL ? ILL * FAR * FAR / error : 0;
}

/* Converts int to bytes. */
SIMD_CLONES static void NAME(tell)(unsigned char *restrict out, const int *restrict status, int m)
{
	SIMD_LOOP
	for (int i = 0; i < m; i++)
		out[i] = (unsigned char)status[i];
}

static struct lightpath_again NAME(run)(const struct NAME(batch) *batch, int n, int steps)
{
	struct NAME(shared) shared = NAME(share)(batch->cornea, batch->C);
	NAME(spare)(&shared, batch->error);
	struct NAME(block) block;
	struct NAME(spare_lanes) spare;
	struct lightpath_again count = { 0 };
	double clear = 0;
	for (int from = 0; from < n; from += BLOCK) {
		int m = n - from < BLOCK ? n - from : BLOCK, whole = NAME(load)(&block, &spare, batch->in, batch->out, from, m);
		(batch->in[6] ? NAME(start_along) : batch->C ? NAME(start_point) : NAME(start_directional))(&block, &shared, whole);
		(batch->C ? NAME(polish_point) : NAME(polish_directional))(&block, &shared, whole, steps);
		NAME(redo)(&block, m, batch, &shared, &clear, &count);
		for (int k = 0; k < NAME(OUT) && whole != m; k++)
			memcpy(batch->out[k] + from, spare.out[k], (size_t)m * sizeof(REAL));
		if (batch->status)
			NAME(tell)(batch->status + from, block.status, m);
	}
	return count;
}
