/* rigid: the head's pose in a reference frame, from how the skin moves in others: the points seen there lie on the mesh, and move with it as with a
 * rigid body. What is out of place on the mesh has the wrong depth, and moves otherwise (bundle adjustment whose points are tied to a surface).
 * Head frame  the mesh's axes, mm.  Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_HEAD_RIGID_H
#define TRACK_HEAD_RIGID_H
#include "mesh/mesh.h"
#include "mesh/ray.h"
#include "track/head/pose.h"

/* Points of skin over frames. */
struct rigid_film {
	int points, frames;
	const double (*at)[2];   // [points] px in the reference
	const double *weight;    // [points] 1 / variance, px^-2: how rigid that skin is
	const float (*px)[2];    // [frames][points]
	const float *seen;       // [frames][points] confidence, 0..1; what turns away in a frame is left out
};

/* Two points of the head and where they lie in the reference, roughly: the eyes. */
struct rigid_anchor {
	double head[3], px[2], sigma_px;
};

/* A frame of the film whose pose enough points tell. */
struct rigid_known {
	int frame;
	double cam_from_head[4][4];
};
enum { RIGID_KNOWN = 64 };   // of a film's frames, spread over it

struct rigid_fit {
	double off_px;           // rms of the points, weighted
	double sigma[6];         // standard deviations of the pose, as head_prior's: rotations (radians), shifts (mm)
	int n_known;             // frames whose pose is told; in the others too few of the points are in sight
	struct rigid_known known[RIGID_KNOWN];
	double turned;           // radians: the largest turn between two of those
	int used;                // measurements
	double apart;            // radians: between the poses that the left and the right half of the points tell
};

/* Estimates cam_from_head, from many starts within reach[2] (radians, of yaw and pitch) of where it is. robust: px, scale of Geman-McClure's weights.
 * Returns false, nothing changed, where the points do not tell. */
bool rigid_fit(double cam_from_head[4][4], struct rigid_fit *fit, const struct rigid_film *film, const struct mesh *mesh, const struct camera *camera,
               int anchors, const struct rigid_anchor *anchor, const double reach[2], double robust);

#endif
