/* JSON that stages leave for each other, which a user may have edited or got with somebody's capture: cameras, edges, pigments, pupil,
 * folds, skin model, and the records of what was made from what. The first byte says which. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/record_holds.h"
#include "iris/heightfield/heightfield.h"
#include "limbus/record.h"
#include "tissue/pigment/pigment.h"
#include "optics/camera_rig.h"
#include "model/model.h"
#include "draw/face/wrinkle_map.h"

/* A capture whose record, model and list of folds are the file in memory; where nothing else is. */
static const char *capture(const char *file)
{
	static const char *const links[] = { "work/.made/blur.json", "model.json", "wrinkles.json", "wrinkles.exr" };
	static char *dir;
	const char *tmp = getenv("TMPDIR");
	struct err err = { 0 };
	if (dir)
		return dir;
	dir = mem_printf("%s/eyewright-fuzz-XXXXXX", tmp ? tmp : "/tmp");
	char *below = mkdtemp(dir) ? mem_printf("%s/work/.made", dir) : 0;
	bool made = below && file_mkdirs(below, &err);
	for (int i = 0; made && i < COUNT(links); i++) {
		char *path = mem_printf("%s/%s", dir, links[i]);
		made = symlink(file, path) == 0;
		free(path);
	}
	char *program = mem_printf("%s/program", dir);
	if (!made || !file_write(program, "1", 1, &err))
		abort();
	free(program);
	free(below);
	return dir;
}

static void records(const char *dir)
{
	struct conf conf = { 0 };
	char *why = 0;
	conf_add(&conf, "quality", "review");
	conf_add(&conf, "blur.sigma", "3");
	record_inputs_hold(dir, "blur");
	if (!record_holds(dir, "blur", "program", &conf, &why) && !why)
		abort();  // stale without a reason
	free(why);
	conf_free(&conf);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (!size)
		return 0;
	const char *path = fuzz_file(data + 1, size - 1), *dir = capture(path);
	struct err err = { 0 };
	struct camera_rig rig = { 0 };
	struct limbus_record edge;
	struct pigment_conf conf;
	struct pupil pupil;
	struct wrinkle_maps folds = { 0 };
	struct skin_model model = { 0 };
	double x[PIGMENT_N], white[3];
	bool ok = true;
	switch (data[0] % 7) {
	case 0: ok = camera_rig_load(&rig, path, &err); break;
	case 1: ok = limbus_record_load(&edge, path, &err); break;
	case 2: ok = pigment_load(x, white, &conf, path, &err); break;
	case 3: ok = pupil_load(&pupil, path, 2, &err); break;
	case 4: ok = wrinkle_maps_load(&folds, dir, &err); break;
	case 5: ok = skin_model_load(&model, dir, &err); break;
	case 6: records(dir); break;
	}
	if (ok == err_is(&err) || strchr(err.msg, '\n'))
		abort();  // refused without a line, or in several
	camera_rig_free(&rig);
	wrinkle_maps_free(&folds);
	if (ok && data[0] % 7 == 5)
		skin_model_free(&model);
	return 0;
}
