/* recut OUT.mp4 IN.mp4 [HOW:]FIRST-LAST[xTIMES]...: a video of another's frames, in any order. HOW: over (upside down), side (a quarter turn), roll (turned
 * further from frame to frame, by 180 degrees in all), uneven (every second frame half an interval late), sway (moved aside by 30 px and back once a
 * second, as by a head that does not rest), bob (up and down by 40 px likewise), aside (half the picture to the right), pair
 * (the picture twice beside itself, half as large), mirror (the same, the right one mirrored), toon (few colours and black outlines), fifth (a fifth of the pixels either way; of all parts or of none),
 * brighter (by one of 255, which nobody sees). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/video/video.h"
#include "tests/lib/variants/worsen.h"

enum { FRAMES = 4000, PARTS = 16 };

struct part {
	char how[16];
	long first, last, times;
};

static bool read_part(struct part *p, const char *text)
{
	*p = (struct part){ .times = 1 };
	const char *colon = strchr(text, ':');
	if (colon && (size_t)(colon - text) < sizeof p->how)
		memcpy(p->how, text, (size_t)(colon - text));
	int got = sscanf(colon ? colon + 1 : text, "%ld-%ldx%ld", &p->first, &p->last, &p->times);
	return got >= 2 && p->first >= 0 && p->last >= p->first && p->last < FRAMES && p->times > 0;
}

/* Frames that a part wants, as sRGB; the others null. */
static bool load(uint8_t **rgb, struct video_info *info, const char *path, int n, const struct part part[], struct err *err)
{
	struct video *video = video_open(info, path, &(struct video_conf){ 40, FRAMES, 2, 0 }, err);
	bool got = video;
	while (got) {
		struct video_frame f;
		bool wanted = false;
		got = video_next(&f, &got, video, err) && got;
		for (int i = 0; i < n && got; i++)
			wanted |= f.index >= part[i].first && f.index <= part[i].last;
		if (wanted) {
			rgb[f.index] = mem_array((size_t)f.width * (size_t)f.height, 3);
			video_frame_rgb(rgb[f.index], 3 * f.width, &f, 0, 0, f.width, f.height);
		}
		video_frame_free(&f);
	}
	video_close(video);
	return !err_is(err);
}

static void turn(uint8_t *out, const uint8_t *in, int w, int h, double angle)
{
	double c = cos(angle), s = sin(angle);
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			double dx = x + 0.5 - 0.5 * w, dy = y + 0.5 - 0.5 * h;
			int u = (int)floor(c * dx + s * dy + 0.5 * w), v = (int)floor(-s * dx + c * dy + 0.5 * h);
			bool in_it = u >= 0 && v >= 0 && u < w && v < h;
			for (int k = 0; k < 3; k++)
				out[3 * ((long)y * w + x) + k] = in_it ? in[3 * ((long)v * w + u) + k] : 0;
		}
}

/* Moved by (x, y) px; the border repeats. */
static void shift(uint8_t *out, const uint8_t *in, int w, int h, int x, int y)
{
	for (int v = 0; v < h; v++)
		for (int u = 0; u < w; u++) {
			int a = u - x, b = v - y;
			a = a < 0 ? 0 : a >= w ? w - 1 : a;
			b = b < 0 ? 0 : b >= h ? h - 1 : b;
			memcpy(out + 3 * ((long)v * w + u), in + 3 * ((long)b * w + a), 3);
		}
}

/* Half as large, twice, beside itself; above and below black. */
static void twice(uint8_t *out, const uint8_t *in, int w, int h, bool mirrored)
{
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++)
			for (int k = 0; k < 3; k++) {
				const int u = mirrored && x >= w / 2 ? 2 * (w - 1 - x) : 2 * (x % (w / 2)), v = 2 * (y - h / 4);
				const bool is = v >= 0 && v + 1 < h && u + 1 < w;
				const uint8_t *a = in + 3 * ((long)(is ? v : 0) * w + (is ? u : 0)) + k, *b = a + 3 * (long)w;
				out[3 * ((long)y * w + x) + k] = (uint8_t)(is ? (a[0] + a[3] + b[0] + b[3] + 2) / 4 : 0);
			}
}

