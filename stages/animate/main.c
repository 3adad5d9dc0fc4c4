/* animate: gaze, lids and expressions over time, as script/ says.
 * reads   script/ (keyframes, recorded gaze, a scene's video), work/skin/model.json and its matrices
 * writes  work/skin/animation.csv, animation.svg (its curves), animation.json (its blinks and saccades)
 */
#include "base/mem.h"
#include "stages/animate/options.h"

int main(int argc, char **argv)
{
	struct animate_conf conf = { 0 };
	struct scene_conf scene = { 0 };
	struct gaze_conf *gaze = &conf.gaze;
	double saccade_ms[2], blink_ms[3], skew[2];
	int seed;
	const struct opt opts[] = {
		SACCADE_OPTS(gaze),
		PURSUIT_OPTS(gaze),
		BLINK_OPTS(&conf),
		SCENE_OPTS(&conf, &scene),
		VIDEO_OPTS(&scene.video),
		OPT_REAL("fps", &conf.fps, 1, 1000, "1/s", "frames of the animation"),
		OPT_REAL_UNSET("duration_s", &conf.duration, 0, 86400, "s", "as long as the script says, where not set"),
		OPT_REAL("key_latency_s", &conf.key_latency, 0, 2, "s", "from a key to the saccade it asks for"),
		OPT_REAL("key_hold_s", &conf.hold, 0, 3600, "s", "how long the last key is held"),
		OPT_REAL("beyond", &conf.beyond, 0, 10, "", "share of its range in the clip that an aperture may leave it by"),
		OPT_INT("seed", &seed, 0, 1000000000, "", "of everything left to chance"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "animate", "gaze, lids and expressions over time, as script/ says", argc, argv, COUNT(opts), opts);
	gaze->saccade.duration_s = 1e-3 * saccade_ms[0];
	gaze->saccade.duration_per_deg = 1e-3 * saccade_ms[1];
	gaze->saccade.skew_short = skew[0];
	gaze->saccade.skew_long = skew[1];
	conf.blink.down_s = 1e-3 * blink_ms[0];
	conf.blink.down_per_deg = 1e-3 * blink_ms[1];
	conf.blink.hold_s = 1e-3 * blink_ms[2];
	conf.seed = scene.seed = (uint64_t)seed;
	scene.video.threads = stage.threads;
	animate_stage(&stage, &conf, &scene, &err);
	return stage_end(&stage, &err);
}
