/* What the files of the reader share. */
#ifndef IMAGE_VIDEO_IMPL_H
#define IMAGE_VIDEO_IMPL_H
#include "image/video/video.h"
#include "image/video/api.h"

/* An open file and its one stream of pictures. */
struct video_source {
	AVFormatContext *file;
	AVCodecContext *decoder;  // null until video_source_decode
	int stream;
	double first;             // seconds of the earliest frame, in the file's own time
};

/* Opens the file and chooses its stream of pictures. False, err set, when there is none. */
bool video_source_open(struct video_source *source, const char *path, struct err *err);
bool video_source_decode(struct video_source *source, const char *path, int threads, struct err *err);
void video_source_close(struct video_source *source);

/* Times and number of its frames, read from its packets; goes back to the start. */
bool video_source_scan(struct video_source *source, struct video_info *info, const char *path, const struct video_conf *limits, struct err *err);

/* Degrees clockwise, a multiple of 90, that make its pictures upright. */
int video_source_rotation(const struct video_source *source);

/* Upright, 8 bits, planar YUV of whatever the decoder gave; takes over `in`. Null: no memory for it or a format that
 * cannot be converted. */
AVFrame *video_plane_upright(AVFrame *in, int rotation);

#endif
