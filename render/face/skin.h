/* skin: pictures, clips and glTF of driven characters: of every rig that extrapolate has made. */
#ifndef RENDER_FACE_SKIN_H
#define RENDER_FACE_SKIN_H
#include "image/video/video.h"
#include "render/export/export.h"
#include "render/render.h"
#include "rig/drive.h"
#include "rig/glb/glb.h"
#include "draw/face/portrait.h"

/* Where the skin of a character without textures comes from. */
enum skin_source { SKIN_AUTO, SKIN_VIDEO, SKIN_VIEWS, SKIN_PLAIN };
extern const char *const skin_sources[];

/* Where the iris of a person whom nobody photographed comes from. */
enum iris_source { IRIS_AUTO, IRIS_VIDEO, IRIS_PLAIN };
extern const char *const iris_sources[];

/* Whose lashes and brows it has. */
enum hair_source { HAIR_AUTO, HAIR_AVERAGE };
extern const char *const hair_sources[];

struct skin_conf {
	struct portrait_conf portrait;
	double gaze[2], aperture;            // typed by the user: degrees; times what the eye is open at that gaze
	double sheet_deg[2];                 // the gaze sheet goes so far to both sides, up and down
	double field;                        // what both eyes' pictures show, times the distance of the eyes
	int look_px, cell_px, blink_frames;  // the typed gaze; a cell of sheet and strip
	int clip_px, clip_samples;           // width of the driven face in the clip; 0: no clip
	double clip_fps, clip_crf, clip_seconds;
	struct glb_conf glb;
	double iris_rgb[3];                  // of an invented eye, linear
	int iris;                            // enum iris_source
	int texture_px;
	int hair;                            // enum hair_source
	int source, film_px;                 // enum skin_source; px of the textures made of the film
	struct video_conf video;
};

#define SKIN_OPTS(c) \
	OPT_REALS("gaze", (c)->gaze, 2, -60, 60, "deg", "where NAME_look.png looks: horizontal (+: person's left), vertical (+: up)"), \
	OPT_REAL("aperture", &(c)->aperture, 0, 2, "", "how far its eyes are open: 0 closed, 1 as people do at that gaze"), \
	OPT_REALS("sheet_deg", (c)->sheet_deg, 2, 1, 45, "deg", "the gaze sheet goes so far to the sides, and up and down"), \
	OPT_REAL("face_field", &(c)->field, 1, 6, "", "width of a picture of both eyes, in distances between them"), \
	OPT_INT("look_px", &(c)->look_px, 64, 8192, "px", "width of NAME_look.png"), \
	OPT_INT("cell_px", &(c)->cell_px, 64, 4096, "px", "width of a cell of the gaze sheet and the blink strip"), \
	OPT_INT("blink_frames", &(c)->blink_frames, 3, 31, "", "cells of the blink strip"), \
	OPT_INT("clip_px", &(c)->clip_px, 0, 4096, "px", "width of the driven face in the clips; 0: no clips"), \
	OPT_INT("clip_samples", &(c)->clip_samples, 1, 8, "", "rays across a pixel of the clips where it shows more than one thing"), \
	OPT_REAL("clip_fps", &(c)->clip_fps, 1, 240, "1/s", "frames a second of the clips, at most"), \
	OPT_REAL("clip_crf", &(c)->clip_crf, 0, 51, "", "quality of the clips: 0 lossless, 51 worst"), \
	OPT_REAL("clip_seconds", &(c)->clip_seconds, 0, 1e5, "s", "of a clip, at most"), \
	OPT_INT("skin_lights", &(c)->portrait.lights, 1, 64, "", "directions that stand for the environment on skin; a power of 2"), \
	OPT_INT("skin_subdivide", &(c)->portrait.subdivide, 0, 4, "", "times the triangles round the eyes are cut in four"), \
	OPT_INT("skin_samples", &(c)->portrait.samples, 1, 8, "", "rays across a pixel of skin where it shows more than one thing"), \
	OPT_CHOICE("skin", &(c)->source, skin_sources, "of a character without textures: the person's in the video where that shows it, else in views/, or of one colour"), \
	OPT_INT("skin_px", &(c)->film_px, 128, 8192, "px", "width of the textures that are made of the video or the views"), \
	OPT_REALS("skin_rgb", (c)->portrait.skin_rgb, 3, 0, 1, "", "colour of the skin"), \
	OPT_REAL("skin_texture", &(c)->portrait.texture, 0, 3, "", "strength of pores and blotches"), \
	OPT_REAL("skin_scatter_mm", &(c)->portrait.scatter_mm, 0, 20, "mm", "how far red light travels in skin"), \
	OPT_REAL("tear_mm", &(c)->portrait.tear_mm, 0, 3, "mm", "height of the tear line along the lids; 0: none"), \
	OPT_REALS("tear_absorb", (c)->portrait.tear_absorb, 3, 0, 10, "1/mm", "what tear fluid absorbs of red, green and blue"), \
	OPT_REAL("caruncle_wet", &(c)->portrait.caruncle_wet, 0, 1, "", "how moist and red the inner corners of the eyes are"), \
	OPT_CHOICE("hair", &(c)->hair, hair_sources, "lashes and brows: with the person's skin those that the video shows, or an average adult's"), \
	OPT_REAL("lash_mm", &(c)->portrait.hair.lash_mm, 0, 30, "mm", "length of the longest lashes on an eye of 12 mm; 0: none"), \
	OPT_INT("lashes", &(c)->portrait.hair.lashes, 0, 1000, "", "on an upper lid; the lower has three fifths"), \
	OPT_REAL("lid_margin_mm", &(c)->portrait.hair.margin_mm, 0, 5, "mm", "breadth of a lid's margin, on whose outer edge lashes grow"), \
	OPT_REAL("brow_mm", &(c)->portrait.hair.brow_mm, 0, 30, "mm", "length of the longest hairs of brows on an eye of 12 mm; 0: none"), \
	OPT_INT("brow_hairs", &(c)->portrait.hair.brow_hairs, 0, 5000, "", "of one brow"), \
	OPT_REALS("hair_rgb", (c)->portrait.hair_rgb, 3, 0, 1, "", "colour of lashes and brows"), \
	OPT_INT("skin_texture_px", &(c)->texture_px, 16, 16384, "px", "longest side at which a character's own textures are drawn"), \
	OPT_CHOICE("iris", &(c)->iris, iris_sources, "where no photograph was fitted: the person's in the video where that shows it, or drawn"), \
	OPT_REALS("iris_rgb", (c)->iris_rgb, 3, 0, 1, "", "colour of the iris where neither a photograph nor the video gives it"), \
	OPT_INT("glb_targets", &(c)->glb.targets, 1, 200, "", "morph targets of the animation, at most"), \
	OPT_REAL("glb_tolerance_mm", &(c)->glb.tolerance, 0, 10, "mm", "no more targets than it takes to keep every vertex so close"), \
	OPT_BOOL("glb_poses", &(c)->glb.poses, "named targets, too: eyeBlinkLeft, eyeLookUpRight ..."), \
	VIDEO_OPTS(&(c)->video)

