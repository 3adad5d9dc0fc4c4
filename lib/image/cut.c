#include "image/cut.h"

#include <math.h>

void cut_view_of(struct cut_view *view, const uint8_t *luma, int stride, int width, int height)
{
	for (int cy = 0; cy < CUT_HEIGHT; cy++) {
		int y0 = cy * height / CUT_HEIGHT, y1 = (cy + 1) * height / CUT_HEIGHT;
		int step = (y1 - y0) / 8 > 1 ? (y1 - y0) / 8 : 1;  // eight rows tell enough of a cell
		for (int cx = 0; cx < CUT_WIDTH; cx++) {
			int x0 = cx * width / CUT_WIDTH, x1 = (cx + 1) * width / CUT_WIDTH;
			long sum = 0, n = 0;
			for (int y = y0; y < y1; y += step, n += x1 - x0)
				for (int x = x0; x < x1; x++)
					sum += luma[(long)y * stride + x];
			view->cell[cy * CUT_WIDTH + cx] = n ? (float)sum / (float)n : 0;
		}
	}
}

double cut_difference(const struct cut_view *a, const struct cut_view *b)
{
	enum { N = CUT_WIDTH * CUT_HEIGHT };
	double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
	for (int i = 0; i < N; i++) {
		ma += a->cell[i];
		mb += b->cell[i];
	}
	ma /= N;
	mb /= N;
	for (int i = 0; i < N; i++) {
		double p = a->cell[i] - ma, q = b->cell[i] - mb;
		aa += p * p;
		bb += q * q;
		ab += p * q;
	}
	// a plain grey frame has nothing to correlate: it is another view, unless both are
	double flat = 0.25 * N;
	if (aa < flat || bb < flat)
		return aa < flat && bb < flat ? 0 : 1;
	return 1 - ab / sqrt(aa * bb);
}

bool cut_found(struct cut_finder *finder, const struct cut_view *view, double least)
{
	double d = finder->frames ? cut_difference(&finder->last, view) : 0;
	bool cut = d > least && d > 12 * finder->usual;
	// what a cut itself differs by says nothing about the frames after it
	finder->usual += cut ? 0 : (d - finder->usual) / (double)(finder->frames < 30 ? finder->frames + 1 : 30);
	finder->last = *view;
	finder->frames++;
	return cut;
}
