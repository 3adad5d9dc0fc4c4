/* train_impl: what the pieces of train share. */
#ifndef MODEL_TRAIN_IMPL_H
#define MODEL_TRAIN_IMPL_H
#include <float.h>

#include "math/scatter/scatter.h"
#include "model/train/train.h"

enum { PILOT_FRAMES = 512, PILOT_COMPONENTS = 20, EYE_INPUTS = 5 };

#define TRAIN_LEAST_SHARE 0.3  // of a frame's numbers must be measured for it to count

/* The lids of one eye, or the skin. */
struct part {
	int n, kept;         // coordinates; components of the model
	bool used;
	bool *seen;          // [n] measured often enough
	int k;               // components of the pilot
	double *mean, *V;    // [n], [n][k] of the pilot
	double *variance;    // [PILOT_COMPONENTS] px^2 along them
	double usual;        // px: median distance of a frame from the pilot's components
	struct scatter sum;  // lids: [5 inputs | n]; skin: [both eyes' lids | action units | n]
	int from;            // column of sum where the coordinates begin
	double *x, *w;       // [n_sample][n], [n_sample] of the sample, completed
	int k_max;           // components of the whole clip in V_all
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
	double *g;           // [n][n_inputs], gaps carried over; still NAN where that is not possible
	bool eye[2];         // inputs and lids of that eye are there
	struct part part[TRAIN_PARTS];
	struct scatter inputs;  // [n_inputs] of the frames that the skin is learnt from
	int n_lid, n_eye;    // coordinates of all lids, of one eye's
	long n_sample, *sample;  // frames of the sample
	int n_blocks, *block;    // time block of each sample frame; -1: in the gap between two
};

/* Rows x[n][part->n] with c[n][part->n] in 0..1 (how far each number is to be believed; 0 or NAN: not measured) are
 * filled in from the part's pilot; what is half believed is drawn half towards it.
 * d[n]: distance of each row from the pilot, px; share[n]: of its numbers measured. */
void part_complete(struct part *part, long n, double *x, const double *c, double *d, double *share);

/* The same for a few rows, on the calling thread. */
void part_complete_few(const struct part *part, int n, double *x, const double *c, double *d, double *share);

/* The robust weight of a row of that distance: Huber's for scatter. */
double part_weight(const struct part *part, const struct train_conf *conf, double d);

/* The pilot of a part from m rows x[m][n], c[m][n]; x is filled in. */
void part_pilot(struct part *part, long m, double *x, double *c, const struct train_conf *conf);
void part_free(struct part *part);

/* Buffers of n frames by part: numbers, how far to believe them ([n][part.n]), distances, shares measured, weights. */
struct frames {
	double *x[TRAIN_PARTS], *c[TRAIN_PARTS], *d[TRAIN_PARTS], *share[TRAIN_PARTS], *w[TRAIN_PARTS];
};
struct frames frames_new(const struct train *t, long n);
void frames_free(struct frames *f);

/* Weights of n completed frames; frame[i]: number of the i-th in the clip. */
void train_weigh(const struct train *t, struct frames *f, long n, const long *frame);

/* n rows as read into x[part] and c[part]: numbers that are none, or lie outside any picture, are not measured. */
void train_accept(const struct train *t, long n, const double *lid, const double *skin, const double *seen,
                  double *const x[TRAIN_PARTS], double *const c[TRAIN_PARTS]);

/* n frames from `first` into x[part] and c[part] ([n][part->n] each). */
bool train_read(struct train *t, long first, long n, double *const x[TRAIN_PARTS], double *const c[TRAIN_PARTS],
                struct err *err);

bool train_inputs(struct train *t, struct err *err);   // gaps, which eyes there are, apertures, baseline
void train_apertures(struct train *t);
bool train_sample(struct train *t, struct err *err);
bool train_stream(struct train *t, struct err *err);
void train_choose_lids(struct train *t);               // how many components are kept, of those of the configuration
void train_choose_skin(struct train *t);               // the same, once the lids are fitted
void train_fit(struct train *t);
void train_sigmas(struct train *t);

void train_reach(struct train *t);                     // what lids and skin were learnt from; frames outside of it are told

/* Eigenvalues of n x n moments that are no larger are rounding: fewer frames than components have directions beside them, and
 * which is any compiler's choice. */
static inline double train_rounding(int n, double largest)
{
	return 8 * n * DBL_EPSILON * largest;
}

/* Regressors of the sample's frames for that part: [n_sample][q], rows with a NAN have weight 0 in w. *q set; free(). */
double *train_regressors(const struct train *t, int part, int *q);

/* The regressions into the model: slopes b[rows][q], means of regressors and of scores. L takes the rows of one eye. */
void train_set_L(struct skin_model *m, int eye, const double *b, const double *mx, const double *my);
void train_set_M(struct skin_model *m, const double *b, const double *mx, const double *my);

__attribute__((format(printf, 2, 3)))
void train_warn(struct train *t, const char *fmt, ...);

#endif
