/* Planes of a frame: upright, 8 bits; and their colour. */
#include <libavutil/imgutils.h>
#include <string.h>

#include "image/video/impl.h"
#include "math/simd.h"

/* True where the planes can be used as they are: 8 bits each, luma first, chroma (if any) in planes of its own. */
static bool plain(int format)
{
	switch (format) {
	case AV_PIX_FMT_YUV420P: case AV_PIX_FMT_YUVJ420P: case AV_PIX_FMT_YUV422P: case AV_PIX_FMT_YUVJ422P:
	case AV_PIX_FMT_YUV444P: case AV_PIX_FMT_YUVJ444P: case AV_PIX_FMT_YUV411P: case AV_PIX_FMT_YUV440P: case AV_PIX_FMT_GRAY8:
		return true;
	default:
		return false;
	}
}

static AVFrame *frame_like(const AVFrame *in, int format, int width, int height)
{
	AVFrame *out = av.av_frame_alloc();
	if (!out)
		return 0;
	out->format = format;
	out->width = width;
	out->height = height;
	if (av.av_frame_get_buffer(out, 0) < 0 || av.av_frame_copy_props(out, in) < 0)
		av.av_frame_free(&out);
	return out;
}

static AVFrame *to_plain(const AVFrame *in)
{
	AVFrame *out = frame_like(in, AV_PIX_FMT_YUV420P, in->width, in->height);
	struct SwsContext *sws = out ? av.sws_getContext(in->width, in->height, in->format, in->width, in->height, AV_PIX_FMT_YUV420P,
	                                              SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT, 0, 0, 0) : 0;
	if (!sws || av.sws_scale(sws, (const uint8_t *const *)in->data, in->linesize, 0, in->height, out->data, out->linesize) <= 0)
		av.av_frame_free(&out);
	av.sws_freeContext(sws);
	return out;
}

static void turn(uint8_t *out, long out_stride, int width, int height, const uint8_t *in, long in_stride, int rotation)
{
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			out[y * out_stride + x] = rotation == 90 ? in[(width - 1 - x) * in_stride + y]
			                          : rotation == 180 ? in[(height - 1 - y) * in_stride + width - 1 - x]
			                                            : in[x * in_stride + height - 1 - y];
}

/* A rotation by 90 degrees exchanges the axes along which chroma is subsampled. */
static int turned_format(int format, int rotation)
{
	bool wide = format == AV_PIX_FMT_YUV422P || format == AV_PIX_FMT_YUVJ422P;
	return rotation == 180 ? format : wide ? AV_PIX_FMT_YUV440P : format == AV_PIX_FMT_YUV440P ? AV_PIX_FMT_YUV422P : format;
}

static AVFrame *turned(const AVFrame *in, int rotation)
{
	int width = rotation == 180 ? in->width : in->height, height = rotation == 180 ? in->height : in->width;
	AVFrame *out = frame_like(in, turned_format(in->format, rotation), width, height);
	const AVPixFmtDescriptor *d = out ? av.av_pix_fmt_desc_get(out->format) : 0;
	for (int c = 0; d && c < d->nb_components; c++)
		turn(out->data[c], out->linesize[c], c ? AV_CEIL_RSHIFT(width, d->log2_chroma_w) : width,
		     c ? AV_CEIL_RSHIFT(height, d->log2_chroma_h) : height, in->data[c], in->linesize[c], rotation);
	return out;
}

AVFrame *video_plane_upright(AVFrame *in, int rotation)
{
	if (!plain(in->format) || in->format == AV_PIX_FMT_YUV411P) {
		AVFrame *out = to_plain(in);
		av.av_frame_free(&in);
		in = out;
	}
	if (in && rotation) {
		AVFrame *out = turned(in, rotation);
		av.av_frame_free(&in);
		in = out;
	}
	return in;
}

/* Y'CbCr to R'G'B' in 1/65536: gain of Y, Cr to R, Cb to G, Cr to G, Cb to B; and black. */
struct matrix {
	int y, rv, gu, gv, bu, black;
};

