/* Two corrections of U~ at the lids, for errors of optical flow and of the few components: skin at the margins follows the margins' own
 * splines, and eyes close completely. The evaluation of the rig does not change. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rising.h"
#include "rig/make/make_impl.h"

static const double lid_gap = 5;  // mm from the globe: skin further away is no lid

/* Points along a lid's margin at rest, px, and the difference of the margin's motion from that of the skin there. */
struct margin {
	int n;
	double (*at)[2], (*lack)[RIG_BASIS];
};

/* Mean motion of the skin near a point of the margin, weighted by distance. False: there is none. */
static bool moves_there(double basis[RIG_BASIS], const struct rig *rig, const double at[2], double px_per_mm)
{
	double total = 0;
	memset(basis, 0, RIG_BASIS * sizeof *basis);
	for (int i = 0; i < rig->n; i++) {
		double d = hypot(rig->home[i][0] - at[0], rig->home[i][1] - at[1]) / px_per_mm;
		if (d > 4 || rig->part[i] != RIG_SKIN || rig->gap[i] > lid_gap || rig->gap[i] < -2)
			continue;
		double w = exp(-0.5 * d * d / (0.8 * 0.8));
		total += w;
		for (int k = 0; k < RIG_BASIS; k++)
			basis[k] += w * rig->basis[i][k];
	}
	for (int k = 0; k < RIG_BASIS && total > 1e-3; k++)
		basis[k] /= total;
	return total > 1e-3;
}

static struct margin margin_of(const struct rig *rig, const struct rig_motion *m, int lid, double px_per_mm)
{
	struct margin g = { .at = mem_new((size_t)m->n_points + 1, sizeof *g.at), .lack = mem_new((size_t)m->n_points + 1, sizeof *g.lack) };
	for (int i = 0; i < m->n_points; i++) {
		const double *at = m->lid[lid * m->n_points + i];
		double basis[RIG_BASIS];
		if (!isfinite(at[0] + at[1]) || !moves_there(basis, rig, at, px_per_mm))
			continue;
		memcpy(g.at[g.n], at, sizeof *g.at);
		for (int k = 0; k < RIG_BASIS; k++)
			g.lack[g.n][k] = m->lid_basis[lid * m->n_points + i][k] - basis[k];
		g.n++;
	}
	return g;
}

/* Distance of a point from the margin, px; lack: out, interpolated at the closest place. */
static double nearest(double lack[RIG_BASIS], const struct margin *g, const float px[2])
{
	double least = INFINITY;
	for (int i = 0; i + 1 < g->n; i++) {
		const double *a = g->at[i], *b = g->at[i + 1];
		double x = b[0] - a[0], y = b[1] - a[1], t = ((px[0] - a[0]) * x + (px[1] - a[1]) * y) / (x * x + y * y + 1e-12);
		t = fmin(fmax(t, 0), 1);
		double d = hypot(px[0] - a[0] - t * x, px[1] - a[1] - t * y);
		if (d >= least)
			continue;
		least = d;
		for (int k = 0; k < RIG_BASIS; k++)
			lack[k] = (1 - t) * g->lack[i][k] + t * g->lack[i + 1][k];
	}
	return least;
}

/* Smooths the motion of extrapolated lid skin over the mesh, so that a margin's inner edge does not move farther than its outer one. */
static void even_out(struct rig *rig)
{
	enum { ROUNDS = 6 };
	float (*sum)[RIG_BASIS] = mem_new((size_t)rig->n + 1, sizeof *sum), *n = mem_new((size_t)rig->n + 1, sizeof *n);
	for (int round = 0; round < ROUNDS; round++) {
		memset(sum, 0, (size_t)rig->n * sizeof *sum);
		memset(n, 0, (size_t)rig->n * sizeof *n);
		for (int f = 0; f < 3 * rig->n_faces; f++) {
			int a = rig->faces[f / 3][f % 3], b = rig->faces[f / 3][(f + 1) % 3];
			for (int k = 0; k < RIG_BASIS; k++) {
				sum[a][k] += rig->basis[b][k];
				sum[b][k] += rig->basis[a][k];
			}
			n[a]++;
			n[b]++;
		}
		for (int i = 0; i < rig->n; i++)
			for (int k = 0; k < RIG_BASIS && n[i] > 0; k++)
				if (rig->source[i] == RIG_EXTRAPOLATED && !rig_is_globe(rig->part[i]) && rig->gap[i] < lid_gap)
					rig->basis[i][k] += 0.6f * (sum[i][k] / n[i] - rig->basis[i][k]);
	}
	free(sum);
	free(n);
}

