/* mc_iris: a Monte Carlo iris of known pigment (shared data, iris_mc): its truth, a capture made of it, and how far what the programs
 * make of that is from the truth. Frames and units as in lib/README.md.
 */
#ifndef TESTS_MC_IRIS_H
#define TESTS_MC_IRIS_H
#include "image/image.h"
#include "optics/cornea/cornea.h"

enum mc_picture { MC_OWN, MC_RELIT, MC_TURNED, MC_PICTURES };
enum mc_number { MC_ABL_MELANIN, MC_ABL_RATIO, MC_STROMA_MELANIN, MC_STROMA_RATIO, MC_SCALE, MC_NUMBERS };

struct mc_iris {
	const char *from;                 // folder of the data
	int width, height;
	double focal_px, pose[MC_PICTURES][4][4], depth;
	struct cornea cornea;
	double truth[MC_NUMBERS];
	struct image picture[MC_PICTURES];  // linear, iris only counts
	struct image thickness;           // mm, one channel
	double half_width;                // of it, mm
};

/* from: outlives the iris. mc_iris_free in any case. */
bool mc_iris_load(struct mc_iris *iris, const char *from, struct err *err);
void mc_iris_free(struct mc_iris *iris);

struct mc_case {
	bool told;                        // light.environment is given
	const char *more;                 // further lines of capture.conf, or null
};

struct mc_score {
	double value[MC_NUMBERS], sigma[MC_NUMBERS];  // sigma: of the logarithm, of ratios absolute
	double shown[MC_PICTURES], bare[MC_PICTURES]; // mean CIEDE2000: as shipped, and with render.detail = 0
	double amplitude, correlation;    // of the thickness between Gaussians of 0.12 and 0.6 mm: rms over the truth's
	double whole_correlation;         // of the thickness without its mean over each radius
	double seconds;                   // of the chain, without its second rendering
};

/* Makes a capture of the iris at `dir` (must not exist). */
bool mc_iris_capture(const struct mc_iris *iris, const char *dir, const struct mc_case *how, struct err *err);

/* rms difference of a map of thickness (its channel of that name) from the truth between Gaussians of 0.12 and 0.6 mm, mm, in 2.3 mm < r < 5.3 mm;
 * NAN, said, where it cannot be read. */
double mc_iris_detail_off(const struct mc_iris *iris, const char *path, const char *channel);

/* Makes a capture of the iris at `dir` (must not exist), runs make on it, and scores what came out. make's output goes to dir.log. */
bool mc_iris_score(struct mc_score *score, const struct mc_iris *iris, const char *dir, const struct mc_case *how, struct err *err);

/* Mean CIEDE2000 in 2.3 mm < r < 5.3 mm of the iris plane, both smoothed by 0.1 mm, of a picture (3 or 4 channels) of that pose. */
double mc_iris_difference(const struct mc_iris *iris, enum mc_picture which, const struct image *got);

#endif