/* Four steps of each colour; black where brightness changes by much. */
static void toon(uint8_t *out, const uint8_t *in, int w, int h)
{
	enum { STEP = 64, EDGE = 60 };
	memcpy(out, in, 3 * (size_t)w * (size_t)h);
	for (int y = 1; y + 1 < h; y++)
		for (int x = 1; x + 1 < w; x++) {
			const uint8_t *p = in + 3 * ((long)y * w + x) + 1;
			const bool edge = abs(p[3] - p[-3]) + abs(p[3 * (long)w] - p[-3 * (long)w]) > EDGE;
			for (int k = 0; k < 3; k++)
				out[3 * ((long)y * w + x) + k] = (uint8_t)(edge ? 0 : p[k - 1] / STEP * STEP + STEP / 2);
		}
}

static bool put(struct video_writer *writer, long *n, const struct part *p, uint8_t *const *rgb, const struct video_info *info, struct err *err)
{
	uint8_t *turned = mem_array((size_t)info->width * (size_t)info->height, 3);
	bool over = !strcmp(p->how, "over"), roll = !strcmp(p->how, "roll"), uneven = !strcmp(p->how, "uneven"), sway = !strcmp(p->how, "sway"), aside = !strcmp(p->how, "aside"), ok = true;
	const bool side = !strcmp(p->how, "side"), mirror = !strcmp(p->how, "mirror"), pair = !strcmp(p->how, "pair");
	for (long t = 0; t < p->times && ok; t++)
		for (long f = p->first; f <= p->last && ok; f++) {
			double share = (double)(f - p->first) / fmax(1, (double)(p->last - p->first));
			const uint8_t *px = rgb[f];
			if (!px) {
				ok = err_set(err, "no frame %ld", f);
				break;
			}
			if (over || roll || side) {
				turn(turned, px, info->width, info->height, M_PI * (roll ? share : side ? 0.5 : 1));
				px = turned;
			}
			if (mirror || pair || !strcmp(p->how, "toon")) {
				if (mirror || pair)
					twice(turned, px, info->width, info->height, mirror);
				else
					toon(turned, px, info->width, info->height);
				px = turned;
			}
			if (!strcmp(p->how, "fifth")) {
				memcpy(turned, px, 3 * (size_t)info->width * (size_t)info->height);
				worsen_reduce(turned, info->width, info->height, 5);
				px = turned;
			}
			if (!strcmp(p->how, "brighter")) {
				for (long i = 0; i < 3L * info->width * info->height; i++)
					turned[i] = (uint8_t)(px[i] + (px[i] < 255));
				px = turned;
			}
			if (!strcmp(p->how, "bob")) {
				shift(turned, px, info->width, info->height, 0, (int)lround(40 * sin(2 * M_PI * (double)*n / info->fps)));
				px = turned;
			}
			if (sway || aside) {
				double t_s = (double)*n / info->fps;
				shift(turned, px, info->width, info->height, aside ? info->width / 2 : (int)lround(30 * sin(2 * M_PI * t_s)), aside ? 0 : (int)lround(10 * sin(M_PI * t_s)));
				px = turned;
			}
			ok = video_writer_put(writer, px, ((double)*n + (uneven && *n % 2 ? 0.5 : 0)) / info->fps, err);
			++*n;
		}
	free(turned);
	return ok;
}

int main(int argc, char **argv)
{
	struct part part[PARTS];
	struct err err = { 0 };
	struct video_info info;
	static uint8_t *rgb[FRAMES];
	long frames = 0, wanted = 0;
	int n = argc - 3;
	bool ok = n > 0 && n <= PARTS;
	for (int i = 0; i < n && ok; i++)
		ok = read_part(&part[i], argv[3 + i]);
	if (!ok)
		return 2;
	for (int i = 0; i < n; i++)
		wanted += (part[i].last - part[i].first + 1) * part[i].times;
	struct video_writer *writer = 0;
	const int times = !strcmp(part[0].how, "fifth") ? 5 : 1;
	const char *preset = wanted > 100 ? "ultrafast" : "veryfast";  // of a long film half the time is its writing
	if (load(rgb, &info, argv[2], n, part, &err))
		writer = video_writer_open(argv[1], &(struct video_writer_conf){ .width = info.width / times, .height = info.height / times, .fps = info.fps, .crf = 16, .preset = preset }, &err);
	for (int i = 0; i < n && writer && !err_is(&err); i++)
		put(writer, &frames, &part[i], rgb, &info, &err);
	video_writer_close(writer, !err_is(&err), &err);
	for (int i = 0; i < FRAMES; i++)
		free(rgb[i]);
	if (err_is(&err))
		fprintf(stderr, "%s\n", err.msg);
	return err_is(&err);
}
