#include "plan/film.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/video/video.h"

/* The picture is reduced to WIDE px and cut into cells of CELL px. Frames EVERY frames apart are compared with the first. The border: BORDER cells. */
enum { WIDE = 320, CELL = 16, EVERY = 12, LOOKS = 5, LEAST_CELLS = 12, BORDER = 2 };

static const double texture = 6;          // mean gradient, of 255, that noise and coding do not make in the reduced picture
static const double moved = 0.4;          // change of a cell, of its gradient: a shift by half a px of the reduced picture
static const double most_moved = 0.75;    // share of what has texture that moves before a camera that rests
static const double furnished = 1.0 / 3;   // share of a border's cells with texture, from which on a room is seen there: an ear alone has less
static const struct video_conf limits = { .limit_mpx = 40, .limit_frames = 10000000, .threads = 2 };

/* Brightness, reduced by averaging. */
struct small {
	int width, height;
	float *px;
};

static void reduce(struct small *s, const struct video_frame *f)
{
	const int step = f->width > WIDE ? f->width / WIDE : 1;
	s->width = f->width / step;
	s->height = f->height / step;
	s->px = s->px ? s->px : mem_array((size_t)s->width * (size_t)s->height + 1, sizeof *s->px);
	for (int y = 0; y < s->height; y++)
		for (int x = 0; x < s->width; x++) {
			int sum = 0;
			for (int v = 0; v < step; v++)
				for (int u = 0; u < step; u++)
					sum += f->luma[(long)(y * step + v) * f->luma_stride + x * step + u];
			s->px[y * s->width + x] = (float)sum / (float)(step * step);
		}
}

/* Whether that cell has texture; differs: whether it shows something else in b. */
static bool has_texture(bool *differs, const struct small *a, const struct small *b, int cx, int cy)
{
	const double n = (CELL - 1) * (CELL - 1);
	double gradient = 0, change = 0, mean = 0;
	for (int y = cy * CELL; y < cy * CELL + CELL - 1; y++)
		for (int x = cx * CELL; x < cx * CELL + CELL - 1; x++) {
			const int i = y * a->width + x;
			gradient += fabs((double)(a->px[i + 1] - a->px[i])) + fabs((double)(a->px[i + a->width] - a->px[i]));
			mean += (double)(b->px[i] - a->px[i]) / n;
		}
	// the light may change: the mean does not count
	for (int y = cy * CELL; y < cy * CELL + CELL - 1; y++)
		for (int x = cx * CELL; x < cx * CELL + CELL - 1; x++)
			change += fabs((double)(b->px[y * a->width + x] - a->px[y * a->width + x]) - mean);
	*differs = change > moved * gradient;
	return gradient > texture * n;
}

/* Cells with texture and those of them that show something else, in a part of the picture. */
struct count {
	int textured, differ;
};

static bool mostly(const struct count *c, int least)
{
	return c->textured >= least && c->differ > most_moved * c->textured;
}

/* Whether nearly all that has texture moves, at the left and the right border too. Where a border is plain, what moves is a person
 * before a wall: only what lies behind tells a camera that moves from a head that does. */
static bool all_moves(const struct small *a, const struct small *b)
{
	const int wide = a->width / CELL, high = a->height / CELL, least = (int)ceil(furnished * BORDER * high);
	struct count all = { 0 }, side[2] = { 0 };
	for (int cy = 0; cy < high; cy++)
		for (int cx = 0; cx < wide; cx++) {
			bool differs;
			if (!has_texture(&differs, a, b, cx, cy))
				continue;
			all.textured++;
			all.differ += differs;
			if (cx < BORDER || cx >= wide - BORDER) {
				side[cx >= BORDER].textured++;
				side[cx >= BORDER].differ += differs;
			}
		}
	return mostly(&all, LEAST_CELLS) && mostly(&side[0], least) && mostly(&side[1], least);
}

static enum film_camera look(const char *path)
{
	struct video_info info;
	struct err none = { 0 };
	struct small first = { 0 }, now = { 0 };
	struct video *video = video_open(&info, path, &limits, &none);
	bool got = video;
	int looks = 0, moved_in = 0;
	for (int i = 0; got && looks < LOOKS; i++) {
		struct video_frame f;
		got = video_next(&f, &got, video, &none) && got;
		if (got && i % EVERY == 0) {
			reduce(looks ? &now : &first, &f);
			if (looks++)
				moved_in += all_moves(&first, &now);
		}
		video_frame_free(&f);
	}
	video_close(video);
	free(first.px);
	free(now.px);
	return looks < 2 ? FILM_UNKNOWN : 2 * moved_in >= looks - 1 ? FILM_MOVES : FILM_RESTS;
}

/* The numbers that an earlier look at a file of that size and date left in work/.made/NAME, else what look() tells, which is kept there. False: it tells nothing. */
static bool kept(double told[2], const char *capture, const char *file, const char *name, bool (*look)(double told[2], const char *path))
{
	enum { LIMIT = 1024 };
	struct stat st;
	struct err none = { 0 };
	char *path = mem_printf("%s/%s", capture, file), *at = mem_printf("%s/work/.made/%s", capture, name), *was = 0;
	size_t size;
	bool ok = false;
	if (!stat(path, &st) && S_ISREG(st.st_mode)) {
		char *key = mem_printf("%s %lld %lld.%09ld ", file, (long long)st.st_size, (long long)st.st_mtim.tv_sec, st.st_mtim.tv_nsec);
		ok = file_exists(at) && file_read(&was, &size, at, LIMIT, &none) && !strncmp(was, key, strlen(key)) && sscanf(was + strlen(key), "%lf %lf", &told[0], &told[1]) == 2;
		if (!ok && (ok = look(told, path))) {
			char *text = mem_printf("%s%g %g\n", key, told[0], told[1]), *dir = mem_printf("%s/work/.made", capture);
			struct err not_kept = { 0 };  // it is looked at again
			if (file_mkdirs(dir, &not_kept))
				file_write(at, text, strlen(text), &not_kept);
			free(text);
			free(dir);
		}
		free(key);
	}
	free(was);
	free(path);
	free(at);
	return ok;
}

static bool look_at_camera(double told[2], const char *path)
{
	told[0] = look(path);
	told[1] = 0;
	return told[0] != FILM_UNKNOWN;
}

enum film_camera plan_film_camera(const char *capture, const char *file)
{
	double told[2];
	return !kept(told, capture, file, "film", look_at_camera) ? FILM_UNKNOWN : told[0] == FILM_MOVES ? FILM_MOVES : FILM_RESTS;
}

static bool look_at_length(double told[2], const char *path)
{
	struct video_info info;
	struct err none = { 0 };
	const bool ok = video_header(&info, path, &none);
	told[0] = (double)info.promised;
	told[1] = info.fps > 0 ? fmin(told[0], 60 * info.fps) : told[0];
	return ok;
}

struct film_length plan_film_length(const char *capture, const char *file)
{
	double told[2];
	return kept(told, capture, file, "frames", look_at_length) && told[0] >= 0 && told[1] >= 0 ? (struct film_length){ told[0], told[1] } : (struct film_length){ 0 };
}
