/* conf: settings of a clip, from config/track.conf and capture.conf. */
#ifndef TRACK_CLIP_CONF_H
#define TRACK_CLIP_CONF_H
#include "anatomy/keys.h"
#include "image/video/video.h"
#include "track/eye/eye_track.h"
#include "track/clip/result.h"
#include "track/head/find.h"
#include "track/head/shade.h"
#include "track/points/skin_track.h"
#include "track/wrinkle/wrinkle.h"

/* Eyes that a video without a mesh shows; the names are the key's. */
enum track_shown { SHOWN_BOTH, SHOWN_LEFT, SHOWN_RIGHT };

/* Corners of the eyes (canthi.h), shares of the iris' radius. Of pairs the first is outwards, the second downwards; the inner corner before the outer. */
struct track_canthi_conf {
	double beyond[4];      // what shows of the eye ends so far within the corner
	double told_sigma[4];  // standard deviations of the corner that the evidence tells
	double mesh_sigma;     // of that of the mesh, of which an expression knows nothing; 0: the evidence is not asked
	double outline_beyond, outline_sigma;  // the same of the outline between them
	double most;           // apart by more, they are not of one corner
	double least_area;     // squares of the radius: of less that shows nothing is told
};

/* Lids by the evidence over the clip (margins.h), shares of the iris' radius; the inner corner before the outer. */
struct track_lids_conf {
	int every;             // one frame in so many is looked at; 0: none
	double most_px;        // radius of the iris beyond which what is followed is known better
	double found_px;       // standard deviation of corners and margins as they were followed, px
	double corner_sigma[4];  // that of the corners that the evidence tells, each outwards and downwards
	double ends_sigma[2], ends_beyond[2];  // canthi's outline_sigma and outline_beyond at the ends of the margins
};

struct track_conf {
	struct video_conf video;
	struct eye eye;
	struct eye_track_conf eyes;
	struct skin_track_conf skin;
	struct head_find_conf head;
	struct head_shade_conf shade;
	struct wrinkle_conf wrinkle;
	struct camera_keys camera;
	double unit_mm, eye_radius;                  // subject.*: NAN where not given
	struct opt_each_list landmark, eye_center;   // subject.landmark.*, subject.eye_center.*
	struct opt_each_list landmark_px, expression;
	double distance_mm, distance_sigma;  // of the face from a camera of unknown focal length; its standard deviation as a share of it
	int alone;             // which eyes the video shows, without a mesh: enum track_shown
	int reference;         // frame that the mesh is laid on; -1: the first in which eyes are found
	int search;            // frames searched for it; this and the spans below are frames at 60 a second: scaled for faster clips
	int settle;            // frames from which the eyeballs' centres are estimated to refine the reference pose; 0: none
	double settle_sigma, center_sigma;  // mm, standard deviations of the eyeballs' centres: the prior meanwhile; those of the mesh
	double guess_sigma;    // mm, of centres that are guessed from the lids' marks
	double outline;        // px, what outlines of lids and irises are off by besides what grows with the picture
	double pose_most, pose_refused;  // px at a width of 1280: where the reference pose's residual is larger, other frames are tried; the clip is refused
	double turned, torn, confirmed;   // degrees: a head that turns by more is laid on by how its skin moves; halves of the skin that tell poses further apart are refused; up to twice as far apart not where lids, eyeballs and shading turn it as far to this
	double mesh_straight;  // degrees: how far the eyes looked from straight on, up or down, when the mesh was made, one standard deviation; 0: lids are the mesh's at the usual gaze
	double earned_deg, earned_away;  // standard deviation of a turn that the skin's motion tells, and of the distance, a share of it
	double held_skin;      // mm, without a mesh: skin that lies further off the head it tells (trust_skin_mm) does not tell it: the eyes hold it
	double held_sigma;     // mm, of an average face's eyeballs between the corners of the eyes, which hold the head
	double center_floor;   // mm, that the bundle's own sigma of an eyeball's centre leaves out
	double trust[TRUST_EVIDENCES][2];    // scales of each evidence in clips followed rightly and wrongly: trust.h
	double wrong_lens_prior, lens_share[2];  // share of clips whose lens is told wrongly; scales of the perspective seen, less 1, where it is told rightly, wrongly
	double nearest_mm;     // what people look at in the median of a clip is no nearer than this or the camera
	double wrong_deg, wrong_alone_deg;    // gaze that is off by more is wrong; without a mesh
	double wrong_prior, wrong_prior_one, wrong_most, trust_odd;  // share of clips followed wrongly; of those that one eye alone lays the mesh on; probability of it beyond which a clip is refused; share of odd evidence
	double stirs_mm;       // frames of a head that turns whose skin is further off the rigid head have no gaze and no lids
	double off_mm;         // rms of that skin about the rigid head beyond which it is refused
	double gaze_least;     // share of frames with gaze in the better eye, below which a clip is refused
	int points;            // of skin
	struct {
		int frames, span;  // so many frames, spread over so many of the clip
	} look, doubt;         // by which the reference is judged: at first; again where those raise a doubt
	int chunk;             // frames after which what has been followed is kept on disk; 0: never
	long every, limit;     // one frame in so many is followed, so many in all; 0: all
	struct track_canthi_conf canthi;
	struct track_lids_conf lids;
	double meniscus_mm;    // from the eyeball to the inner edge of a lid's margin in the corners of the eye
	double kappa[2], kappa_sigma[2];     // degrees: prior of the line of sight against the optical axis, towards the nose and up
	double camera_frames[2];             // first and last of those in which the person looks into the camera; NAN: not told
	double lid_sigma_mm;   // standard deviation of a margin's place that a whole clip has in common
	double reach_mm;       // points are followed within it of an eyeball's centre
	double gap_px;         // least distance between points
	double cut;            // share of the points that must be seen, or the clip was cut there
	double own_mm, astray_mm;  // a point's own motion against its neighbours' where these scatter; so far off it counts little
	double still_pose_px;  // px: scale of the robust weights of a point off the rigid head
};

