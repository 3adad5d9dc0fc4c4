/* sfm_match: which pictures show the same thing, and which points of them are the same.
 * Descriptors are COLMAP's SIFT: 128 bytes, Euclidean length 512. Nearest neighbours are exact: inner products are whole
 * numbers below 2^24, so that single precision holds them and no order of adding, nor number of threads, changes any.
 */
#ifndef SFM_MATCH_MATCH_H
#define SFM_MATCH_MATCH_H
#include <stdbool.h>
#include <stdint.h>

enum { SIFT_DIM = 128 };

/* What one picture shows. */
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

/* Mutual nearest neighbours that pass both limits (Lowe 2004, section 7.1). free(out->index). */
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

/* Pairs worth comparing: pair[] sorted by (a, b), *n of them; free(). Only pairs with one picture at or behind
 * `first_new` are looked at: 0 for all. Small sets (n_pictures <= always + 1) keep every pair. */
struct sfm_pair *sfm_overlap(int *n, int n_pictures, const struct sfm_features f[], int first_new,
                             const struct sfm_overlap_conf *conf);

/* True when the order of the pictures is the order they were taken in: most overlap with the one before more than with the
 * typical picture. pairs: from sfm_overlap with first_new 0. */
bool sfm_is_sequence(int n_pictures, const struct sfm_pair pairs[], int n_pairs);

#endif
