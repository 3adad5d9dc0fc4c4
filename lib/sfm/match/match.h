/* sfm_match: which pictures overlap, and which of their SIFT features correspond.
 * Descriptors are COLMAP's: 128 bytes, Euclidean length 512. Nearest neighbours are exact: inner products are whole numbers
 * below 2^24, which single precision holds exactly, so that neither the order of the sums nor the number of threads matters.
 */
#ifndef SFM_MATCH_MATCH_H
#define SFM_MATCH_MATCH_H
#include <stdbool.h>
#include <stdint.h>

enum { SIFT_DIM = 128 };

/* The features of one picture. */
struct sfm_features {
	int n;
	uint8_t (*descriptors)[SIFT_DIM];  // owned
	float *scale;                      // px; owned
};

void sfm_features_free(struct sfm_features *f);

struct sfm_match_conf {
	double max_ratio;     // angle to the nearest over angle to the second nearest
	double max_distance;  // angle to the nearest, radians
};

struct sfm_matches {
	int n;
	uint32_t (*index)[2];  // rows of the first and of the second picture, sorted by the first; owned
};

/* Matches features that are each other's nearest neighbours and pass both limits, the ratio test among them (Lowe 2004,
 * section 7.1). free(out->index). */
void sfm_match(struct sfm_matches *out, const struct sfm_features *a, const struct sfm_features *b,
               const struct sfm_match_conf *conf);

struct sfm_overlap_conf {
	int strongest;        // features of a picture that are compared: those of the largest scale
	int min_matches;      // matches among them that make a pair worth a full comparison
	int always;           // the best pairs of each picture that are kept whatever their number
	int neighbours;       // pictures before and after in the order given that are kept; 0: the order says nothing
	struct sfm_match_conf match;
};

struct sfm_pair {
	int a, b;  // a < b
	int score; // matches among the strongest
};

/* Selects the pairs worth a full comparison: those with enough matches among the strongest features, and each picture's best.
 * n          out: pairs
 * first_new  only pairs with one picture at or behind it are considered; 0: all
 * Returns the pairs, sorted by (a, b); free(). Small sets (n_pictures <= always + 1) keep every pair. */
struct sfm_pair *sfm_overlap(int *n, int n_pictures, const struct sfm_features f[], int first_new,
                             const struct sfm_overlap_conf *conf);

/* True when the pictures stand in the order in which they were taken: at least 80 % of them have at most two neighbours closer than
 * the one before. pairs: of sfm_overlap with first_new 0. */
bool sfm_is_sequence(int n_pictures, const struct sfm_pair pairs[], int n_pairs);

#endif
