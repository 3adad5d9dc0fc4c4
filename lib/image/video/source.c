#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/asked.h"
#include "base/mem.h"
#include "image/video/impl.h"
#include "math/stats.h"

/* Containers that hold pictures themselves. Playlists, which name other files and hosts, are not among them. */
static const char formats[] = "mov,matroska,avi,mpegts,mpeg,mpegvideo,m4v,h264,hevc,ivf,asf,flv,ogg,mxf,dv,y4m,yuv4mpegpipe";
static const char codecs[] = "h264,hevc,vp8,libvpx,vp9,libvpx-vp9,av1,libdav1d,libaom-av1,mpeg4,mpeg2video,mpeg1video,mjpeg,prores,"
                             "ffv1,dnxhd,rawvideo,huffyuv,utvideo,theora,dvvideo,cinepak,msmpeg4v3,wmv2,wmv3,vc1,flv,h263";

static const char protocol[] = "file:";

static bool choose(struct video_source *s, const char *path, struct err *err)
{
	bool sound = false;
	s->stream = -1;
	for (unsigned i = 0; i < s->file->nb_streams; i++) {
		const AVStream *st = s->file->streams[i];
		sound |= st->codecpar->codec_type == AVMEDIA_TYPE_AUDIO;
		// a cover picture is no video
		if (st->codecpar->codec_type == AVMEDIA_TYPE_VIDEO && !(st->disposition & AV_DISPOSITION_ATTACHED_PIC) && s->stream < 0)
			s->stream = (int)i;
		else
			s->file->streams[i]->discard = AVDISCARD_ALL;
	}
	if (s->stream < 0)
		return err_set(err, "%s: holds %s: film the face, or copy the file again, whole", path,
		               sound ? "sound but no picture" : "no picture, or is cut off before it");
	return true;
}

bool video_source_open(struct video_source *s, const char *path, struct err *err)
{
	*s = (struct video_source){ 0 };
	struct stat st;
	// A pipe would be waited for.
	if (!stat(path, &st) && !S_ISREG(st.st_mode))
		return err_set(err, "%s: is not a regular file", path);
	if (!video_api_load(err))
		return err_wrap(err, "%s", path);
	av.av_log_set_level(AV_LOG_QUIET);
	char *url = mem_printf("%s%s", protocol, path);
	AVDictionary *opts = 0;
	av.av_dict_set(&opts, "format_whitelist", formats, 0);
	av.av_dict_set(&opts, "codec_whitelist", codecs, 0);
	av.av_dict_set(&opts, "protocol_whitelist", "file", 0);
	int got = av.avformat_open_input(&s->file, url, 0, &opts);
	av.av_dict_free(&opts);
	free(url);
	if (got == AVERROR(ENOENT) || got == AVERROR(EACCES))
		return err_set(err, "%s: %s", path, strerror(AVUNERROR(got)));
	if (got < 0)
		return err_set(err, "%s: is no video, or cut off before its index: copy it again, whole", path);
	if (av.avformat_find_stream_info(s->file, 0) < 0)
		return err_set(err, "%s: its streams cannot be read: copy it again, whole", path);
	return choose(s, path, err);
}

bool video_source_decode(struct video_source *s, const char *path, int threads, struct err *err)
{
	const AVCodecParameters *p = s->file->streams[s->stream]->codecpar;
	const AVCodec *codec = av.avcodec_find_decoder(p->codec_id);
	if (!codec)
		return err_set(err, "%s: its codec (%s) cannot be decoded: convert it to H.264", path, av.avcodec_get_name(p->codec_id));
	s->decoder = av.avcodec_alloc_context3(codec);
	if (!s->decoder || av.avcodec_parameters_to_context(s->decoder, p) < 0)
		return err_set(err, "%s: its codec's parameters cannot be read", path);
	s->decoder->thread_count = threads;
	s->decoder->pkt_timebase = s->file->streams[s->stream]->time_base;
	AVDictionary *opts = 0;
	av.av_dict_set(&opts, "codec_whitelist", codecs, 0);
	int got = av.avcodec_open2(s->decoder, codec, &opts);
	av.av_dict_free(&opts);
	return got >= 0 || err_set(err, "%s: its codec (%s) cannot be opened: convert it to H.264", path, codec->name);
}

