/* skin_track: tracks many points of skin through a video, each against one reference frame, so that errors do not accumulate.
 * Every point is a patch under its own affine warp (image/patch/patch.h), started from the frame before. The motion of its neighbours on the
 * mesh predicts its place: it detects outliers, restarts lost points and serves as a prior.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_POINTS_SKIN_TRACK_H
#define TRACK_POINTS_SKIN_TRACK_H
#include "base/opt.h"
#include "base/pack.h"
#include "image/patch/patch.h"
#include "track/points/points.h"

struct skin_track_conf {
	int radius;            // px of a patch at each level
	int every;             // of its pixels: 1 all, 2 every other
	int levels;            // of the pyramid
	int iterations;
	double stop;           // px
	double noise;          // of a pixel, 0..255
	double misfit;         // number of pixels whose errors are correlated where a patch does not fit (image/patch/patch.h)
	double min_ncc;        // below it a point counts as not seen
	double smooth;         // px: standard deviation of a point from its neighbours' field
	double agree;          // px: a point that fits and is so near to that field is not measured again
	double outlier;        // px from that field beyond which a point counts as lost
	double back;           // px: forward-backward check; 0: none
	int sweeps;            // rounds of prediction from the neighbours
	double still;          // mean change of brightness (of 255) below which a frame counts as unchanged
	double quiet;          // likewise of the skin about one point; 0: every point is measured in every frame
};

#define SKIN_TRACK_OPTS(c) \
	OPT_INT("patch_radius_px", &(c)->radius, 3, 24, "px", "half the side of a patch of skin"), \
	OPT_INT("patch_every", &(c)->every, 1, 2, "", "1: all pixels of a patch; 2: every other, as on a chessboard"), \
	OPT_INT("patch_levels", &(c)->levels, 1, SCALES_LEVELS, "", "halvings of the picture, the full one included"), \
	OPT_INT("patch_iterations", &(c)->iterations, 1, 100, "", "steps of a patch on each level"), \
	OPT_REAL("patch_stop_px", &(c)->stop, 1e-4, 1, "px", "a smaller step is the last"), \
	OPT_REAL("noise", &(c)->noise, 0.1, 50, "", "noise of a pixel, of 255"), \
	OPT_REAL("misfit_px", &(c)->misfit, 0, 1000, "px", "pixels that err together where a patch does not fit"), \
	OPT_REAL("min_ncc", &(c)->min_ncc, 0, 1, "", "correlation with the reference below which a point is not seen"), \
	OPT_REAL("smooth_px", &(c)->smooth, 0.01, 10, "px", "trust in what the neighbours do: its standard deviation"), \
	OPT_REAL("agree_px", &(c)->agree, 0, 10, "px", "a point that fits, so near to where its neighbours see it, is done"), \
	OPT_REAL("outlier_px", &(c)->outlier, 0.5, 50, "px", "further from what its neighbours do a point is lost"), \
	OPT_REAL("back_px", &(c)->back, 0, 10, "px", "forward-backward check of doubtful points; 0: none"), \
	OPT_INT("sweeps", &(c)->sweeps, 1, 10, "", "rounds of asking the neighbours"), \
	OPT_REAL("skin_still", &(c)->still, 0, 20, "", "mean change of brightness (of 255) of a frame that stands still"), \
	OPT_REAL("skin_quiet", &(c)->quiet, 0, 20, "", "and of the skin about a point that stays; 0: all are measured in every frame")

struct skin_point_state {
	double at[2];          // best estimate; also where the point is not seen
	double confidence;     // 0: not seen
	double ncc;
};

struct skin_track;

/* luma: the reference frame, [height][stride]; mask[height][width] (may be null): 0 where there is no skin, else 255. Copies all;
 * skin_track_free, which accepts null. */
struct skin_track *skin_track_new(const struct skin_points *points, const uint8_t *luma, int stride, int width, int height,
                                  const uint8_t *mask, const struct skin_track_conf *conf);
void skin_track_free(struct skin_track *track);

/* Tracks the points in the next frame, of the reference's size. state[n] is overwritten. Returns the share of points seen. */
double skin_track_push(struct skin_track *track, const uint8_t *luma, int stride, struct skin_point_state *state);

/* Every point's warp after the last push: warp[n]. */
void skin_track_warps(struct patch_warp *warp, const struct skin_track *track);

/* Where points that were seen at at[m] in the reference are before the first push, in place of their places in the reference: each of the track's begins
 * as the nearest one does. */
void skin_track_begin(struct skin_track *track, int m, const double (*at)[2], const struct patch_warp *warp);

/* True when the last push found the frame unchanged. */
bool skin_track_was_still(const struct skin_track *track);

/* Its state after a push (base/pack.h). Read into a track made with the same reference, points and settings. */
void skin_track_pack(struct pack *pack, struct skin_track *track);

/* Puts all points back to their places in the reference: after a cut, or to start from the reference in another direction. */
void skin_track_restart(struct skin_track *track);

#endif
