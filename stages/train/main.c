/* train: fits the model of lids and skin (lib/model/) to the tracked clip.
 * reads   work/skin/gaze.csv, lids.npy, skin_model.npy, confidence.npy, vertices.npy, track.json
 * writes  work/skin/model.json and model_*.npy, curves.svg (error against components), train.json
 */
#include "anatomy/keys.h"
#include "base/mem.h"
#include "stages/train/train_stage.h"

int main(int argc, char **argv)
{
	struct train_conf conf = { 0 };
	struct opt_each_list expressions = { 0 };
	bool rbf = true;
	const struct opt opts[] = {
		EXPRESSION_OPT(&expressions),
		OPT_INT("lid_components", &conf.lid_components, 1, 60, "", "components of one eye's lids"),
		OPT_INT("skin_components", &conf.skin_components, 1, 60, "", "components of the skin"),
		OPT_BOOL("choose", &conf.choose, "of these, only as many as make frames held out better predicted"),
		OPT_INT("curve_components", &conf.curve_components, 1, 60, "", "the error is drawn up to so many"),
		OPT_INT("sample", &conf.sample, 64, 16384, "frames", "bounded sample: pilot, cross-validation, errors"),
		OPT_REAL("block_s", &conf.block_s, 0.05, 60, "s", "block of time that is held out together"),
		OPT_REAL("guard_s", &conf.guard_s, 0, 10, "s", "left out between two blocks"),
		OPT_INT("folds", &conf.folds, 2, 20, "", "of the cross-validation"),
		OPT_REAL("huber", &conf.huber, 1, 100, "", "frames this many times further out than usual weigh less"),
		OPT_REAL("trim", &conf.trim, 1, 10000, "", "and beyond this nothing"),
		OPT_REAL("min_seen", &conf.min_seen, 0, 1, "", "share of the frames a coordinate must be measured in"),
		OPT_REAL("gap_s", &conf.gap_s, 0, 10, "s", "gaze is carried over gaps no longer than this"),
		OPT_REAL("aperture_share", &conf.aperture_share, 0, 0.2, "", "share of the frames that define closed and open"),
		OPT_REAL("beyond", &conf.beyond, 0, 10, "", "lids follow the gaze so far beyond the clip's, in its half widths"),
		OPT_BOOL("rbf", &rbf, "radial basis functions, to compare with"),
		OPT_INT("memory_mb", &conf.memory_mb, 16, 65536, "MiB", "limit of the scatter matrix and the sample"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "train", "how lids and skin move with the eyes, from the tracked clip", argc, argv, COUNT(opts), opts);
	conf.brief = !rbf;
	train_stage(&stage, &conf, &expressions, &err);
	return stage_end(&stage, &err);
}
