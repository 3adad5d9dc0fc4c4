#include "limbus/strip_net.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/call.h"
#include "base/mem.h"
#include "net/net.h"

enum { WRAP = 16, WIDE = STRIP_RAYS + 2 * WRAP };
static const float LEAST_CONTRAST = 0.02F;

struct strip_net {
	struct net *net;
};

bool strip_open(struct strip_net **out, const char *path, struct err *err)
{
	struct net *net;
	*out = 0;
	if (!net_open(&net, path, (const int[3]){ STRIP_PLANES, STRIP_ROWS, WIDE }, (const int[3]){ 1, STRIP_ROWS + 1, WIDE }, err))
		return false;
	*out = mem_new(1, sizeof **out);
	(*out)->net = net;
	return true;
}

bool strip_open_shipped(struct strip_net **net, struct err *err)
{
	char *path = call_config_file("strip.onnx");
	const bool ok = strip_open(net, path, err);
	free(path);
	return ok;
}

void strip_close(struct strip_net *net)
{
	if (net)
		net_close(net->net);
	free(net);
}

/* The photograph without its mean colour and its contrast, so that neither light nor exposure counts; chances about 0. */
static void even(float strip[STRIP_PLANES][STRIP_ROWS][STRIP_RAYS])
{
	double mean[3] = { 0 }, square = 0;
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < STRIP_ROWS; i++)
			for (int j = 0; j < STRIP_RAYS; j++)
				mean[c] += strip[c][i][j] / STRIP_PIXELS;
	for (int i = 0; i < STRIP_ROWS; i++)
		for (int j = 0; j < STRIP_RAYS; j++) {
			double grey = 0;
			for (int c = 0; c < 3; c++)
				grey += (strip[c][i][j] - mean[c]) / 3;
			square += grey * grey / (STRIP_PIXELS - 1);
		}
	const float gain = 1 / ((float)sqrt(square) + LEAST_CONTRAST);
	for (int c = 0; c < STRIP_PLANES; c++)
		for (int i = 0; i < STRIP_ROWS; i++)
			for (int j = 0; j < STRIP_RAYS; j++)
				strip[c][i][j] = c < 3 ? gain * (strip[c][i][j] - (float)mean[c]) : 2 * strip[c][i][j] - 0.5F;
}

/* The ray that a ray of the mirrored strip is, or itself. */
static int ray_of(int j, bool mirrored)
{
	j = (j + STRIP_RAYS) % STRIP_RAYS;
	return mirrored ? (STRIP_RAYS / 2 - j + STRIP_RAYS) % STRIP_RAYS : j;
}

static float *input_of(float strip[STRIP_PLANES][STRIP_ROWS][STRIP_RAYS], bool mirrored)
{
	float *in = mem_array((size_t)STRIP_PLANES * STRIP_ROWS * WIDE, sizeof *in);
	for (int row = 0; row < STRIP_PLANES * STRIP_ROWS; row++)
		for (int x = 0; x < WIDE; x++)
			in[row * WIDE + x] = strip[row / STRIP_ROWS][row % STRIP_ROWS][ray_of(x - WRAP, mirrored)];
	return in;
}

/* Adds a share of a run's chances, from their logits. */
static void add(struct strip *strip, const float *logit, bool mirrored, float share)
{
	for (int x = 0; x < STRIP_RAYS; x++) {
		const float *at = logit + WRAP + x;
		const int ray = ray_of(x, mirrored);
		float most = at[0], sum = 0;
		for (int i = 1; i < STRIP_ROWS; i++)
			most = fmaxf(most, at[i * WIDE]);
		for (int i = 0; i < STRIP_ROWS; i++)
			sum += expf(at[i * WIDE] - most);
		for (int i = 0; i < STRIP_ROWS; i++)
			strip->row[i][ray] += share * expf(at[i * WIDE] - most) / sum;
		strip->seen[ray] += share / (1 + expf(-at[STRIP_ROWS * WIDE]));
	}
}

bool strip_read(struct strip *out, struct strip_net *net, const struct photo *photo, const struct evidence *evidence, const struct ellipse *e,
                enum strip_way way, const struct strip_conf *conf, struct err *err)
{
	enum { FIRST = 3, LAST = 6 };  // planes of the evidence
	const int n = way == STRIP_ONCE ? 1 : 2;
	float (*strip)[STRIP_ROWS][STRIP_RAYS] = mem_array(STRIP_PLANES, sizeof *strip);
	struct net_picture run[2] = { 0 };
	*out = (struct strip){ .e = *e, .conf = *conf };
	strip_sample(strip, photo, evidence, e);
	if (way == STRIP_BLIND)
		memset(strip[FIRST], 0, (LAST - FIRST + 1) * sizeof *strip);
	even(strip);
	for (int i = 0; i < n; i++)
		run[i] = (struct net_picture){ .in = input_of(strip, i), .height = STRIP_ROWS, .width = WIDE };
	const bool ok = net_run(run, n, net->net, STRIP_PLANES, err);
	for (int i = 0; i < n; i++) {
		if (ok)
			add(out, run[i].out, i, 1.0F / n);
		free(run[i].out);
		free((float *)run[i].in);
	}
	free(strip);
	return ok;
}
