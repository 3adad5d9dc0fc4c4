#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/video/impl.h"

/* Frames decoded ahead of the reader: enough to even out the differing costs of frames. */
enum { AHEAD = 8 };

struct video {
	struct video_source source;
	struct video_info info;
	char *path;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t changed;
	AVFrame *ahead[AHEAD];
	int head, n;
	bool ended, stop;       // no more will come; none is wanted
	struct err failed;
	long index, damaged;
};

/* Waits for a free place. False: nobody wants more. */
static bool hand_over(struct video *v, AVFrame *frame)
{
	pthread_mutex_lock(&v->lock);
	while (v->n == AHEAD && !v->stop)
		pthread_cond_wait(&v->changed, &v->lock);
	bool wanted = !v->stop;
	if (wanted)
		v->ahead[(v->head + v->n++) % AHEAD] = frame;
	pthread_cond_broadcast(&v->changed);
	pthread_mutex_unlock(&v->lock);
	if (!wanted)
		av.av_frame_free(&frame);
	return wanted;
}

static void count_damaged(struct video *v)
{
	pthread_mutex_lock(&v->lock);
	v->damaged++;
	pthread_mutex_unlock(&v->lock);
}

/* All frames the decoder has ready. False: stop. */
static bool drain(struct video *v)
{
	for (;;) {
		AVFrame *frame = av.av_frame_alloc();
		int got = frame ? av.avcodec_receive_frame(v->source.decoder, frame) : AVERROR(ENOMEM);
		if (got < 0) {
			av.av_frame_free(&frame);
			return got == AVERROR(EAGAIN);
		}
		bool turned = v->info.rotation == 90 || v->info.rotation == 270;
		int width = turned ? frame->height : frame->width, height = turned ? frame->width : frame->height;
		if (width != v->info.width || height != v->info.height) {
			err_set(&v->failed, "%s: its pictures change from %d x %d to %d x %d px: cut it there", v->path, v->info.width,
			        v->info.height, width, height);
			av.av_frame_free(&frame);
			return false;
		}
		if (frame->decode_error_flags || frame->flags & AV_FRAME_FLAG_CORRUPT) {
			count_damaged(v);
			av.av_frame_free(&frame);
			continue;
		}
		frame = video_plane_upright(frame, v->info.rotation);
		if (!frame)
			return err_set(&v->failed, "%s: its pixel format cannot be converted", v->path);
		if (!hand_over(v, frame))
			return false;
	}
}

static void *decode(void *arg)
{
	struct video *v = arg;
	struct video_source *s = &v->source;
	AVPacket *packet = av.av_packet_alloc();
	bool more = packet;
	while (more && av.av_read_frame(s->file, packet) >= 0) {
		// Where a file ends within a picture, the decoder's output for it and its neighbours depends on the number of
		// threads.
		bool whole = !(packet->flags & AV_PKT_FLAG_CORRUPT);
		if (packet->stream_index == s->stream && !whole)
			count_damaged(v);
		if (packet->stream_index == s->stream && whole) {
			int sent = av.avcodec_send_packet(s->decoder, packet);
			if (sent < 0 && sent != AVERROR(EAGAIN) && sent != AVERROR_EOF)
				count_damaged(v);
			more = drain(v);
		}
		av.av_packet_unref(packet);
	}
	if (more && av.avcodec_send_packet(s->decoder, 0) >= 0)
		drain(v);
	av.av_packet_free(&packet);
	pthread_mutex_lock(&v->lock);
	v->ended = true;
	pthread_cond_broadcast(&v->changed);
	pthread_mutex_unlock(&v->lock);
	return 0;
}

/* Size and rate; false when beyond the limits. */
static bool describe(struct video *v, const struct video_conf *conf, struct err *err)
{
	const AVCodecParameters *p = v->source.file->streams[v->source.stream]->codecpar;
	struct video_info *info = &v->info;
	info->rotation = video_source_rotation(&v->source);
	bool turned = info->rotation == 90 || info->rotation == 270;
	info->width = turned ? p->height : p->width;
	info->height = turned ? p->width : p->height;
	snprintf(info->codec, sizeof info->codec, "%s", av.avcodec_get_name(p->codec_id));
	if (info->width < 1 || info->height < 1)
		return err_set(err, "%s: its pictures have no size: copy it again, whole", v->path);
	double mpx = 1e-6 * info->width * info->height;
	if (mpx > conf->limit_mpx)
		return err_set(err, "%s: %d x %d px, must be at most %g Mpx (limit.video_mpx)", v->path, info->width, info->height, conf->limit_mpx);
	return video_source_scan(&v->source, info, v->path, conf, err);
}

struct video *video_open(struct video_info *info, const char *path, const struct video_conf *conf, struct err *err)
{
	struct video *v = mem_new(1, sizeof *v);
	v->path = mem_str(path);
	if (!video_source_open(&v->source, path, err) || !describe(v, conf, err)
	    || !video_source_decode(&v->source, path, conf->threads, err)) {
		video_source_close(&v->source);
		free(v->path);
		free(v);
		return 0;
	}
	pthread_mutex_init(&v->lock, 0);
	pthread_cond_init(&v->changed, 0);
	if (pthread_create(&v->thread, 0, decode, v))
		abort();  // as with memory: where no thread can be started the program ends
	*info = v->info;
	return v;
}

bool video_next(struct video_frame *frame, bool *got, struct video *v, struct err *err)
{
	*frame = (struct video_frame){ 0 };
	pthread_mutex_lock(&v->lock);
	while (!v->n && !v->ended)
		pthread_cond_wait(&v->changed, &v->lock);
	AVFrame *f = 0;
	if (v->n) {
		f = v->ahead[v->head];
		v->head = (v->head + 1) % AHEAD;
		v->n--;
	}
	pthread_cond_broadcast(&v->changed);
	pthread_mutex_unlock(&v->lock);
	*got = f;
	if (!f)
		return !err_is(&v->failed) || err_set(err, "%s", v->failed.msg);
	const AVStream *st = v->source.file->streams[v->source.stream];
	int64_t at = f->best_effort_timestamp;
	double unstamped = v->info.fps > 0 ? (double)v->index / v->info.fps : (double)v->index;
	*frame = (struct video_frame){ .index = v->index++, .width = f->width, .height = f->height, .luma = f->data[0],
		                       .luma_stride = f->linesize[0], .hold = f };
	frame->time = at == AV_NOPTS_VALUE ? unstamped : (double)at * av_q2d(st->time_base) - v->source.first;
	return true;
}

void video_frame_free(struct video_frame *frame)
{
	AVFrame *f = frame->hold;
	av.av_frame_free(&f);
	*frame = (struct video_frame){ 0 };
}

long video_damaged(const struct video *v)
{
	pthread_mutex_t *lock = (pthread_mutex_t *)&v->lock;
	pthread_mutex_lock(lock);
	long n = v->damaged;
	pthread_mutex_unlock(lock);
	return n;
}

void video_close(struct video *v)
{
	if (!v)
		return;
	pthread_mutex_lock(&v->lock);
	v->stop = true;
	pthread_cond_broadcast(&v->changed);
	pthread_mutex_unlock(&v->lock);
	pthread_join(v->thread, 0);
	for (; v->n; v->n--, v->head = (v->head + 1) % AHEAD)
		av.av_frame_free(&v->ahead[v->head]);
	pthread_mutex_destroy(&v->lock);
	pthread_cond_destroy(&v->changed);
	video_source_close(&v->source);
	free(v->path);
	free(v);
}
