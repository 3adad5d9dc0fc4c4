#include "stages/track/run.h"

#include <math.h>

#include "base/mem.h"
#include "stages/track/refuse.h"
#include "stages/track/save.h"
#include "stages/track/sheet.h"
#include "stages/track/wrinkles.h"
#include "track/clip/agree.h"
#include "track/clip/alone.h"
#include "track/clip/apertures.h"
#include "track/clip/aside.h"
#include "track/clip/canthi.h"
#include "track/clip/chunks.h"
#include "track/clip/corners.h"
#include "track/clip/expressions.h"
#include "track/clip/follow.h"
#include "track/clip/kappa.h"
#include "track/clip/margins.h"
#include "track/clip/others.h"
#include "track/clip/refine.h"
#include "track/clip/settle.h"
#include "track/clip/tapers.h"
#include "track/clip/trust.h"

/* Warns of shortcomings of the video, one line each. */
static void tell_video(struct stage *stage, const struct track_clip *clip, const struct track_subject *subject)
{
	const struct video_info *v = &clip->info;
	if (v->variable)
		stage_skipped(stage, "%s: variable frame rate (intervals differ by up to %.0f %%): its own time stamps are used; film at a fixed rate", clip->file,
		              100 * v->jitter);
	if (v->promised > v->frames)
		stage_skipped(stage, "%s: cut off: %ld of %ld frames are there; copy the file again", clip->file, v->frames, v->promised);
	if (v->fps < 25)
		stage_skipped(stage, "%s: %.0f frames/s: blinks are over in a few frames; film at 60 or more", clip->file, v->fps);
	if (clip->focal_assumed)
		stage_skipped(stage, "%s: focal length not known: as if from %.0f mm away; set camera.focal_px, or camera.focal_mm and camera.sensor_mm", clip->file,
		              track_eyes_depth(clip->cam_from_head, subject));
}

static void tell_way(struct stage *stage, const struct track_clip *clip)
{
	if (clip->cam_from_head[1][1] > 0)
		stage_skipped(stage, "%s: the face is upside down in it: it is followed as it is; film upright, or set the file's rotation", clip->file);
}

/* Frames in which lids of neither eye were found though no blink was. */
static long blind_of(const struct track_result *r)
{
	long n = 0;
	for (long f = 0; f < r->n && r->has_eyes; f++) {
		bool any = r->lost_at[f];
		for (int e = 0; e < SIDES; e++)
			any = any || isfinite(r->eyes.state[f][e].lid[LID_UPPER][0][0]) || r->eyes.state[f][e].blink != BLINK_OPEN;
		n += !any;
	}
	return n;
}

static void tell(struct stage *stage, const struct track_result *r, const struct track_clip *clip)
{
	const double few = 0.05;
	double seen = 0;
	for (long i = 0; i < r->n * r->n_points; i++)
		seen += r->confidence[i] > 0;
	seen /= fmax(1, (double)r->n * r->n_points);
	stage_note(stage, "%s: %ld frames, %d points of skin, %.0f %% of them seen; pose from the openings of the eyes to %.1f px%s", clip->file,
	           r->n, r->n_points, 100 * seen, clip->pose_px, r->rests ? "; the head rests" : "");
	stage_figure(stage, "track_frames", (double)r->n, "");
	stage_figure(stage, "track_still_frames", (double)r->still, "whose skin was not sought again: nothing moves");
	stage_figure(stage, "track_points", r->n_points, "");
	stage_figure(stage, "track_seen", seen, "");
	stage_figure(stage, "track_pose", clip->pose_px, "px");
	if (r->place_mm > 0)
		stage_skipped(stage, "%s: the corners of the eyes tell where the head is, the face how it turns, as far as people are alike: gaze is known to some %.0f degrees (one standard deviation; gaze.csv has each)",
		              clip->file, trust_sigma_deg(r));
	const long blind = blind_of(r);
	if (blind > few * (double)r->n)
		stage_skipped(stage, "%s: in %ld of %ld frames neither eye is measured: shut for long, turned away, or blurred", clip->file, blind, r->n);
	if (r->unsure)
		stage_skipped(stage, "%s: in %ld frames the skin stirs too much to tell how the head is turned: no gaze and no lids there", clip->file, r->unsure);
	if (r->lost)
		stage_skipped(stage, "%s: from frame %ld on, %ld frames show the face otherwise than frame %ld does (a cut, or the head turned away): nothing is measured there",
		              clip->file, r->cut, r->lost, clip->reference);
}