/* Frames from one that is followed to the next. */
static inline long track_every(const struct track_conf *conf)
{
	return conf->every ? conf->every : 1;
}

#define TRUST_OPT(key, c, which, unit, help) OPT_REALS("trust_" key, (c)->trust[which], 2, 1e-6, 1e6, unit, "followed rightly, wrongly: " help)

#define SETTLE_OPTS(c)                                                                                                              \
	OPT_INT("settle_frames", &(c)->settle, 0, 10000, "", "from which the eyeballs' centres settle the head's pose; 0: not"),            \
		OPT_INT("look_frames", &(c)->look.frames, 12, 1000, "", "that tell whether the reference frame is a good one"),                 \
		OPT_INT("look_span", &(c)->look.span, 12, 100000, "", "frames of the clip that those are spread over"),                         \
		OPT_INT("doubt_frames", &(c)->doubt.frames, 12, 1000, "", "that are followed where those raise a doubt, until one is good"),    \
		OPT_INT("doubt_span", &(c)->doubt.span, 12, 100000, "", "frames of the clip that those are spread over"),                       \
		OPT_REAL("settle_sigma_mm", &(c)->settle_sigma, 0.1, 20, "mm", "eyeballs' centres off the mesh's meanwhile"),                   \
		OPT_REAL("mesh_center_sigma_mm", &(c)->center_sigma, 0.01, 20, "mm", "how well the mesh knows them"),                                \
		OPT_REAL("held_skin_mm", &(c)->held_skin, 0, 100, "mm", "without a mesh: skin further off the average head does not tell its path, the eyes' corners do"), \
		OPT_REAL("held_center_sigma_mm", &(c)->held_sigma, 0.1, 20, "mm", "eyeballs off the middle between the eyes' corners, where these hold the head"), \
		OPT_REAL("guess_center_sigma_mm", &(c)->guess_sigma, 0.01, 20, "mm", "how well they are guessed from the lids' marks"),         \
		OPT_REAL("pose_most_px", &(c)->pose_most, 0.1, 1000, "px", "with larger residuals of the reference's pose other frames are tried, at 1280 px"), \
		OPT_REAL("pose_refused_px", &(c)->pose_refused, 0.1, 1000, "px", "with larger residuals the clip is refused"), \
		OPT_REAL("turned_deg", &(c)->turned, 0.1, 90, "degrees", "a head that turns by more is laid on by how its skin moves"), \
		OPT_REAL("torn_deg", &(c)->torn, 0.1, 90, "degrees", "halves of the skin that tell poses further apart are refused"), \
		OPT_REAL("confirmed_deg", &(c)->confirmed, 0, 90, "degrees", "up to twice as far apart are not, where lids and shading turn the head alike to this"), \
		OPT_REAL("off_mm", &(c)->off_mm, 0.01, 10, "mm", "skin of a head that turns, off the rigid mesh (rms): with more it is refused"), \
		OPT_REAL("mesh_straight_deg", &(c)->mesh_straight, 0, 45, "degrees", "the mesh's eyes look up or down by so much, 1 sigma; 0: lids at the usual gaze are the mesh's"), \
		OPT_REAL("earned_deg", &(c)->earned_deg, 0.01, 45, "degrees", "standard deviation of the turn that the skin's motion tells"), \
		OPT_REAL("earned_away", &(c)->earned_away, 1e-4, 1, "", "and of the distance that it tells, a share of that"), \
		OPT_REAL("center_floor_mm", &(c)->center_floor, 0, 10, "mm", "error of the eyeballs' centres found, beside what they scatter by"), \
		TRUST_OPT("laid_px", c, TRUST_LAID, "px", "lids and eyeballs off the mesh, at 1280 px"), TRUST_OPT("skin_mm", c, TRUST_SKIN, "mm", "skin off the rigid head"), \
		TRUST_OPT("level_deg", c, TRUST_LEVEL, "degrees", "one eye higher than the other"), TRUST_OPT("apart_deg", c, TRUST_APART, "degrees", "eyes apart"), \
		TRUST_OPT("iris_mm", c, TRUST_IRIS, "mm", "radius of the irises off people's"), TRUST_OPT("scale_mm", c, TRUST_SCALE, "mm", "the same without a mesh"), \
		TRUST_OPT("straight_deg", c, TRUST_STRAIGHT, "degrees", "gaze off straight ahead"), \
		TRUST_OPT("turned_deg", c, TRUST_TURNED, "degrees", "the mesh turned otherwise than the face"), \
		TRUST_OPT("unlike_deg", c, TRUST_UNLIKE, "degrees", "without a mesh: how well the face tells its turn"), \
		OPT_REAL("outline_px", &(c)->outline, 0, 100, "px", "what outlines are off by in any picture, large or small"), \
		OPT_REALS("lens_share", (c)->lens_share, 2, 1e-3, 100, "", "perspective seen, less 1, of a lens told rightly, wrongly"), \
		OPT_REAL("wrong_lens_prior", &(c)->wrong_lens_prior, 0, 0.99, "", "share of clips whose lens is told wrongly"), \
		OPT_REAL("nearest_mm", &(c)->nearest_mm, 0, 10000, "mm", "people look at nothing nearer, in the median, or at the camera"), \
		OPT_REAL("wrong_prior", &(c)->wrong_prior, 1e-6, 0.99, "", "share of clips that are followed wrongly"), \
		OPT_REAL("wrong_prior_one", &(c)->wrong_prior_one, 1e-6, 0.99, "", "of those in which one eye, its centre not told, lays the mesh on"), \
		OPT_REAL("wrong_deg", &(c)->wrong_deg, 0.1, 180, "degrees", "gaze that is off by more is wrong"), \
		OPT_REAL("wrong_alone_deg", &(c)->wrong_alone_deg, 0.1, 180, "degrees", "the same without a mesh"), \
		OPT_REAL("wrong_most", &(c)->wrong_most, 0, 1, "", "probability of a wrong result; with more a clip is refused"), \
		OPT_REAL("trust_odd", &(c)->trust_odd, 1e-12, 0.5, "", "share of clips followed rightly that are odd in one evidence"), \
		OPT_REAL("stirs_mm", &(c)->stirs_mm, 0.01, 100, "mm", "skin of a head that turns, off the rigid head: a frame with more has no gaze, no lids"), \
		OPT_REAL("gaze_least", &(c)->gaze_least, 0, 1, "", "share of frames with gaze in the better eye; with less it is refused")

#endif
