/* clip OUT.mp4 WIDTH TIMES PICTURE...: a video of photographs, each for so many frames, at 30 frames/s. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bridge/cv_photo.h"
#include "image/video/video.h"

static bool put(struct video_writer **writer, long *frame, const char *out, int width, int times, const char *picture, struct err *err)
{
	uint8_t *px;
	int w, h;
	if (!picture_read(&px, &w, &h, picture, 100, err))
		return false;
	int height = 2 * (int)lround(0.5 * width * h / w);
	uint8_t *small = cv_resize8(px, w, h, 3, width, height);
	if (!*writer)
		*writer = video_writer_open(out, &(struct video_writer_conf){ .width = width, .height = height, .fps = 30, .crf = 16 }, err);
	bool ok = *writer;
	for (int i = 0; i < times && ok; i++)
		ok = video_writer_put(*writer, small, (double)(*frame)++ / 30, err);
	free(px);
	free(small);
	return ok;
}

int main(int argc, char **argv)
{
	struct video_writer *writer = 0;
	struct err err = { 0 };
	long frame = 0;
	if (argc < 5)
		return 2;
	for (int i = 4; i < argc && !err_is(&err); i++)
		put(&writer, &frame, argv[1], atoi(argv[2]), atoi(argv[3]), argv[i], &err);
	video_writer_close(writer, !err_is(&err), &err);
	if (err_is(&err))
		fprintf(stderr, "%s\n", err.msg);
	return err_is(&err);
}
