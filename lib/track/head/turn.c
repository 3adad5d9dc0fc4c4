#include "track/head/turn.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/call.h"
#include "base/mem.h"
#include "net/net.h"

/* What the network has learnt to see (tests/evidence/turn.py): SIZE px square, the eyes' middle there and so far apart; each channel by its mean and spread in the middle. */
enum { SIZE = 96, FROM = 16, TO = 80, FINEST = 8 };
/* Radians, beside what the network says: people are not those that it has learnt from. On ten films of people it differed from another network that has learnt from people, in all
 * frames of a film alike, by 1.5 degrees aside and 4 in the nod (rms), of which half is taken for its own. */
static const double STRANGER[TURNS] = { 0.02, 0.05 };
static const double MIDDLE[2] = { 48, 58.0 * 96 / 144 }, APART = 40.0 * 96 / 144, FLAT = 0.02;

struct turn_net {
	struct net *net;
};

/* What the network says of a face [3][SIZE][SIZE] and of its mirror image, as of the face. */
static bool run(double out[2][2 * TURNS], const float *in, struct net *net, struct err *err)
{
	float *mirrored = mem_array((size_t)3 * SIZE * SIZE, sizeof *mirrored);
	for (int i = 0; i < 3 * SIZE * SIZE; i++)
		mirrored[i] = in[i / SIZE * SIZE + SIZE - 1 - i % SIZE];
	struct net_picture p[2] = { { .in = in, .height = SIZE, .width = SIZE }, { .in = mirrored, .height = SIZE, .width = SIZE } };
	const bool ok = net_run(p, 2, net, 3, err);
	for (int m = 0; m < 2 && ok; m++)
		for (int k = 0; k < 2 * TURNS; k++)
			out[m][k] = (m && k == TURN_ASIDE ? -1 : 1) * (double)p[m].out[k];
	free(p[0].out);
	free(p[1].out);
	free(mirrored);
	return ok;
}

bool turn_open(struct turn_net **out, const char *path, struct err *err)
{
	struct net *net;
	*out = 0;
	if (!net_open(&net, path, (const int[3]){ 3, SIZE, SIZE }, (const int[3]){ 2 * TURNS, 1, 1 }, err))
		return false;
	*out = mem_new(1, sizeof **out);
	(*out)->net = net;
	return true;
}

bool turn_open_shipped(struct turn_net **net, struct err *err)
{
	char *path = call_config_file("turn.onnx");
	const bool ok = turn_open(net, path, err);
	free(path);
	return ok;
}

void turn_close(struct turn_net *net)
{
	if (net)
		net_close(net->net);
	free(net);
}

/* Picture from what is seen: px = middle + step * (to - MIDDLE), step along the line from the right eye to the left. */
static bool frame_of(double middle[2], double step[2], const double eye[2][2])
{
	for (int k = 0; k < 2; k++) {
		middle[k] = 0.5 * (eye[0][k] + eye[1][k]);
		step[k] = (eye[0][k] - eye[1][k]) / APART;
	}
	return hypot(step[0], step[1]) > 1e-3;
}

bool turn_reach(int box[4], const double eye[2][2], int width, int height)
{
	double middle[2], step[2], low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	if (!frame_of(middle, step, eye))
		return false;
	for (int c = 0; c < 4; c++) {
		const double x = (c % 2 ? SIZE : 0) - MIDDLE[0], y = (c / 2 ? SIZE : 0) - MIDDLE[1];
		const double px[2] = { middle[0] + step[0] * x - step[1] * y, middle[1] + step[1] * x + step[0] * y };
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], px[k]);
			high[k] = fmax(high[k], px[k]);
		}
	}
	for (int k = 0; k < 2; k++) {
		const double size = k ? height : width;
		box[k] = (int)fmin(fmax(floor(low[k]) - 1, 0), size);
		box[2 + k] = (int)fmin(fmax(ceil(high[k]) + 1, 0), size);
	}
	return box[2] > box[0] && box[3] > box[1];
}

static long within(long x, int size)
{
	return x < 0 ? 0 : x < size ? x : size - 1;
}