static bool work(struct stage *stage, struct track_clip *clip, struct track_subject *subject, struct track_points *points,
                 struct track_result *result, const struct track_conf *conf, int n, const char *const in[], struct err *err)
{
	if (!track_subject_load(subject, stage, conf, err))
		return false;
	if (!track_clip_open(clip, stage, subject, conf, err))
		return track_lies_aside(clip, err);
	tell_video(stage, clip, subject);
	if (!(subject->assumed ? track_alone(clip, stage, subject, conf, err) : track_settle(clip, stage, subject, conf, err)))
		return false;
	tell_way(stage, clip);
	if (!track_settled(clip, subject, conf, err) || !track_alone_in_it(clip, subject, conf, err)) {
		refuse_picture(stage, clip, subject, 0);
		return track_lies_aside(clip, err);
	}
	if (!track_canthi(subject, clip, conf, err) || !track_points_choose(points, clip, subject, conf, err) || !track_follow(result, stage, clip, subject, points, conf, err))
		return false;
	if (result->n < 2)
		return err_set(err, "%s: %ld frames: film longer", clip->file, result->n);
	if (result->lost * 2 > result->n)
		return err_set(err, "%s: from frame %ld on the face of frame %ld is not seen again (a cut, or the head turned away): cut the video to one take", clip->file,
		               result->cut, clip->reference);
	reference_lens(clip, result, subject, conf);
	if (!track_agrees(result, clip, subject, conf, err)) {
		struct err others = { 0 };
		refuse_picture(stage, clip, subject, result);
		if (!track_alone_through(result, stage, clip, subject, conf, &others)) {
			*err = others;
			return false;
		}
		return track_lies_aside(clip, err);
	}
	if (!track_kappa(result, conf, err))
		return false;
	track_corners(result, clip, subject, points);
	if (!track_margins(result, stage, clip, subject, conf, err))
		return false;
	track_tapers(result, subject);
	track_apertures(result, clip, subject, conf);
	if (subject->assumed)
		result->n_points = points->n = 0;  // rows of no mesh of the person
	if (!track_expressions(result, stage, conf, err) || !file_mkdirs(stage_path(stage, "work/skin"), err)
	    || !track_sheet(result->film, stage_path(stage, "work/skin/track.png"), result, clip, conf, err)
	    || !track_save(stage, result, clip, points, n, in, err)
	    || !wrinkles_finish(stage, result, clip, subject, points, conf, n, in, err))
		return false;
	tell(stage, result, clip);
	return file_remove(stage_path(stage, REFUSED_PICTURE), err);
}

bool track_stage(struct stage *stage, const struct track_conf *conf, struct err *err)
{
	const char *in[8];
	struct track_clip clip = { 0 };
	int n = 0, more;
	if (!track_video(clip.file, &more, stage, err))
		return false;
	in[n++] = clip.file;
	static const char *const others[] = { "subject.ply", "subject.obj", "work/subject.ply", "work/rig.json" };
	bool fresh = true, has_mesh = false;
	for (int i = 0; i < COUNT(others); i++)
		if (file_exists(stage_path(stage, "%s", others[i]))) {
			in[n++] = others[i];
			has_mesh = has_mesh || i < 3;
		}
	for (int i = 0; i < TRACK_FILES; i++)
		fresh = stage_fresh(stage, track_files[i], n, in) && fresh;
	for (int i = 0; i < WRINKLE_FILES && wrinkles_wanted(conf, has_mesh); i++)
		fresh = stage_fresh(stage, wrinkle_files[i], n, in) && fresh;
	if (fresh) {
		chunks_remove(stage);
		return true;
	}
	if (more)
		stage_skipped(stage, "video/: %s is followed, the other %d files are not", clip.file, more);
	struct track_subject subject = { 0 };
	struct track_points points = { 0 };
	struct track_result result = { 0 };
	clip.made_by = stage_made_by(stage, n, in);
	bool ok = work(stage, &clip, &subject, &points, &result, conf, n, in, err);
	chunks_remove(stage);
	track_result_free(&result);
	track_points_free(&points);
	track_subject_free(&subject);
	track_clip_free(&clip);
	return ok;
}
