/* odd_face KIND OUT.mp4: two seconds at 30 frames/s of what is no face from in front: a cat (slit pupils, no white of the eye) and a cartoon (outlines, dots for
 * irises), both looking about and blinking, and a drawn head seen from the side that nods a little. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/video/video.h"
#include "tests/lib/scenes/drawn_head.h"

enum { W = 640, H = 360, FRAMES = 60, FPS = 30 };

struct shape {
	double x, y, a, b;         // px: middle, semi-axes
};

static double soft(double signed_px)
{
	return fmax(0, fmin(1, 0.5 - signed_px));
}

/* Share of the pixel that an ellipse covers, about. */
static double covers(const struct shape *s, double x, double y)
{
	const double u = (x - s->x) / s->a, v = (y - s->y) / s->b, r = hypot(u, v);
	return soft((r - 1) * fmin(s->a, s->b));
}

static void mix(double c[3], const double paint[3], double share)
{
	for (int k = 0; k < 3; k++)
		c[k] += share * (paint[k] - c[k]);
}

static double grain(int x, int y)
{
	unsigned h = (unsigned)x * 0x8da6b343u ^ (unsigned)y * 0xd8163841u;
	h = (h ^ h >> 15) * 0x2c1b3c6du;
	return (double)((h ^ h >> 12) & 255) / 255 - 0.5;
}

/* Share open, 0 shut: a blink in the middle of the second second. */
static double lid(double t)
{
	return 1 - exp(-pow((t - 1.5) / 0.06, 2));
}

static void cat(double c[3], int x, int y, double t)
{
	static const double eye[3] = { 190, 170, 50 }, black[3] = { 20, 16, 14 }, nose[3] = { 150, 80, 80 };
	const double streak = sin(0.35 * x + 4 * sin(0.05 * y)), turn = 8 * sin(2 * M_PI * t / 1.3);
	const double fur[3] = { 120 + 25 * streak + 30 * grain(x, y), 90 + 22 * streak + 30 * grain(x, y), 60 + 18 * streak + 30 * grain(x, y) };
	memcpy(c, fur, 3 * sizeof *c);
	for (int side = -1; side <= 1; side += 2) {
		const struct shape white = { W / 2 + side * 105, 160, 52, 46 * lid(t) + 1 }, rim = { white.x, white.y, 57, 50 * lid(t) + 2 };
		const struct shape slit = { white.x + turn, white.y, 9, 38 };
		const double in = covers(&white, x + 0.5, y + 0.5);
		mix(c, black, covers(&rim, x + 0.5, y + 0.5) * (1 - in));
		mix(c, eye, in);
		mix(c, black, fmin(in, covers(&slit, x + 0.5, y + 0.5)));
	}
	const struct shape tip = { W / 2, 275, 26, 16 };
	mix(c, nose, covers(&tip, x + 0.5, y + 0.5));
}

static void cartoon(double c[3], int x, int y, double t)
{
	static const double paper[3] = { 255, 255, 255 }, skin[3] = { 255, 214, 150 }, line[3] = { 0, 0, 0 }, mouth[3] = { 200, 40, 40 };
	const double turn = 14 * sin(2 * M_PI * t / 1.3), up = 6 * sin(2 * M_PI * t / 0.9);
	const struct shape head = { W / 2, H / 2, 260, 240 }, lips = { W / 2, 310, 60, 12 };
	memcpy(c, paper, 3 * sizeof *c);
	mix(c, skin, covers(&head, x + 0.5, y + 0.5));
	for (int side = -1; side <= 1; side += 2) {
		const struct shape white = { W / 2 + side * 90, 150, 60, 60 * lid(t) + 1 }, rim = { white.x, white.y, 65, 65 * lid(t) + 4 };
		const struct shape dot = { white.x + turn, white.y + up, 20, 20 };
		const double in = covers(&white, x + 0.5, y + 0.5);
		mix(c, line, covers(&rim, x + 0.5, y + 0.5) * (1 - in));
		mix(c, paper, in);
		mix(c, line, fmin(in, covers(&dot, x + 0.5, y + 0.5)));
	}
	mix(c, mouth, covers(&lips, x + 0.5, y + 0.5));
}

static void paint(uint8_t *rgb, void (*by)(double c[3], int x, int y, double t), double t)
{
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double c[3];
			by(c, x, y, t);
			for (int k = 0; k < 3; k++)
				rgb[3 * ((long)y * W + x) + k] = (uint8_t)lround(fmax(0, fmin(255, c[k])));
		}
}

static bool film(struct video_writer *to, const char *kind, struct err *err)
{
	struct drawn_head head = { 0 };
	uint8_t *rgb = mem_array(3 * (size_t)W * H, 1);
	const bool profile = !strcmp(kind, "profile");
	bool ok = !profile || drawn_head_load(&head, err);
	for (int f = 0; f < FRAMES && ok; f++) {
		const double t = (double)f / FPS;
		double R[3][3], shift[3];
		if (profile) {
			drawn_head_camera(R, shift, 0.5 * M_PI + 0.02 * sin(2 * M_PI * t), 0.05 * sin(2 * M_PI * t / 1.7), 600);
			drawn_head_draw(rgb, &head, (const double(*)[3])R, shift, 1500, W, H);
		} else {
			paint(rgb, !strcmp(kind, "cat") ? cat : cartoon, t);
		}
		ok = video_writer_put(to, rgb, t, err);
	}
	if (profile)
		drawn_head_free(&head);
	free(rgb);
	return ok;
}

int main(int argc, char **argv)
{
	if (argc != 3 || (strcmp(argv[1], "cat") && strcmp(argv[1], "cartoon") && strcmp(argv[1], "profile"))) {
		fprintf(stderr, "usage: odd_face cat|cartoon|profile OUT.mp4\n");
		return 2;
	}
	struct err err = { 0 };
	struct video_writer *to = video_writer_open(argv[2], &(struct video_writer_conf){ .width = W, .height = H, .fps = FPS, .crf = 16 }, &err);
	const bool ok = to && film(to, argv[1], &err);
	if (!video_writer_close(to, ok, &err) || !ok)
		fprintf(stderr, "%s\n", err.msg);
	return !ok;
}