/* All characters of one capture share the eyes and the light. */
struct skin_job {
	struct stage *stage;
	const struct render_conf *render;
	const struct skin_conf *conf;
	const struct export_conf *leaves; // of the eyes in NAME.glb
	const struct capture *capture;
	const struct eye *eye;
	struct jobs *photographed;        // eyes that photographs were fitted to
	const char *video;                // the input video, relative to the folder; null: none
	// Made by skin_ready, when the first picture needs them:
	bool ready;
	struct scene plain;               // an invented eye, or the film's, for a side that no photograph was fitted to
	struct err iris_told;             // a sentence: where its iris comes from; empty: a photograph's
	const struct scene *eyes[2];      // left, right
	struct envmap studio;
	struct skin_model model;
	struct wrinkle_maps wrinkles;
	double gain;
	char *eye_glb[2];                 // made by skin_eyes; the same for both, where both eyes are
	size_t eye_size[2];
	struct skin_worn {                // what skin_of_film made for a character, kept for the page, which shows it again
		char *name;                   // null: nothing
		struct look look;
		double rgb[3];
		struct hair_film *hair;
		float (*place)[3];
	} worn;
};

/* render/show.c: makes the contact sheets and the two pages. drawn: all pictures are there; false: only the review page is made. */
bool show(struct skin_job *faces, bool drawn, struct err *err);

/* One character. */
struct skin_target {
	const char *name, *rig_path;      // rig_path relative to the folder
	struct rig rig;
	const char *look_path;            // of its own look; null: none
	struct look look;
	struct dress *dress;              // its textures, with the portrait; null: none
	struct portrait *portrait;        // of the stills; null until needed
	const char *film, *subject;       // the video and the mesh that its skin is made of; null: of neither
	int views;                        // photographs of views/ that it may be made of, or is where there is no video; 0: none
	double film_rgb[3];               // its median albedo then, or of the views
	struct hair_film *film_hair;      // lashes and brows that it shows; null: average ones
	float (*film_place)[3];           // [own vertices] where the character's skin lies on the person, mm
	struct skin_told {                // where its skin comes from
		const char *from;             // "own", "video", "views", "one colour": plan/skin.h
		struct err why;               // a sentence
		double seen, mirrored;        // of "video" and "views": shares of the face near the eyes that they show, and its other half stands in for
	} told;
	const char *in[64];               // inputs that all its pictures have in common
	int n_in;
};

