/* subject: the person's mesh and the eyes in it.
 * Head frame: the mesh's axes (x to the person's left, y up, z out of the face), mm.
 */
#ifndef TRACK_CLIP_SUBJECT_H
#define TRACK_CLIP_SUBJECT_H
#include "base/stage.h"
#include "mesh/mesh.h"
#include "track/clip/conf.h"
#include "track/head/shade.h"

enum { MARK_INNER, MARK_OUTER, MARK_UPPER, MARK_LOWER, MARKS };

struct track_subject {
	struct mesh mesh;      // mm
	const char *file;      // relative to the capture; static text; null without a mesh
	double unit_mm;        // of the file
	int mark[SIDES][MARKS];          // rows of the mesh; -1: not known
	double center[SIDES][3], radius; // eyeballs; NAN where not known
	bool center_given[SIDES];        // by capture.conf: not estimated
	double limbus[SIDES];            // mm, seen in the clip where there is no mesh; 0: not known
	double center_sigma[SIDES];      // mm, of centres from the mesh's rims or the lids' marks; 0: the settings'
	struct eye_opening opening[SIDES];
	bool margin_seen[SIDES];           // it lies where the reference frame shows it (canthi.h); else it is a neutral face's
	struct eye_opening margin[SIDES];  // inner edge of the lids' margins: outline at the eyeball's radius plus meniscus_mm
	struct head_shape *shape;          // the mesh as it is shaded; null: not looked at; owned
	bool assumed;          // no mesh: eyes, openings and skin of an average face; file is null
};

/* Loads subject.ply, subject.obj or work/subject.ply, whichever is first, and finds its eyes: their centres from capture.conf,
 * work/rig.json or the marked lids; their openings from the mesh, the marks or an average face. Without a mesh, the eyes of an
 * average face. subject: overwritten; track_subject_free in any case.
 * Returns false, err set, when the mesh or rig cannot be read, a mark is no row of the mesh, or no eye is found. */
bool track_subject_load(struct track_subject *subject, struct stage *stage, const struct track_conf *conf, struct err *err);
void track_subject_free(struct track_subject *subject);

/* How far the eyes are in front of the camera, mm: mean of the lids' openings, or of the eyeballs' centres where the mesh has none. A millimetre of skin or lid is focal_px
 * over it in the picture; the depth of the mesh's origin, which may lie anywhere, tells nothing of that. */
double track_eyes_depth(const double cam_from_head[4][4], const struct track_subject *subject);

/* The middle between the corners of both eyes, head frame, mm; both openings must be known. */
void track_eyes_between(double at[3], const struct track_subject *subject);

/* Middles between the corners of both eyes in the picture, px. False where an opening is not known, or lies behind the camera. */
bool track_eyes_middle(double px[SIDES][2], const struct camera *camera, const double cam_from_head[4][4], const struct track_subject *subject);

/* True where skin moves with the eyelids: within 1.4 eyeball radii of a centre, in x and y. head: mm. */
bool track_on_lid(const double head[3], const struct track_subject *subject);

#endif
