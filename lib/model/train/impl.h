/* train_impl: the state of a training run, and its steps (train.h). */
#ifndef MODEL_TRAIN_IMPL_H
#define MODEL_TRAIN_IMPL_H
#include <float.h>

#include "math/scatter/scatter.h"
#include "model/train/train.h"

enum { PILOT_FRAMES = 512, PILOT_COMPONENTS = 20, EYE_INPUTS = 5 };

#define TRAIN_LEAST_SHARE 0.3  // a frame with a smaller share of its numbers measured has weight 0
#define TRAIN_ON 0.1           // of an expression's strength: frames that show none by more are the baseline's, the others tell what lids do with it

/* One of three parts that are modelled alike: the lids of one eye, or the skin. px of the modelling camera. */
struct part {
	int n, kept;         // coordinates; components of the model
	bool used;           // measured often enough to be modelled
	bool *seen;          // [n] coordinates measured in conf->min_seen of the frames
	int k;               // components of the pilot
	double *mean, *V;    // [n], [n][k] of the pilot
	double *variance;    // [PILOT_COMPONENTS] px^2 along them
	double usual;        // px: median distance of a frame from the pilot's subspace
	struct scatter sum;  // lids: [5 inputs | n]; skin: [both eyes' lids | action units | n]
	int from;            // column of sum where the coordinates begin
	double *x, *w;       // [n_sample][n], [n_sample]: the sample's frames, filled in, and their weights
	int k_max;           // columns of V_all, the components of the whole clip
	double *V_all, *sd_all;  // [n][k_max], [k_max]
	int rank, rank_inputs;
	double ridge;
	long outlying, used_frames;
	double filled, numbers;
};

struct train {
	const struct train_clip *clip;
	const struct train_conf *conf;
	struct skin_model *model;
	struct train_report *report;
	double *g;           // [n][n_inputs], short gaps interpolated; NAN in long ones
	bool eye[2];         // inputs and lids of that eye are measured often enough
	struct part part[TRAIN_PARTS];
	struct scatter inputs;  // [n_inputs] of the frames that the skin is learnt from
	int n_lid, n_eye;    // coordinates of all lids, of one eye's
	long n_sample, *sample;  // frames of the sample
	int n_blocks, *block;    // time block of each sample frame; -1: in the gap between two
};

/* Fills in frames from the part's pilot: a number of confidence c becomes c times itself plus (1 - c) times the pilot's fit.
 * x      [n][part->n] px, in and out
 * c      [n][part->n] confidence of each number, 0..1; 0 or NAN: not measured
 * d      [n] out: root mean square distance of the measured numbers from the pilot's fit, px
 * share  [n] out: share of the numbers measured */
void part_complete(struct part *part, long n, double *x, const double *c, double *d, double *share);

/* The same for a few rows, on the calling thread. */
void part_complete_few(const struct part *part, int n, double *x, const double *c, double *d, double *share);

/* Whether every number of these frames, c[n][part->n], that the part uses is measured with confidence 1. */
bool part_all_measured(const struct part *part, int n, const double *c);

/* Robust weight of a frame at distance d from the pilot: Huber's weight for scatter, (huber / ratio)^2 beyond huber times the
 * median distance, 0 beyond trim times. */
double part_weight(const struct part *part, const struct train_conf *conf, double d);

/* Estimates a part's pilot, a robust principal component basis, from m frames x[m][n] of confidence c[m][n]; fills x in. */
void part_pilot(struct part *part, long m, double *x, double *c, const struct train_conf *conf);
void part_free(struct part *part);

/* Buffers of n frames by part: numbers and their confidence ([n][part.n]), distances, shares measured, weights ([n]).
 * frames_free. */
struct frames {
	double *x[TRAIN_PARTS], *c[TRAIN_PARTS], *d[TRAIN_PARTS], *share[TRAIN_PARTS], *w[TRAIN_PARTS];
};
struct frames frames_new(const struct train *t, long n);
void frames_free(struct frames *f);

/* Weighs n filled-in frames (f->w) by their distances, shares and the confidence of the gaze; frame[i]: number of the i-th in the
 * clip. */
void train_weigh(const struct train *t, struct frames *f, long n, const long *frame);

/* Splits n frames as read (train_clip.read) into x[part] and c[part] ([n][part->n] each). Numbers that are NAN or farther out than
 * any picture count as not measured, and so do frames all of whose points lie in one place. */
void train_accept(const struct train *t, long n, const double *lid, const double *skin, const double *seen,
                  double *const x[TRAIN_PARTS], double *const c[TRAIN_PARTS]);

/* Reads n frames from `first` into x[part] and c[part] ([n][part->n] each). Returns false, err set, when they cannot be read. */
bool train_read(struct train *t, long first, long n, double *const x[TRAIN_PARTS], double *const c[TRAIN_PARTS],
                struct err *err);

/* The steps, in the order in which train_run calls them. Those that return false have set err. */
bool train_inputs(struct train *t, struct err *err);   // interpolates gaps; decides which eyes are modelled
bool train_sample(struct train *t, struct err *err);   // draws the sample, estimates the pilots, fills the sample in
bool train_stream(struct train *t, struct err *err);   // sums all frames into the parts' scatters
void train_apertures(struct train *t);                 // g_closed, g_open (eq. 3.6), the baseline A (eq. 3.11)
double train_usual_opening(const struct train *t, int eye);  // median over the clip, px
void train_expressions(struct train *t);               // what lids do with each expression, beyond A
void train_choose_lids(struct train *t);               // called by train_fit: number of components of the lids,
void train_choose_skin(struct train *t);               // and, once the lids are fitted, of the skin
void train_fit(struct train *t);                       // components and regressions
void train_sigmas(struct train *t);                    // standard errors
void train_reach(struct train *t);                     // leverage of the inputs; warns of frames that extrapolate

/* Eigenvalues of n x n moments up to this bound are rounding. With fewer frames than components the directions of such
 * eigenvalues depend on the compiler: they are dropped. */
static inline double train_rounding(int n, double largest)
{
	return 8 * n * DBL_EPSILON * largest;
}

/* Regressors of the sample's frames for that part, [n_sample][q]: an eye's inputs for its lids; lid scores and action units for the
 * skin. Not measured: 0, such frames have weight 0. *q is set; free(). */
double *train_regressors(const struct train *t, int part, int *q);

/* Put a regression into the model: slopes b[rows][q], means mx[q] of the regressors and my[rows] of the scores. train_set_L sets the
 * rows of one eye. */
void train_set_L(struct skin_model *m, int eye, const double *b, const double *mx, const double *my);
void train_set_M(struct skin_model *m, const double *b, const double *mx, const double *my);

/* Appends a line to the report's warnings. */
__attribute__((format(printf, 2, 3)))
void train_warn(struct train *t, const char *fmt, ...);

#endif