/* The portrait that a character is drawn with. After skin_open. */
struct portrait_conf skin_portrait(const struct skin_job *job, const struct skin_target *target);

/* Makes everything of every character that is not fresh. A capture without rigs is no error. */
bool render_skin(struct skin_job *job, struct err *err);

/* skin_keep.c: render.gaze and render.aperture matter for NAME_look.png alone: all else is kept when only they change.
 * skin_kept: stage_fresh, or made by the same program from the same bytes with a configuration that differs in gaze and aperture at
 * most; then it is recorded again. skin_made: stage_made, and stores the hash by which skin_kept decides. */
bool skin_kept(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err);
bool skin_made(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err);

/* Frees what the job has made, but not photographed. */
void skin_close(struct skin_job *job);

/* skin_open.c: loads eyes, light and the model, once. */
bool skin_ready(struct skin_job *job, struct err *err);

/* skin_pictures.c: NAME_look.png, NAME_sheet.png, NAME_blink.png, NAME_expressions.png. */
bool skin_pictures(struct skin_job *job, struct skin_target *target, struct err *err);

/* skin_clip.c: NAME_clip.mp4 (the input video and the character beside it), NAME_script.mp4 (animation.csv). */
bool skin_clips(struct skin_job *job, struct skin_target *target, struct err *err);

/* skin_glb.c: NAME.glb, driven by csv, with the eyes that its pictures show. */
bool skin_glb(struct skin_job *job, struct skin_target *target, const char *csv, struct err *err);

/* skin_film.c. skin_film: finds what a character without a look can be given the skin of the person from, the film or views/, and puts it into its inputs.
 * skin_of_film: makes look and dress of the film, or where that does not give it of the views; where it cannot be, says so and leaves them empty. Returns false, err set, where render.skin asks
 * for it all the same. */
void skin_film(struct skin_target *target, struct stage *stage, const struct skin_conf *conf);
bool skin_of_film(struct skin_job *job, struct skin_target *target, struct err *err);

/* skin_film.c: whether a file that another one names is in the capture, and there. */
bool skin_is_inside(struct stage *stage, const char *rel);

/* skin_iris.c. skin_iris: finds the film of a person whom nobody photographed, and puts what the irises are made of into a character's inputs.
 * skin_iris_of_film: makes them. seen: overwritten where *found, scene_seen_free. job->iris_told says of what it is made. Returns false, err set, where render.iris asks
 * for it all the same. */
struct scene_seen;
void skin_iris(struct skin_target *target, struct skin_job *job);
bool skin_iris_of_film(struct scene_seen *seen, bool *found, struct skin_job *job, struct err *err);

/* Writes work/render/NAME_skin.json: where its skin comes from, and why, for the page. */
bool skin_told_save(struct skin_job *job, struct skin_target *target, struct err *err);

/* Hands the look that skin_of_film made to the job, unless it has one: skin_of_film gives it to the next target of that name. Portrait and dress, which use it, are freed. */
void skin_film_keep(struct skin_job *job, struct skin_target *target);

/* skin_open.c: loads the rig and makes the portrait, once; skin_free. */
bool skin_open(struct skin_job *job, struct skin_target *target, struct err *err);
void skin_free(struct skin_target *target);

/* skin_socket.c: a sentence where a fitted eye differs from the character's eyeballs, of these radii in mm (left, right), by more than conf's
 * socket_share; null where it does not. free() */
char *skin_socket_says(const char *name, const double socket[2], const struct render_conf *conf);

/* skin_first.c: the first character that has a rig: name, rig_path, look_path, and those in its inputs, with what the model is made of. Name
 * null: there is none. Returns false, err set, where targets/ cannot be read. */
bool skin_first(struct skin_target *target, struct stage *stage, struct err *err);

/* skin_open.c: how far an eye, scaled to the globe that the lids were made to clear, stands out of it where lids go, mm: the largest over
 * directions up to 60 degrees from its axis. */
double skin_over_globe(const struct scene *eye, const struct rig_globe *globe);

#endif