/* Each pixel the mean of so many samples a side that none of the picture's is stepped over; beyond its border that goes on. Places count 2^-20 px. */
static void cut(float *in, const uint8_t *rgb, int width, int height, const double middle[2], const double step[2])
{
	enum { POINT = 20 };
	const int fine = (int)fmin(fmax(ceil(hypot(step[0], step[1])), 2), FINEST);
	const double one = 1L << POINT;
	const long across = lround(one * step[0] / fine), down = lround(one * step[1] / fine);
#pragma omp parallel for
	for (int row = 0; row < SIZE; row++) {
		int sum[SIZE][3] = { 0 };
		for (int i = 0; i < fine; i++) {
			const double x = 0.5 / fine - MIDDLE[0], y = row + (i + 0.5) / fine - MIDDLE[1];
			long u = lround(one * (middle[0] + step[0] * x - step[1] * y)), v = lround(one * (middle[1] + step[1] * x + step[0] * y));
			for (int col = 0; col < SIZE; col++)
				for (int j = 0; j < fine; j++, u += across, v += down) {
					const uint8_t *px = rgb + 3 * (within(v >> POINT, height) * width + within(u >> POINT, width));
					for (int c = 0; c < 3; c++)
						sum[col][c] += px[c];
				}
		}
		for (int col = 0; col < SIZE; col++)
			for (int c = 0; c < 3; c++)
				in[(c * SIZE + row) * SIZE + col] = (float)sum[col][c] / (float)(255 * fine * fine);
	}
}

static void level(float *plane)
{
	const int n = (TO - FROM) * (TO - FROM);
	double sum = 0, square = 0;
	for (int row = FROM; row < TO; row++)
		for (int col = FROM; col < TO; col++)
			sum += (double)plane[row * SIZE + col];
	for (int row = FROM; row < TO; row++)
		for (int col = FROM; col < TO; col++)
			square += pow((double)plane[row * SIZE + col] - sum / n, 2);
	const float mean = (float)(sum / n), by = (float)(1 / (sqrt(square / (n - 1)) + FLAT));
	for (int i = 0; i < SIZE * SIZE; i++)
		plane[i] = (plane[i] - mean) * by;
}

bool turn_see(struct head_turn *turn, struct turn_net *net, const uint8_t *rgb, int width, int height, const double eye[2][2], struct err *err)
{
	double middle[2], step[2], told[2][2 * TURNS];
	float *in = mem_array((size_t)3 * SIZE * SIZE, sizeof *in);
	bool ok = frame_of(middle, step, eye) || err_set(err, "eyes %g px apart", hypot(eye[0][0] - eye[1][0], eye[0][1] - eye[1][1]));
	if (ok) {
		cut(in, rgb, width, height, middle, step);
		for (int c = 0; c < 3; c++)
			level(in + c * SIZE * SIZE);
		ok = run(told, in, net->net, err);
	}
	turn->unlike = 0;
	for (int k = 0; k < TURNS && ok; k++) {
		const double own = exp(0.5 * (told[0][TURNS + k] + told[1][TURNS + k]));
		turn->angle[k] = 0.5 * (told[0][k] + told[1][k]);
		turn->sigma[k] = hypot(STRANGER[k], own);
		turn->unlike = hypot(turn->unlike, sqrt(0.5) * own);
	}
	free(in);
	return ok;
}

/* Axes of a camera that looks along ray, its x level with the camera's own. */
static void looking(double axis[3][3], const double ray[3])
{
	const double flat = hypot(ray[0], ray[2]), all = hypot(flat, ray[1]);
	const double x[3] = { ray[2] / flat, 0, -ray[0] / flat }, z[3] = { ray[0] / all, ray[1] / all, ray[2] / all };
	for (int k = 0; k < 3; k++) {
		axis[0][k] = x[k];
		axis[1][k] = z[(k + 1) % 3] * x[(k + 2) % 3] - z[(k + 2) % 3] * x[(k + 1) % 3];
		axis[2][k] = z[k];
	}
}

void turn_rotation(double m[3][3], const double angle[TURNS], double lean, const double ray[3])
{
	const double ca = cos(angle[TURN_ASIDE]), sa = sin(angle[TURN_ASIDE]), cn = cos(angle[TURN_NOD]), sn = sin(angle[TURN_NOD]), c = cos(lean), s = sin(lean);
	const double faced[3][3] = { { ca, sa * sn, sa * cn }, { 0, cn, -sn }, { -sa, ca * sn, ca * cn } };  // Ry Rx
	double axis[3][3];
	looking(axis, ray);
	for (int k = 0; k < 3; k++) {
		const double x = c * faced[0][k] + s * faced[1][k], y = s * faced[0][k] - c * faced[1][k], z = -faced[2][k];
		for (int i = 0; i < 3; i++)
			m[i][k] = axis[0][i] * x + axis[1][i] * y + axis[2][i] * z;
	}
}

void turn_of(double angle[TURNS], double *lean, const double cam_from_head[4][4], const double ray[3])
{
	double axis[3][3], m[3][3];
	looking(axis, ray);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			m[i][k] = axis[i][0] * cam_from_head[0][k] + axis[i][1] * cam_from_head[1][k] + axis[i][2] * cam_from_head[2][k];
	angle[TURN_ASIDE] = asin(fmin(fmax(m[2][0], -1), 1));
	angle[TURN_NOD] = atan2(-m[2][1], -m[2][2]);
	*lean = atan2(m[1][0], m[0][0]);
}
