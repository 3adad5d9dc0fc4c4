/* What the files of the ray caster share. Head frame: origin at the eyeball's centre, u to the right of who looks at the face, v up, w out
 * of the face, mm. */
#ifndef TESTS_CAST_IMPL_H
#define TESTS_CAST_IMPL_H
#include <math.h>

#include "tests/lib/cast/cast.h"

struct vec { double x, y, z; };

static inline struct vec vec(double x, double y, double z) { return (struct vec){ x, y, z }; }
static inline struct vec add(struct vec a, double s, struct vec b) { return vec(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z); }
static inline struct vec scaled(struct vec a, double s) { return vec(s * a.x, s * a.y, s * a.z); }
static inline double dot(struct vec a, struct vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline struct vec unit(struct vec a) { return scaled(a, 1 / sqrt(dot(a, a))); }
static inline struct vec cross(struct vec a, struct vec b) { return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static inline double clamp(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }
static inline double blend(double lo, double hi, double x) { const double t = clamp((x - lo) / (hi - lo), 0, 1); return t * t * (3 - 2 * t); }
static inline double bump(double x) { return exp(-x * x); }

/* Smooth random function of the plane, -1 .. 1, and sums of it over `octaves`. */
double cast_noise(double x, double y, uint32_t seed);
double cast_cloud(double x, double y, uint32_t seed, int octaves);

enum { LAMPS = 3 };
struct cast_room {
	struct lamp { struct vec to, side, up; double half[2], bright, rgb[3]; int panes; } lamp[LAMPS];  // to: unit, towards it
	int lamps;
	double ambient[3], floor, wall, skyline;
	uint32_t seed;
};

struct cast_lids {
	double inner[2], outer[2];          // angles of the corners from the ball's centre: azimuth, elevation; radians
	double rise[2], skew[2], full[2];   // upper, lower: height over the line between the corners, where it is highest, how round
	double shell;                       // radius of the lids' outer surface
	double crease, crease_deep, bag, brow, nose, depth, puff;
};

struct cast_eye {
	double limbus, aspect, sclera, cornea, p, depth, pupil, pupil_at[2], pupil_squash, ramp;  // mm
	double limbus_at;                   // depth of its plane behind the apex
	struct vec x, y, axis;              // head frame; axis: out of the eye
	struct vec apex;
	double base[3], tint[3], root_dark, collar, fibre, crypt, white[3], vessels, haze;
	uint32_t seed;
};

struct cast_skin { double rgb[3], oil, pores, wrinkle, spots, red; uint32_t seed; };

struct cast {
	const struct cast_frame *frame;
	struct cast_room room;
	struct cast_lids lids;
	struct cast_eye eye;
	struct cast_skin skin;
	double focal, mid[2];
	struct vec camera, look[3];         // in the head frame: the camera's place, its axes x, y, z
	float *hair;                        // [height][width], cover
	double hair_rgb[3];
};

/* Point of the head frame in px. */
void cast_project(double px[2], const struct cast *c, struct vec p);
struct vec cast_ray(const struct cast *c, double x, double y);

/* Light on a surface of normal n, and what a mirror shows in direction d. lit: share of the first lamp that arrives. */
void cast_light(double out[3], const struct cast_room *room, struct vec n, double lit);
void cast_mirror(double out[3], const struct cast_room *room, struct vec d);
void cast_lamps(struct cast_room *room, struct rng *rng);

/* Elevations of the lids' margins above an azimuth, radians; above the inner or beyond the outer corner they meet. */
void cast_margins(double at[2], const struct cast_lids *l, double azimuth);
/* How far p's direction from the ball's centre lies inside the opening, radians; negative: behind a lid. */
double cast_inside(const struct cast_lids *l, struct vec p);
/* First hit of a ray with the skin's relief. */
struct vec cast_relief(const struct cast *c, struct vec d);
void cast_skin(double out[3], const struct cast *c, struct vec p, struct vec d);

enum cast_hit { CAST_SKIN, CAST_RIM, CAST_SCLERA, CAST_IRIS };
struct cast_seen { double mirrored, inside; };  // share that is reflection; cast_inside of where the lids' surface is met
/* What the ray from the camera in direction d (unit) shows. */
enum cast_hit cast_trace(double out[3], struct cast_seen *seen, const struct cast *c, struct vec d);
/* Whether the ray from the camera in direction d would meet the pupil, were there no lids. */
bool cast_meets_pupil(const struct cast *c, struct vec d);
void cast_eye_make(struct cast_eye *eye, struct rng *rng);

/* A cat's or a goat's instead: no white shows. */
void cast_eye_of_animal(struct cast_eye *eye, struct rng *rng);

void cast_hairs(struct cast *c, struct rng *rng);

/* Linear to bytes: white balance, lens, noise, tone, JPEG. Returns red over blue of white in the picture. */
double cast_film(uint8_t *rgb, float *linear, int width, int height, const double white[3], struct rng *rng);

#endif