static struct matrix matrix_of(const AVFrame *f)
{
	bool full = f->color_range == AVCOL_RANGE_JPEG || f->format == AV_PIX_FMT_YUVJ420P || f->format == AV_PIX_FMT_YUVJ422P
	            || f->format == AV_PIX_FMT_YUVJ444P;
	// where the file does not state it, the convention of television: BT.601 for small pictures, BT.709 for large ones
	bool old = f->colorspace == AVCOL_SPC_BT470BG || f->colorspace == AVCOL_SPC_SMPTE170M
	           || (f->colorspace == AVCOL_SPC_UNSPECIFIED && f->height < 720 && f->width < 1280);
	bool wide = f->colorspace == AVCOL_SPC_BT2020_NCL || f->colorspace == AVCOL_SPC_BT2020_CL;
	double kr = old ? 0.299 : wide ? 0.2627 : 0.2126, kb = old ? 0.114 : wide ? 0.0593 : 0.0722;
	double y = 65536 * (full ? 1 : 255.0 / 219), c = 65536 * (full ? 1 : 255.0 / 224), kg = 1 - kr - kb;
	return (struct matrix){ .y = (int)(y + 0.5), .rv = (int)(c * 2 * (1 - kr) + 0.5), .gu = (int)(c * 2 * kb * (1 - kb) / kg + 0.5),
		                .gv = (int)(c * 2 * kr * (1 - kr) / kg + 0.5), .bu = (int)(c * 2 * (1 - kb) + 0.5), .black = full ? 0 : 16 };
}

enum { SPAN = 256 };  // pixels converted together

static inline uint8_t clamp8(int v)
{
	int i = (v + 32768) >> 16;
	return (uint8_t)(i < 0 ? 0 : i > 255 ? 255 : i);
}

SIMD_CLONES static void convert(uint8_t *restrict out, const struct matrix *m, int n, const uint8_t *restrict py, const uint8_t *restrict pu,
                                const uint8_t *restrict pv)
{
	uint8_t r[SPAN], g[SPAN], b[SPAN];
	for (int i = 0; i < n; i++) {
		int l = m->y * (py[i] - m->black), u = pu[i] - 128, v = pv[i] - 128;
		r[i] = clamp8(l + m->rv * v);
		g[i] = clamp8(l - m->gu * u - m->gv * v);
		b[i] = clamp8(l + m->bu * u);
	}
	for (int i = 0; i < n; i++) {
		out[3 * i] = r[i];
		out[3 * i + 1] = g[i];
		out[3 * i + 2] = b[i];
	}
}

/* A row of chroma at each of n pixels from x on. shift: log2 of pixels that share one. */
SIMD_CLONES static void spread(uint8_t *restrict out, const uint8_t *restrict in, int x, int n, int shift)
{
	int i = 0;
	if (shift == 1) {
		for (; i < n && (x + i) % 2; i++)
			out[i] = in[(x + i) >> 1];
		const uint8_t *from = in + ((x + i) >> 1);
		uint8_t *to = out + i;
		const int pairs = (n - i) / 2;
		SIMD_LOOP
		for (int k = 0; k < pairs; k++)
			to[2 * k] = to[2 * k + 1] = from[k];
		i += 2 * pairs;
	}
	for (; i < n; i++)
		out[i] = in[(x + i) >> shift];
}

void video_frame_rgb(uint8_t *rgb, int stride, const struct video_frame *frame, int x0, int y0, int x1, int y1)
{
	const AVFrame *f = frame->hold;
	const AVPixFmtDescriptor *d = av.av_pix_fmt_desc_get(f->format);
	struct matrix m = matrix_of(f);
	bool grey = d->nb_components < 3;
	for (int y = y0; y < y1; y++) {
		const uint8_t *py = f->data[0] + (long)y * f->linesize[0];
		const uint8_t *pu = grey ? 0 : f->data[1] + (long)(y >> d->log2_chroma_h) * f->linesize[1];
		const uint8_t *pv = grey ? 0 : f->data[2] + (long)(y >> d->log2_chroma_h) * f->linesize[2];
		uint8_t *out = rgb + (long)y * stride;
		for (int x = x0; x < x1; x += SPAN) {
			uint8_t u[SPAN], v[SPAN];
			int n = x1 - x < SPAN ? x1 - x : SPAN;
			if (grey) {
				memset(u, 128, sizeof u);
				memset(v, 128, sizeof v);
			} else {
				spread(u, pu, x, n, d->log2_chroma_w);
				spread(v, pv, x, n, d->log2_chroma_w);
			}
			convert(out + 3L * x, &m, n, py + x, u, v);
		}
	}
}
