/* strip: the surroundings of an ellipse unrolled, and what a small convolutional network (config/strip.onnx; tests/evidence/README.md) says of
 * where the limbus crosses each ray from the centre: the likelihood of an ellipse given the photograph.
 * A ray j runs from the centre c along S u(phi), phi = 2 pi j / STRIP_RAYS from +x towards +y, S as in math/ellipse.h; a place on it is s: 0 the
 * centre, 1 the ellipse. Row i is s = STRIP_FROM + (i + 0.5) STRIP_STEP.
 */
#ifndef LIMBUS_STRIP_H
#define LIMBUS_STRIP_H
#include "limbus/evidence.h"
#include "limbus/region.h"
#include "math/ellipse_fit.h"

enum { STRIP_ROWS = 64, STRIP_RAYS = 128, STRIP_PLANES = 8, STRIP_PIXELS = STRIP_ROWS * STRIP_RAYS };
#define STRIP_FROM 0.6
#define STRIP_STEP 0.0125

/* Samples a strip: encoded red, green, blue, 0..1; chances of iris or pupil, sclera, lash, reflection; 1 inside of the photograph. */
void strip_sample(float out[STRIP_PLANES][STRIP_ROWS][STRIP_RAYS], const struct photo *photo, const struct evidence *evidence,
                  const struct ellipse *e);

/* Place of a ray, px of the photograph. */
void strip_place(double p[2], const struct ellipse *e, int ray, double s);

/* Where the ray leaves another ellipse; NAN where it misses it. */
double strip_crossing(const struct ellipse *e, int ray, const struct ellipse *other);

struct strip_conf {
	double rays, hidden, pixels;  // how far neighbours err together: so many rays on which the limbus is seen, or hidden, and pixels of the evidence count as one
	double least;                 // chance that a ray tells nothing
	double seen;                  // chance of being seen near the ellipse from which a ray has a place
	double noise;                 // of that place, rows
	double near;                  // rows round the ellipse in which it is looked for
	double reach[2];              // how far an ellipse may lie from the strip's own: logarithm of the size, centre in semi-axes
	double start_sigma[2];        // of the start, semi-axes: centre and size, shape
};

/* What the network says round an ellipse: of each ray the chances of the rows in which the limbus crosses it, seen or hidden by a lid, and the
 * chance that it is seen there, iris against sclera. */
struct strip {
	struct ellipse e;
	struct strip_conf conf;
	float row[STRIP_ROWS][STRIP_RAYS], seen[STRIP_RAYS];
};

/* Log likelihood of an ellipse over that of one that may be anywhere, nats: rays err together, hidden ones still more. */
double strip_worth(const struct strip *strip, const struct ellipse *e);

/* The likeliest ellipse of a strip and of the pixels' evidence (region_worth).
 * e      in: start; out
 * fit    out: covariance, of the rays' places and of an ellipse known to so many sigmas besides
 * sigma  of what the pixels tell, px, as math/ellipse.h's q
 * False where no ray is seen near it. */
bool strip_fit(struct ellipse *e, struct ellipse_fit *fit, const struct strip *strip, const struct region_map *map, const double sigma[ELLIPSE_N]);

/* How what is seen agrees with an ellipse. */
struct strip_accord {
	double seen;     // share of the rays where the limbus is seen
	double on;       // of what is seen, the share within 2.5 % of the ellipse
	double off;      // the share farther than 5 % off
	double worth;    // strip_worth
	double scatter;  // of the likeliest places near the ellipse, semi-axes, weighted by their chances
	double end;      // chance that the limbus is seen, of the better end of the diameter where that is least
};
struct strip_accord strip_accord_of(const struct strip *strip, const struct ellipse *e);

/* The chance that the limbus is seen, by the direction from the centre, squared, as an absolute tint of a rim: an arc beside a lid spoils more
 * than it adds. grey_free. */
struct grey strip_seen(const struct strip *strip);

#endif
