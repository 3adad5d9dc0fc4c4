#include "track/lid/fine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/lid/colour.h"
#include "track/lid/path.h"

enum { PLACES = 6, RINGS = 10, ZONES = PLACES + RINGS, ROUNDS = 2, LEAN = 4 };

/* mm: standard deviation of the eye's end, halfway between the corners; distances from it beyond which cells are surely eye,
 * surely lid, and no longer read as lid; size of independent cells. */
static const double sigma_mm = 0.5, clear_eye = 0.19, clear_lid = 0.09, band_mm = 0.75, row_mm = 1.0 / 16;
/* Cost of a squared step of one cell; clamp of the log odds; smoothing of the curve. */
static const double bend = 0.3, sure = 3, soft = 2;

static double amid(int i)
{
	double t = (i + 0.5) / FINE_COLS;
	return 4 * t * (1 - t);
}

void lid_fine_look(struct lid_fine *fine, int lower, int n, const double margin[][2], double mm, const struct lid_picture *picture)
{
	struct line line = { .n = n < LINE ? n : LINE };
	double p[FINE_COLS + 2][2], colour[3];
	memcpy(line.p, margin, (size_t)line.n * sizeof *line.p);
	line_spread(p, FINE_COLS + 2, &line);
	fine->known = mm > 0;
	fine->mm = (float)mm;
	for (int i = 0; i < FINE_COLS; i++) {
		int a = i > 1 ? i - 2 : 0, b = i + 4 < FINE_COLS + 2 ? i + 4 : FINE_COLS + 1;
		double t[2] = { p[b][0] - p[a][0], p[b][1] - p[a][1] }, length = fmax(1e-9, hypot(t[0], t[1]));
		// upper margins run to the right of a left eye, and to the left of a right one
		double along = p[FINE_COLS + 1][0] > p[0][0] ? 1 : -1, side = (lower ? -1 : 1) * along;
		double out[2] = { side * t[1] / length, -side * t[0] / length };
		for (int k = 0; k < 2; k++) {
			fine->p[i][k] = (float)p[i + 1][k];
			fine->out[i][k] = (float)out[k];
		}
		for (int j = 0; j < FINE_CELLS; j++) {
			double off = (j - FINE_MIDDLE) * lid_fine_step(fine);
			lid_picture_at(colour, picture, p[i + 1][0] + off * out[0], p[i + 1][1] + off * out[1]);
			fine->bin[i][j] = (uint16_t)lid_colour_bin((const uint8_t[3]){ (uint8_t)(colour[0] + 0.5), (uint8_t)(colour[1] + 0.5), (uint8_t)(colour[2] + 0.5) });
		}
	}
}

/* Zone of the eye, a ring about the iris, of cell j of column i. */
static int ring_of(const struct lid_fine_frame *f, int i, int j)
{
	static const double outer[] = { 0.3, 0.45, 0.6, 0.75, 0.9, 1.05, 1.6 };
	double off = (j - FINE_MIDDLE) * lid_fine_step(f->look), d[2];
	for (int k = 0; k < 2; k++)
		d[k] = ((double)f->look->p[i][k] + off * (double)f->look->out[i][k] - f->iris[k]) / f->iris[2];
	double r2 = d[0] * d[0] + d[1] * d[1];
	int ring = 0;
	while (ring < COUNT(outer) && r2 > outer[ring] * outer[ring])
		ring++;
	return PLACES + ring + (ring >= COUNT(outer) - 1 && d[0] > 0 ? 2 : 0);
}

static int place_of(int i)
{
	return i * PLACES / FINE_COLS;
}

static void learn(float (*seen)[LID_BINS], const struct lid_fine_frame *f)
{
	double step = lid_fine_step(f->look), mm = (double)f->look->mm;
	for (int i = 0; i < FINE_COLS; i++)
		for (int j = 0; j < FINE_CELLS; j++) {
			double off = (j - FINE_MIDDLE) * step - f->end[i];
			if (off < -clear_eye * mm)
				seen[ring_of(f, i, j)][f->look->bin[i][j]]++;
			else if (off > clear_lid * mm && off < band_mm * mm)
				seen[place_of(i)][f->look->bin[i][j]]++;
		}
}

/* Cost of the boundary between cells j - 1 and j of column i. */
static void costs(float cost[FINE_COLS][FINE_CELLS], const struct lid_fine_frame *f, float (*says)[LID_BINS])
{
	double step = lid_fine_step(f->look), mm = (double)f->look->mm, worth = step / (row_mm * mm);
	for (int i = 0; i < FINE_COLS; i++) {
		double sum = 0, sigma = sigma_mm * mm * amid(i);
		for (int j = 0; j < FINE_CELLS; j++) {
			double u = ((j - 0.5 - FINE_MIDDLE) * step - f->expect[i]) / sigma;
			cost[i][j] = (float)(0.5 * u * u - sum);
			int bin = f->look->bin[i][j];
			sum += worth * fmax(-sure, fmin(sure, (double)(says[ring_of(f, i, j)][bin] - says[place_of(i)][bin])));
		}
	}
}

/* The cheapest path through all columns (dynamic programming). */
static void way(int path[FINE_COLS], float cost[FINE_COLS][FINE_CELLS])
{
	signed char from[FINE_COLS][FINE_CELLS] = { { 0 } };
	float sum[FINE_CELLS], before[FINE_CELLS];
	memcpy(sum, cost[0], sizeof sum);
	for (int i = 1; i < FINE_COLS; i++) {
		memcpy(before, sum, sizeof before);
		for (int j = 0; j < FINE_CELLS; j++) {
			float best = INFINITY;
			for (int k = -LEAN; k <= LEAN; k++) {
				float c = j - k < 0 || j - k >= FINE_CELLS ? INFINITY : before[j - k] + (float)(bend * k * k);
				if (c < best) {
					best = c;
					from[i][j] = (signed char)k;
				}
			}
			sum[j] = best + cost[i][j];
		}
	}
	int j = 0;
	for (int k = 1; k < FINE_CELLS; k++)
		j = sum[k] < sum[j] ? k : j;
	for (int i = FINE_COLS - 1; i >= 0; i--) {
		path[i] = j;
		j -= from[i][j];
	}
}

static void find(struct lid_fine_frame *f, float (*says)[LID_BINS])
{
	float cost[FINE_COLS][FINE_CELLS];
	int path[FINE_COLS];
	double y[FINE_COLS], w[FINE_COLS];
	costs(cost, f, says);
	way(path, cost);
	for (int i = 0; i < FINE_COLS; i++) {
		y[i] = (path[i] - 0.5 - FINE_MIDDLE) * lid_fine_step(f->look);
		w[i] = 1;
	}
	lid_smooth(f->end, FINE_COLS, y, w, soft);
}

void lid_fine_settle(long n, struct lid_fine_frame *frames)
{
	float(*seen)[LID_BINS] = mem_array(ZONES, sizeof *seen), (*says)[LID_BINS] = mem_array(ZONES, sizeof *says);
	for (long f = 0; f < n; f++)
		memcpy(frames[f].end, frames[f].expect, sizeof frames[f].end);
	for (int round = 0; round < ROUNDS; round++) {
		memset(seen, 0, ZONES * sizeof *seen);
		for (long f = 0; f < n; f++)
			learn(seen, &frames[f]);
		for (int z = 0; z < ZONES; z++)
			lid_colour_log(says[z], seen[z]);
#pragma omp parallel for schedule(static)
		for (long f = 0; f < n; f++)
			find(&frames[f], says);
	}
	free(seen);
	free(says);
}
