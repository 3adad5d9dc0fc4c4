/* api: the functions of libavformat, libavcodec, libswscale and libavutil that reader and writer call, loaded with dlopen when
 * the first video is opened. Linking them would load some hundred libraries into every program, which took longer than the work
 * on a small photograph.
 */
#ifndef IMAGE_VIDEO_API_H
#define IMAGE_VIDEO_API_H
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>

#include "base/err.h"

#define VIDEO_API_FORMAT(X) \
	X(av_interleaved_write_frame) X(av_read_frame) X(av_stream_get_side_data) X(av_write_trailer) \
	X(avformat_alloc_output_context2) X(avformat_close_input) X(avformat_find_stream_info) \
	X(avformat_free_context) X(avformat_new_stream) X(avformat_open_input) X(avformat_write_header) X(avio_closep) \
	X(avio_open)
#define VIDEO_API_CODEC(X) \
	X(av_packet_alloc) X(av_packet_free) X(av_packet_rescale_ts) X(av_packet_unref) X(avcodec_alloc_context3) \
	X(avcodec_find_decoder) X(avcodec_find_encoder_by_name) X(avcodec_free_context) X(avcodec_get_name) \
	X(avcodec_open2) X(avcodec_parameters_from_context) X(avcodec_parameters_to_context) X(avcodec_receive_frame) \
	X(avcodec_receive_packet) X(avcodec_send_frame) X(avcodec_send_packet)
#define VIDEO_API_SCALE(X) \
	X(sws_freeContext) X(sws_getCoefficients) X(sws_getContext) X(sws_scale) X(sws_setColorspaceDetails)
#define VIDEO_API_UTIL(X) \
	X(av_d2q) X(av_dict_free) X(av_dict_set) X(av_display_rotation_get) X(av_frame_alloc) X(av_frame_copy_props) \
	X(av_frame_free) X(av_frame_get_buffer) X(av_log_set_level) X(av_opt_set) X(av_opt_set_double) \
	X(av_pix_fmt_desc_get)

#define VIDEO_API_ONE(name) __typeof__(name) *name;
struct video_api {
	VIDEO_API_FORMAT(VIDEO_API_ONE)
	VIDEO_API_CODEC(VIDEO_API_ONE)
	VIDEO_API_SCALE(VIDEO_API_ONE)
	VIDEO_API_UTIL(VIDEO_API_ONE)
};
#undef VIDEO_API_ONE

/* Null until video_api_load has succeeded; not changed after it. */
extern struct video_api av;

/* Loads the libraries, of the version that was compiled against; once in a program, from any thread. False, err set (which
 * library is missing), at every call when they cannot be loaded. */
bool video_api_load(struct err *err);

#endif