void rig_follow_lids(struct rig *rig, const struct rig_motion *m, double px_per_mm, double reach_mm, struct rig_report *report)
{
	struct margin margin[SKIN_LIDS];
	if (!(reach_mm > 0))
		return;
	even_out(rig);
	for (int lid = 0; lid < SKIN_LIDS; lid++)
		margin[lid] = margin_of(rig, m, lid, px_per_mm);
	for (int i = 0; i < rig->n; i++) {
		double sum[RIG_BASIS] = { 0 }, total = 0, most = 0;
		if (rig_is_globe(rig->part[i]) || rig->gap[i] > lid_gap + 2)
			continue;
		for (int lid = 0; lid < SKIN_LIDS; lid++) {
			double lack[RIG_BASIS] = { 0 }, d = nearest(lack, &margin[lid], rig->home[i]) / px_per_mm;
			double reach = 1 - rising(d, 0.25 * reach_mm, reach_mm), w = reach / (0.05 + d * d);
			most = fmax(most, reach);
			total += w;
			for (int k = 0; k < RIG_BASIS; k++)
				sum[k] += w * lack[k];
		}
		most *= 1 - rising(rig->gap[i], lid_gap - 2, lid_gap + 2);
		report->lid += most > 0.5;
		for (int k = 0; k < RIG_BASIS && total > 0; k++)
			rig->basis[i][k] += (float)(most * sum[k] / total);
	}
	for (int lid = 0; lid < SKIN_LIDS; lid++) {
		free(margin[lid].at);
		free(margin[lid].lack);
	}
}

/* How far each column must still close, px, smoothed along the fissure so that the margin stays a curve. Returns the largest gap, px. */
static double open_columns(float *open, const struct rig_fissure *f, double seal_mm, double px_per_mm)
{
	int reach = (int)fmax(2 * px_per_mm, 1);
	double worst = 0;
	float *most = mem_new((size_t)f->width + 1, sizeof *most);
	for (int x = 0; x < f->width; x++) {
		worst = fmax(worst, f->bottom[x] - f->top[x]);
		for (int k = x - reach < 0 ? 0 : x - reach; k <= x + reach && k < f->width; k++)
			most[k] = fmaxf(most[k], f->bottom[x] - f->top[x]);
	}
	for (int x = 0; x < f->width; x++) {
		double sum = 0, total = 0;
		for (int k = x - 2 * reach; k <= x + 2 * reach; k++) {
			double w = exp(-0.5 * (k - x) * (k - x) / ((double)reach * reach)), here = k < 0 || k >= f->width ? 0 : most[k];
			sum += w * (here > 0 ? here + seal_mm * px_per_mm : 0);
			total += w;
		}
		open[x] = (float)(sum / total);
	}
	free(most);
	return worst;
}

/* Lowers the upper lid by `open`, fully at its margin and less further up. */
static void close_once(struct rig *rig, const struct rig_fissure *f, const float *open, int side, const double closing[RIG_COMPONENTS],
                       double px_per_mm)
{
	for (int i = 0; i < rig->n; i++) {
		double column = f->at[i][0] - f->x0, beyond = fmax(-column, column - f->width) / px_per_mm;
		int x = (int)fmin(fmax(lrint(column), 0), f->width - 1);
		if (rig_is_globe(rig->part[i]) || rig->side[i] != side || rig->gap[i] > lid_gap + 3 || !(open[x] > 0) || !(beyond < 3))
			continue;
		double middle = 0.5 * (f->top[x] + f->bottom[x]), above = (f->top[x] - f->at[i][1]) / px_per_mm;
		double w = (1 - rising(above, 1, 9)) * (1 - rising(beyond, 0, 3)) * (1 - rising(rig->gap[i], lid_gap, lid_gap + 3)) * (f->at[i][1] < middle + 0.2 * px_per_mm);
		for (int k = 0; k < RIG_COMPONENTS; k++)
			rig->basis[i][RIG_COMPONENTS + k] += (float)(w * open[x] * closing[k]);
	}
}

void rig_seal_lids(struct rig *rig, const struct rig_motion *m, double px_per_mm, double seal_mm, struct rig_report *report)
{
	enum { ROUNDS = 12 };
	double de[RIG_COMPONENTS], closing[RIG_COMPONENTS];
	rig_closed_pose(de, rig);
	for (int side = 0; side < 2; side++) {
		struct rig_fissure f;
		if (!rig_fissure_new(&f, rig, m, side, (double[]){ -px_per_mm, 2 * px_per_mm }))
			continue;
		float *open = mem_new((size_t)f.width + 1, sizeof *open);
		double left = 0;
		rig_closing_direction(closing, rig, side, de);
		for (int round = 0; round <= ROUNDS; round++) {
			rig_fissure_look(&f, rig, side, de);
			left = open_columns(open, &f, seal_mm, px_per_mm);
			report->open_before[side] = round ? report->open_before[side] : left / px_per_mm;
			if (left == 0 || round == ROUNDS)
				break;
			close_once(rig, &f, open, side, closing, px_per_mm);
		}
		report->open_after[side] = left / px_per_mm;
		free(open);
		rig_fissure_free(&f);
	}
}
