#include "iris/unrefract/lids.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

enum { ANGLES = SHEET_ANGLES, RINGS = SHEET_RINGS, LID_MIN_DEG = 20 };

/* A plane [size][size] read at the middle of a cell. */
static float cell_at(const float *plane, const struct sheet *sheet, int a, int r)
{
	double p[2];
	sheet_point(p, sheet, (r + 0.5) / RINGS, 2 * M_PI * (a + 0.5) / ANGLES);
	return sheet_sample(plane, sheet, p);
}

/* Evidence for each cell of the sheet: its standard score in its ring, the maximum over the planes so far; NAN where unseen. */
static void add_evidence(float (*cell)[RINGS], const float *plane, const float *seen, const float *iris, const struct sheet *sheet)
{
	const float least_spread = 0.2f;  // log: shading alone makes as much
	struct rings rings = rings_of(plane, iris, sheet, true, least_spread);
	rings_even(&rings);
	for (int a = 0; a < ANGLES; a++)
		for (int r = 0; r < RINGS; r++) {
			float z = fabsf(rings_z(&rings, cell_at(plane, sheet, a, r), (r + 0.5) / RINGS));
			cell[a][r] = cell_at(seen, sheet, a, r) >= 0.5f ? fmaxf(cell[a][r], z) : NAN;
		}
}

/* What is told of each cell is added: log odds, in units of the scores. */
static void add_told(float (*cell)[RINGS], const float *cover, const struct sheet *sheet, const struct unrefract_conf *conf)
{
	const float surest = 3;  // log odds of 20: the network is seldom right to more than that on photographs
	for (int a = 0; a < ANGLES; a++)
		for (int r = 0; r < RINGS; r++) {
			float p = fminf(fmaxf(cell_at(cover, sheet, a, r), 0.001f), 0.999f);
			cell[a][r] += (float)conf->lid_told * fminf(fmaxf(logf(p / (1 - p)), -surest), surest);
		}
}

/* Evidence for lid (positive) against iris (negative): unlike its ring in brightness, or in hue, which shading does not
 * change; and what is told. */
static void lid_evidence(float (*cell)[RINGS], const float *const logs[3], const float *seen, const float *iris, const float *cover,
                         const struct sheet *sheet, const struct unrefract_conf *conf)
{
	long n = (long)sheet->size * sheet->size;
	float *hue = mem_array((size_t)n, sizeof *hue), lid_z = (float)conf->lid_z;
	for (int c = 0; c < 3; c++)
		add_evidence(cell, logs[c], seen, iris, sheet);
	for (int c = 0; c < 2; c++) {
		for (long i = 0; i < n; i++)
			hue[i] = logs[c][i] - logs[c + 1][i];
		add_evidence(cell, hue, seen, iris, sheet);
	}
	for (int a = 0; a < ANGLES; a++)
		for (int r = 0; r < RINGS; r++)
			cell[a][r] = isfinite(cell[a][r]) ? fminf(cell[a][r], 2 * lid_z) - lid_z : 0;
	if (cover)
		add_told(cell, cover, sheet, conf);
	free(hue);
}

/* The best closed path by dynamic programming: at each angle the first covered ring, RINGS where open. It runs twice round,
 * so that the seam at angle 0 has no effect. */
static void lid_path(int path[ANGLES], float (*const gain)[RINGS + 1], double smooth)
{
	enum { STATES = RINGS + 1, STEPS = 2 * ANGLES };
	short(*from)[STATES] = mem_array(STEPS, sizeof *from);
	double best[STATES] = { 0 };
	for (int k = 0; k < STEPS; k++) {
		double next[STATES];
		for (int s = 0; s < STATES; s++) {
			int arg = s;
			for (int q = 0; q < STATES; q++)
				if (best[q] - smooth * abs(q - s) > best[arg] - smooth * abs(arg - s))
					arg = q;
			from[k][s] = (short)arg;
			next[s] = best[arg] - smooth * abs(arg - s) + gain[k % ANGLES][s];
		}
		for (int s = 0; s < STATES; s++)
			best[s] = next[s];
	}
	int s = 0;
	for (int q = 1; q < STATES; q++)
		s = best[q] > best[s] ? q : s;
	for (int k = STEPS - 1; k >= 0; k--) {
		if (k < STEPS - ANGLES / 2 && k >= ANGLES / 2)
			path[k % ANGLES] = s;
		s = from[k][s];
	}
	free(from);
}

/* Removes short covered arcs: a lid covers a long arc of the limbus; a shorter one is a shadow, a crypt or a reflection. */
static void drop_short(int path[ANGLES])
{
	int start = 0;
	while (start < ANGLES && path[start] < RINGS)
		start++;
	for (int i = 0; i < ANGLES && start < ANGLES; i++) {
		int a = (start + i) % ANGLES, n = 0;
		while (n < ANGLES && path[(a + n) % ANGLES] < RINGS)
			n++;
		for (int k = 0; k < n && n < LID_MIN_DEG * ANGLES / 360; k++)
			path[(a + k) % ANGLES] = RINGS;
		i += n;
	}
}

/* A lid shades the iris beside it: inwards from its edge all that is darker than its ring by `shadow` (log) in every colour belongs to
 * it. What is darker in some colours alone is pigment. */
static void add_shadow(int path[ANGLES], const float *const logs[3], const float *iris, const struct sheet *sheet, double shadow)
{
	const int deepest = RINGS / 5;  // such shadows are less than a millimetre wide
	struct rings rings[3];
	for (int c = 0; c < 3; c++)
		rings[c] = rings_of(logs[c], iris, sheet, true, 0.1f);
	for (int a = 0; a < ANGLES; a++) {
		int edge = path[a], r = edge;
		bool dark = edge < RINGS;
		while (dark && r > 0 && r > edge - deepest) {
			for (int c = 0; c < 3; c++)
				dark = dark && cell_at(logs[c], sheet, a, r - 1) < rings_median(&rings[c], (r - 0.5) / RINGS) - (float)shadow;
			r -= dark;
		}
		path[a] = r;
	}
}

void unrefract_lids(double lid_t[SHEET_ANGLES], const float *const logs[3], const float *seen, const float *iris, const float *cover,
                    const struct sheet *sheet, const struct unrefract_conf *conf)
{
	float(*cell)[RINGS] = mem_new(ANGLES, sizeof *cell);
	float(*gain)[RINGS + 1] = mem_array(ANGLES, sizeof *gain);
	lid_evidence(cell, logs, seen, iris, cover, sheet, conf);
	for (int a = 0; a < ANGLES; a++) {
		gain[a][RINGS] = 0;
		for (int r = RINGS - 1; r >= 0; r--)
			gain[a][r] = gain[a][r + 1] + cell[a][r];
	}
	int path[ANGLES];
	lid_path(path, gain, conf->lid_smooth);
	drop_short(path);
	if (cover)
		add_shadow(path, logs, iris, sheet, conf->lid_shadow);
	const int reach = 2;  // the path is quantised to rings; the mean over a few angles is finer
	for (int a = 0; a < ANGLES; a++) {
		lid_t[a] = 0;
		for (int k = -reach; k <= reach; k++)
			lid_t[a] += (double)path[(a + k + ANGLES) % ANGLES] / RINGS / (2 * reach + 1);
	}
	free(gain);
	free(cell);
}