void video_source_close(struct video_source *s)
{
	// A disk that failed to give a part: what is made of the rest does not count.
	if (s->file && s->file->pb && s->file->pb->error == AVERROR(EIO) && s->file->url && !strncmp(s->file->url, protocol, strlen(protocol)))
		asked_in_vain(s->file->url + strlen(protocol), EIO);
	if (s->decoder)
		av.avcodec_free_context(&s->decoder);
	if (s->file)
		av.avformat_close_input(&s->file);
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Rate and evenness from sorted times. */
static void intervals(struct video_info *info, double *first, long n, double *time)
{
	*first = 0;
	if (n)
		qsort(time, (size_t)n, sizeof *time, ascending);
	if (n)
		*first = time[0];
	if (n < 2)
		return;
	double *step = mem_array((size_t)n, sizeof *step);
	for (long i = 0; i + 1 < n; i++)
		step[i] = time[i + 1] - time[i];
	double median = stats_median((int)(n - 1), step);
	long off = 0;
	for (long i = 0; i + 1 < n && median > 0; i++) {
		double d = fabs(time[i + 1] - time[i] - median) / median;
		info->jitter = fmax(info->jitter, d);
		off += d > 0.2;
	}
	info->fps = median > 0 ? 1 / median : 0;
	info->variable = off * 100 > n - 1;
	free(step);
}

static bool too_long(double seconds, const struct video_conf *limits)
{
	return limits->limit_s > 0 && seconds > limits->limit_s;
}

bool video_source_scan(struct video_source *s, struct video_info *info, const char *path, const struct video_conf *limits, struct err *err)
{
	AVStream *st = s->file->streams[s->stream];
	AVPacket *packet = av.av_packet_alloc();
	double *time = 0, first = INFINITY, last = -INFINITY;
	long n = 0, room = 0;
	while (packet && av.av_read_frame(s->file, packet) >= 0) {
		bool ours = packet->stream_index == s->stream && !(packet->flags & AV_PKT_FLAG_DISCARD) && packet->size > 0;
		int64_t at = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
		if (ours && n == room)
			time = mem_grow(time, (size_t)(room = 2 * room + 1024), sizeof *time);
		if (ours) {
			double unstamped = (double)n / fmax(1, av_q2d(st->avg_frame_rate));
			time[n] = at == AV_NOPTS_VALUE ? unstamped : (double)at * av_q2d(st->time_base);
			first = fmin(first, time[n]);
			last = fmax(last, time[n++]);
		}
		av.av_packet_unref(packet);
		if (n > limits->limit_frames || too_long(last - first, limits))
			break;
	}
	av.av_packet_free(&packet);
	intervals(info, &s->first, n, time);
	free(time);
	info->frames = n;
	info->promised = st->nb_frames;
	if (n > limits->limit_frames)
		return err_set(err, "%s: has more than %d frames (limit.video_frames): cut it, or raise the limit", path, limits->limit_frames);
	if (too_long(last - first, limits))
		return err_set(err, "%s: takes more than %g s (limit.video_s): cut it, or raise the limit", path, limits->limit_s);
	if (n == 0)
		return err_set(err, "%s: holds no frame: copy it again, whole", path);
	// Opened again, not sought: containers differ in what they take for the start, and MP4's own seek ends in the last
	// group of pictures.
	double begin = s->first;
	video_source_close(s);
	bool again = video_source_open(s, path, err);
	s->first = begin;
	return again;
}

bool video_header(struct video_info *info, const char *path, struct err *err)
{
	struct video_source s;
	*info = (struct video_info){ 0 };
	const bool ok = video_source_open(&s, path, err);
	if (ok) {
		const AVStream *st = s.file->streams[s.stream];
		const double rate = st->avg_frame_rate.den > 0 ? av_q2d(st->avg_frame_rate) : 0, s_long = s.file->duration > 0 ? (double)s.file->duration / AV_TIME_BASE : 0;
		info->fps = fmax(rate, 0);
		info->promised = st->nb_frames > 0 ? st->nb_frames : lrint(fmin(info->fps * s_long, 1e9));
	}
	video_source_close(&s);
	return ok;
}

int video_source_rotation(const struct video_source *s)
{
	size_t size = 0;
	const uint8_t *matrix = av.av_stream_get_side_data(s->file->streams[s->stream], AV_PKT_DATA_DISPLAYMATRIX, &size);
	double counter = matrix && size >= 9 * sizeof(int32_t) ? av.av_display_rotation_get((const int32_t *)matrix) : 0;
	if (!isfinite(counter))
		return 0;
	long quarter = lround(-counter / 90);
	return (int)((quarter % 4 + 4) % 4) * 90;
}
