#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/gate.h"
#include "base/mem.h"
#include "image/video/video.h"
#include "image/video/api.h"

enum { CLOCK = 90000 };     // ticks a second
enum { ENCODER_THREADS = 4 };  // x264's bytes depend on their number: always the same one

struct video_writer {
	char *path, *part;
	int fd;                 // of the part, so that FFmpeg follows no path to it
	int width, height;      // of the pictures given
	AVFormatContext *file;
	AVCodecContext *encoder;
	int even_w, even_h;     // of the file
	struct SwsContext *sws;
	uint8_t *rgb;           // one picture with even sides
	int64_t last;
};

static void writer_free(struct video_writer *w)
{
	if (w->file && w->file->pb)
		av.avio_closep(&w->file->pb);
	av.avformat_free_context(w->file);
	av.avcodec_free_context(&w->encoder);
	av.sws_freeContext(w->sws);
	if (w->fd >= 0)
		close(w->fd);
	free(w->rgb);
	free(w->path);
	free(w->part);
	free(w);
}

static bool open_encoder(struct video_writer *w, const struct video_writer_conf *conf, struct err *err)
{
	const AVCodec *codec = av.avcodec_find_encoder_by_name("libx264");
	if (!codec || !(w->encoder = av.avcodec_alloc_context3(codec)))
		return err_set(err, "%s: this machine's libavcodec has no x264 to write H.264 with", w->path);
	AVCodecContext *e = w->encoder;
	e->width = w->even_w;
	e->height = w->even_h;
	e->pix_fmt = AV_PIX_FMT_YUV420P;
	e->time_base = (AVRational){ 1, CLOCK };
	e->framerate = av.av_d2q(conf->fps, 1001000);
	e->color_range = AVCOL_RANGE_MPEG;
	e->colorspace = AVCOL_SPC_BT709;
	e->color_primaries = AVCOL_PRI_BT709;
	e->color_trc = AVCOL_TRC_BT709;
	e->thread_count = ENCODER_THREADS;
	e->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
	av.av_opt_set(e->priv_data, "preset", conf->preset ? conf->preset : "fast", 0);
	av.av_opt_set_double(e->priv_data, "crf", conf->crf, 0);
	return av.avcodec_open2(e, codec, 0) >= 0
	       || err_set(err, "%s: x264 refuses %d x %d px, %g frames/s, quality %g", w->path, conf->width, conf->height, conf->fps, conf->crf);
}

static bool open_stream(struct video_writer *w, const struct video_writer_conf *conf)
{
	AVStream *st = av.avformat_new_stream(w->file, 0);
	if (!st || av.avcodec_parameters_from_context(st->codecpar, w->encoder) < 0)
		return false;
	st->time_base = w->encoder->time_base;
	st->avg_frame_rate = w->encoder->framerate;
	w->file->flags |= AVFMT_FLAG_BITEXACT;
	if (conf->made_by)
		av.av_dict_set(&w->file->metadata, "comment", conf->made_by, 0);
	return true;
}

static bool open_file(struct video_writer *w, const struct video_writer_conf *conf, struct err *err)
{
	w->fd = gate_create(w->part, O_WRONLY | O_TRUNC);
	char *url = file_exists("/proc/self/fd") ? mem_printf("file:/proc/self/fd/%d", w->fd) : mem_printf("file:%s", w->part);
	bool ok = w->fd >= 0 && av.avformat_alloc_output_context2(&w->file, 0, "mp4", url) >= 0 && open_stream(w, conf);
	AVDictionary *opts = 0;
	av.av_dict_set(&opts, "movflags", "+faststart", 0);  // plays while it loads
	ok = ok && av.avio_open(&w->file->pb, url, AVIO_FLAG_WRITE) >= 0 && av.avformat_write_header(w->file, &opts) >= 0;
	av.av_dict_free(&opts);
	free(url);
	return ok || err_set(err, "%s: cannot be written", w->path);
}

static bool open_colours(struct video_writer *w, struct err *err)
{
	w->rgb = mem_array((size_t)w->even_w * (size_t)w->even_h, 3);
	w->sws = av.sws_getContext(w->even_w, w->even_h, AV_PIX_FMT_RGB24, w->even_w, w->even_h, AV_PIX_FMT_YUV420P,
	                        SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INT, 0, 0, 0);
	const int *to = av.sws_getCoefficients(SWS_CS_ITU709);
	return (w->sws && av.sws_setColorspaceDetails(w->sws, to, 1, to, 0, 0, 1 << 16, 1 << 16) >= 0)
	       || err_set(err, "%s: colours cannot be converted", w->path);
}

