/* render: pictures of the fitted eye and of driven characters, and the review page.
 * reads   IRIS/texture.exr, clean.exr, relief.exr, pigment.json, limbus/NAME.json, photos/
 *         work/targets/NAME/rig.npz, work/skin/model.json, gaze.csv, animation.csv, video/, views/, work/rig.json, work/subject.ply
 * writes  RENDER/NAME_view, NAME_compare, front, three_quarter, turntable, contact_sheet, shot_NAME; review/index.html, viewer.html;
 *         work/render/NAME_look.png, NAME_look_layers.exr, NAME_sheet.png, NAME_blink.png, NAME_clip.mp4, NAME_script.mp4, NAME.glb
 *         work/render/track.mp4, track.svg: what was followed in the video
 *         work/export/: eye.glb, textures, statements (render/export/export.h)
 */
#include "base/mem.h"
#include "render/export/export.h"
#include "render/options.h"
#include "render/face/skin.h"
#include "render/film/film.h"
#include "render/viewer/viewer.h"

/* A folder without photographs has no fitted eye and needs none: its characters get plain ones. */
static bool photos_load(struct capture *capture, struct stage *stage, const struct opt_each_list *eye_of, struct err *err)
{
	struct file_list photos;
	bool ok = stage_list(stage, &photos, "photos", err) && (!photos.n || capture_load(capture, stage, eye_of, err));
	file_list_free(&photos);
	return ok;
}

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct render_conf conf = { 0 };
	struct skin_conf skin = { 0 };
	struct export_conf leaves = { 0 };
	struct opt_each_list eye_of = { 0 };
	const struct opt opts[] = { EYE_OPTS(&eye), CAPTURE_OPTS(&eye_of), RENDER_OPTS(&conf), SKIN_OPTS(&skin), EXPORT_OPTS(&leaves) };
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "render", "pictures of the fitted eye and the page that shows everything", argc, argv, COUNT(opts),
	            opts);
	struct capture capture = { 0 };
	bool ok = eye_check(&eye, &err) && photos_load(&capture, &stage, &eye_of, &err);
	struct jobs eyes = { 0 };
	ok = ok && jobs_open(&eyes, &stage, &capture, &eye, &conf, &err);
	skin.portrait.eye_samples = conf.samples;
	struct skin_job faces = { .stage = &stage, .render = &conf, .conf = &skin, .leaves = &leaves, .capture = &capture, .eye = &eye, .photographed = &eyes };
	for (int i = 0; ok && i < eyes.n; i++)
		ok = (stage.only || render_eye(&eyes.job[i], &err)) && export_eye(&eyes.job[i], &leaves, &faces, &err);
	if (!stage.only) {
		// The pages show what is there: what was made of inputs that are gone is put aside before.
		ok = ok && render_skin(&faces, &err) && film_make(&faces, &err) && stage_put_aside(&stage, "work/render", &err);
		show(&faces, ok, &err);
	}
	skin_close(&faces);
	jobs_close(&eyes);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
