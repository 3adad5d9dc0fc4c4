#include "tests/lib/variants/worsen.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/video/video.h"
#include "math/rng.h"

enum { REACH = 5 };
static const double noise = 8, blur_px = 2;

static uint8_t byte(double v)
{
	return (uint8_t)fmax(0, fmin(255, v + 0.5));
}

/* Twelve even ones make a nearly normal one (Irwin and Hall). */
static void add_noise(uint8_t *rgb, long n, struct rng *rng)
{
	for (long i = 0; i < n; i++) {
		double sum = -6;
		for (int k = 0; k < 12; k++)
			sum += rng_uniform(rng);
		rgb[i] = byte(rgb[i] + noise * sum);
	}
}

/* One direction: `step` bytes from sample to sample of a row of n. */
static void blur_row(uint8_t *row, int n, long step, uint8_t *room)
{
	for (int i = 0; i < n; i++)
		room[i] = row[i * step];
	for (int i = 0; i < n; i++) {
		double sum = 0, weight = 0;
		for (int k = -REACH; k <= REACH; k++) {
			int j = i + k < 0 ? 0 : i + k >= n ? n - 1 : i + k;
			double w = exp(-0.5 * k * k / (blur_px * blur_px));
			sum += w * room[j];
			weight += w;
		}
		row[i * step] = byte(sum / weight);
	}
}

static void blur(uint8_t *rgb, int w, int h)
{
	uint8_t *room = mem_array((size_t)(w > h ? w : h), 1);
	for (int c = 0; c < 3; c++) {
		for (int y = 0; y < h; y++)
			blur_row(rgb + 3L * y * w + c, w, 3, room);
		for (int x = 0; x < w; x++)
			blur_row(rgb + 3L * x + c, h, 3L * w, room);
	}
	free(room);
}

void worsen_reduce(uint8_t *rgb, int w, int h, int times)
{
	for (int y = 0; y < h / times; y++)
		for (int x = 0; x < w / times; x++)
			for (int c = 0; c < 3; c++) {
				int sum = times * times / 2;
				for (int v = 0; v < times; v++)
					for (int u = 0; u < times; u++)
						sum += rgb[3 * ((long)(times * y + v) * w + times * x + u) + c];
				rgb[3 * ((long)y * (w / times) + x) + c] = (uint8_t)(sum / (times * times));
			}
}

bool worsen_video(const char *out, const char *in, const char *how, struct err *err)
{
	struct video_info info;
	struct video *video = video_open(&info, in, &(struct video_conf){ 40, 100000, 2, 0 }, err);
	if (!video)
		return false;
	int w = info.width, h = info.height, times = !strcmp(how, "half") ? 2 : !strcmp(how, "fifth") ? 5 : 1;
	struct video_writer *writer = video_writer_open(out, &(struct video_writer_conf){ .width = w / times / 2 * 2, .height = h / times / 2 * 2, .fps = info.fps, .crf = 12, .preset = "veryfast" }, err);
	uint8_t *rgb = mem_array((size_t)w * (size_t)h, 3);
	struct rng rng = { 11 };
	bool got = writer;
	long first = strtol(how, 0, 10);
	for (long n = -first; got; n++) {
		struct video_frame f;
		if (!video_next(&f, &got, video, err) || !got)
			break;
		if (n < 0) {
			video_frame_free(&f);
			continue;
		}
		video_frame_rgb(rgb, 3 * w, &f, 0, 0, w, h);
		video_frame_free(&f);
		if (times > 1)
			worsen_reduce(rgb, w, h, times);
		else if (!strcmp(how, "noise"))
			add_noise(rgb, 3L * w * h, &rng);
		else if (!strcmp(how, "blur"))
			blur(rgb, w, h);
		got = video_writer_put(writer, rgb, (double)n / info.fps, err);
	}
	free(rgb);
	video_close(video);
	return video_writer_close(writer, !err_is(err), err) && !err_is(err);
}
