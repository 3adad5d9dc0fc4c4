/* fellow: what the two eyes of a face tell of each other's tilt. They look the same way: up and down alike, aside but for how far off they look and for
 * the angle between optical axis and sight. The shape of a limbus has two poses, one to either side, and hardly tells a small tilt; two shapes together
 * tell more of both.
 */
#ifndef LIMBUS_FELLOW_H
#define LIMBUS_FELLOW_H
#include "limbus/opening.h"

/* How far the optical axes of a person's eyes are from being parallel, rad. */
struct fellow_conf {
	double apart, apart_sigma;  // in the plane of both eyes: mean, positive where they diverge, and standard deviation; sigma > 0
	double level_sigma;         // out of that plane
	double squint;              // chance that they have nothing to do with each other: a squint, an eye of glass
};

/* What the picture of one eye tells of its tilt, alone. A tilt is the vector, as long as the tilt, from the optical axis to the direction of the camera, in the picture's
 * x and y. */
struct fellow_tilt {
	double seen, towards;   // length, > 0, and direction of the likelier pose's, rad; the other pose's lies opposite
	double margin;          // log odds of the likelier pose, by its shape and its own light
	double cov[2][2];       // rad^4: of the vector of the tilt's square and twice its direction, without the aspect's share
	double shift[2];        // rad^2: of that vector, by one sigma of the limbus's aspect, which both eyes share
	double reach[2], level; // opening.h; rad, of what is level in the picture
	double radius;          // mm, of the limbus
	double prior;           // rad: standard deviation of tilts, each way, before anything is seen; 0: all are as likely
	double place[3];        // mm: the limbus in the camera's frame
};

/* The tilt of an eye, the other being known. */
struct fellow_said {
	double hill[2], all[2];      // rad: mean of the side that is likelier now, of both sides
	double hill_sigma, all_sigma;  // rad: root mean square of what tilts along the mean are off by it
	double margin;                 // log odds of that side
	bool turned;                   // that is the other pose's
	bool resolved;                 // false: this eye's own picture tells its tilt more finely than was looked at; its side alone counts
};

/* Sums over all tilts of both eyes. False: the eyes lie in one place, or none of their tilts goes with the other's. */
bool fellow_tilt_of(struct fellow_said *said, const struct fellow_tilt *eye, const struct fellow_tilt *other, const struct fellow_conf *conf,
                    const struct opening_conf *opening);

#endif