struct video_writer *video_writer_open(const char *path, const struct video_writer_conf *conf, struct err *err)
{
	if (!video_api_load(err)) {
		err_wrap(err, "%s", path);
		return 0;
	}
	struct video_writer *w = mem_new(1, sizeof *w);
	av.av_log_set_level(AV_LOG_QUIET);
	w->path = mem_str(path);
	w->part = file_temporary(path);
	w->width = conf->width;
	w->height = conf->height;
	w->even_w = (conf->width + 1) & ~1;
	w->even_h = (conf->height + 1) & ~1;
	w->last = w->fd = -1;
	if (open_encoder(w, conf, err) && open_file(w, conf, err) && open_colours(w, err))
		return w;
	struct err none = { 0 };
	file_remove(w->part, &none);
	writer_free(w);
	return 0;
}

/* Sends one frame (null: no more) and writes what comes out. */
static bool encode(struct video_writer *w, AVFrame *frame, struct err *err)
{
	AVPacket *packet = av.av_packet_alloc();
	bool ok = packet && av.avcodec_send_frame(w->encoder, frame) >= 0;
	while (ok) {
		int got = av.avcodec_receive_packet(w->encoder, packet);
		if (got == AVERROR(EAGAIN) || got == AVERROR_EOF)
			break;
		av.av_packet_rescale_ts(packet, w->encoder->time_base, w->file->streams[0]->time_base);
		ok = got >= 0 && av.av_interleaved_write_frame(w->file, packet) >= 0;
	}
	av.av_packet_free(&packet);
	return ok || err_set(err, "%s: cannot be written: is the disk full?", w->path);
}

/* Copies the picture; its last column and row are repeated where the file's size is rounded up to even. */
static void fill_up(struct video_writer *w, const uint8_t *rgb)
{
	for (int y = 0; y < w->even_h; y++) {
		uint8_t *row = w->rgb + (long)y * w->even_w * 3;
		memcpy(row, rgb + (long)(y < w->height ? y : w->height - 1) * w->width * 3, (size_t)w->width * 3);
		if (w->even_w > w->width)
			memcpy(row + 3 * w->width, row + 3 * (w->width - 1), 3);
	}
}

bool video_writer_put(struct video_writer *w, const uint8_t *rgb, double time, struct err *err)
{
	int64_t at = llround(time * CLOCK);
	if (at <= w->last)
		return err_set(err, "%s: frame at %.4f s: times must grow", w->path, time);
	AVFrame *frame = av.av_frame_alloc();
	if (!frame)
		return err_set(err, "%s: no memory for a frame", w->path);
	frame->format = AV_PIX_FMT_YUV420P;
	frame->width = w->even_w;
	frame->height = w->even_h;
	frame->pts = w->last = at;
	bool ok = av.av_frame_get_buffer(frame, 0) >= 0 || err_set(err, "%s: no memory for a frame", w->path);
	if (ok) {
		fill_up(w, rgb);
		const uint8_t *const from[] = { w->rgb };
		const int stride[] = { 3 * w->even_w };
		av.sws_scale(w->sws, from, stride, 0, w->even_h, frame->data, frame->linesize);
		ok = encode(w, frame, err);
	}
	av.av_frame_free(&frame);
	return ok;
}

bool video_writer_close(struct video_writer *w, bool keep, struct err *err)
{
	if (!w)
		return true;
	struct err none = { 0 };
	bool ok = !keep || (encode(w, 0, err) && (av.av_write_trailer(w->file) >= 0 || err_set(err, "%s: cannot be written", w->path)));
	if (w->file && w->file->pb)
		ok = (av.avio_closep(&w->file->pb) >= 0 || err_set(err, "%s: cannot be written", w->path)) && ok;
	if (keep && ok)
		ok = gate_rename(w->part, w->path) || err_set(err, "%s: cannot be put in its place", w->path);
	if (!keep || !ok)
		file_remove(w->part, &none);
	writer_free(w);
	return ok;
}
