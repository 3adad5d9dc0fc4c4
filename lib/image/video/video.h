/* video: reads and writes video files through libavformat and libavcodec.
 * Files are not trusted: playlists and links to other files are not followed, size and length are bounded, broken frames are
 * left out and counted. Decoding runs in a thread of its own, some frames ahead of the reader.
 * Image  px, upright: a rotation that the file asks for has been applied; centre of the first pixel (0.5, 0.5).
 */
#ifndef IMAGE_VIDEO_VIDEO_H
#define IMAGE_VIDEO_VIDEO_H
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

struct video_conf {
	double limit_mpx;    // of a frame, million pixels
	int limit_frames;    // of the file
	int threads;         // of the decoder; the pictures do not depend on it
	double limit_s;      // of the file, from its first picture to its last; 0: any
};

/* Rows for a stage's option table. */
#define VIDEO_OPTS(c) \
	OPT_REAL("limit.video_mpx", &(c)->limit_mpx, 0.01, 200, "Mpx", "largest frame that is decoded"), \
	OPT_INT("limit.video_frames", &(c)->limit_frames, 1, 10000000, "", "longest video that is read, frames"), \
	OPT_REAL("limit.video_s", &(c)->limit_s, 0, 1e6, "s", "the same in seconds; 0: any")

struct video_info {
	int width, height;   // px, upright
	int rotation;        // degrees clockwise that were applied: 0, 90, 180, 270
	double fps;          // 1 / median interval between frames
	double jitter;       // largest deviation of an interval from the median, as a share of it
	bool variable;       // more than one interval in a hundred is off by more than a fifth
	long frames;         // that the file holds
	long promised;       // frames that its header states; more than `frames` when the file was cut off; 0: not stated
	char codec[32];
};

struct video_frame {
	long index;          // from 0
	double time;         // seconds from the first frame, as the file stamps it
	int width, height;
	const uint8_t *luma; // [height][luma_stride], the decoder's own plane
	int luma_stride;
	void *hold;          // the decoder's frame, which owns the planes
};

struct video;

/* Opens a video; reads all packets of the file once, without decoding, to fill info. video_close.
 * Null, err set ("path: rule"), when it is no video, holds no picture, or is beyond the limits. */
struct video *video_open(struct video_info *info, const char *path, const struct video_conf *conf, struct err *err);

/* What a file's header says, in a few milliseconds: of info fps and promised alone, the frames that a length and a rate come to where they are not stated. Not to be
 * trusted. False, err set, as video_open, but for the limits. */
bool video_header(struct video_info *info, const char *path, struct err *err);

/* Reads the next frame; *got = false at the end. video_frame_free in any case: frames may be kept, and freed in any order and
 * from any thread, also after video_close. False, err set, when decoding cannot go on. */
bool video_next(struct video_frame *frame, bool *got, struct video *video, struct err *err);
void video_frame_free(struct video_frame *frame);

/* Number of frames so far that were damaged and left out. */
long video_damaged(const struct video *video);

/* Null is accepted; may be called before the end. */
void video_close(struct video *video);

/* Converts the pixels x0 <= x < x1, y0 <= y < y1 to 8-bit sRGB at their place in rgb [height][stride] bytes; the rest is not
 * touched. */
void video_frame_rgb(uint8_t *rgb, int stride, const struct video_frame *frame, int x0, int y0, int x1, int y1);

/* Settings of a file that is written: H.264 in MP4. Its bytes depend on the pictures, their times and the settings alone. */
struct video_writer_conf {
	int width, height;   // px; an odd one is filled up with its last row or column
	double fps;
	double crf;          // x264's constant quality, 0 lossless .. 51
	const char *preset;  // x264's; null: "fast"
	const char *made_by; // text kept as the file's comment, or null
};
struct video_writer;

/* Starts a file beside `path`, which video_writer_close renames. Null, err set, when it cannot be made. */
struct video_writer *video_writer_open(const char *path, const struct video_writer_conf *conf, struct err *err);

/* Adds a frame. rgb: [height][width][3], 8-bit sRGB; time: seconds, increasing; multiples of 1 / 90000 s are kept exactly. */
bool video_writer_put(struct video_writer *writer, const uint8_t *rgb, double time, struct err *err);

/* Ends the file. keep: false discards what was written. Frees the writer in any case; null is accepted. */
bool video_writer_close(struct video_writer *writer, bool keep, struct err *err);

#endif
