/* impl: what the files of this folder share. Texels of the person's chart are `side` a side; its maps are ln of albedo. */
#ifndef DRAW_COMPLEXION_IMPL_H
#define DRAW_COMPLEXION_IMPL_H
#include "draw/complexion/complexion.h"

enum { BANDS = 5, QUANTILES = 33, HARMONICS = 9 };

/* Lashes of an eye in a frame. open: how far its lids stand apart in their middles, mm. */
struct complexion_lashes {
	struct hair_lid lid[2];
	double open;
};

/* Grain of the skin: what varies within some millimetres. */
struct complexion_grain {
	double mm[BANDS], rms[BANDS];   // sizes, and how strong each is in ln of luminance
	double all, slope[3];           // rms of all; ln of each colour for one of luminance
	double quantile[QUANTILES];     // of it over `all`, from 0 to 1
};

struct complexion {
	const struct mesh *mesh;
	struct complexion_conf conf;
	double eye[2][3], radius, texel_mm;   // texel_mm: in the middle of the chart
	struct complexion_chart chart;
	int side;
	struct complexion_spot *spot;         // [side][side]
	int n_views;
	uint8_t (*view[COMPLEXION_VIEWS])[4]; // [side][side] sRGB, weight
	struct complexion_lashes lashes[2 * COMPLEXION_VIEWS];
	int n_lashes;
	struct hair_film hair;
	double white[3];                      // of the eyes, linear; 0: not seen
	float (*ln)[3];                       // [side][side]
	float *real;                          // 0..1 share that was seen, here or on the other half
	float mean[3];
	struct complexion_grain grain;
};

/* gather.c: the mean over the frames, ln rgb[side][side][3], weight[side][side] 0: none. */
void complexion_gather(float (*ln)[3], float *weight, const struct complexion *c);

/* light.c: takes the light off. keep: texels by which it is fitted. shade: out, the median of it on skin; from: out, where the
 * most green light comes from. False: too few. */
bool complexion_unlight(float (*ln)[3], const float *weight, const bool *keep, double shade[3], double from[3], const struct complexion *c);

/* hair.c: clears the weights of texels with hairs on them, and beside what is not seen. brow: out, [side][side] where brows are. */
bool complexion_shave(float *weight, uint8_t *brow, const float (*ln)[3], const struct complexion *c, struct err *err);

/* brows.c: fills in film's brows and the colour of their hairs, as ln has it. before, after: the weights before and after shaving. */
bool complexion_brows(struct hair_film *film, const float (*ln)[3], const float *before, const float *after, const uint8_t *brow, const struct complexion *c,
                      struct err *err);

/* lashes.c. _add: those of both eyes of a frame. _mean: of all frames in which the lids stand open. */
void complexion_add_lashes(struct complexion *c, const struct complexion_view *v);
void complexion_lashes_mean(struct hair_lid lid[2], const struct complexion *c);

/* fill.c: makes both halves alike over centimetres, and fills what is not seen: ln; real: out. */
bool complexion_fill(float (*ln)[3], float *real, const float *weight, double *seen, double *mirrored, struct complexion *c, struct err *err);

/* A mean of map[n = side side][channels] by a Gaussian of mm, weighted; weight: [n]. sum: out, [n] the weights' own mean. */
bool complexion_blur(float *out, float *sum, const float *map, const float *weight, int channels, double mm, const struct complexion *c, struct err *err);

/* Place of a texel on the person, mm. False: none. */
bool complexion_place(float x[3], const struct complexion *c, long texel);

/* grain.c */
bool complexion_grain_measure(struct complexion_grain *grain, const float (*ln)[3], const float *weight, const struct complexion *c, struct err *err);
/* ln of luminance at a place of a skin at rest, mm; texel: sizes below it are left out. */
double complexion_grain_at(const struct complexion_grain *grain, const float x[3], double texel);

static inline double complexion_luminance(const float ln[3])
{
	return 0.2126 * (double)ln[0] + 0.7152 * (double)ln[1] + 0.0722 * (double)ln[2];
}

#endif
