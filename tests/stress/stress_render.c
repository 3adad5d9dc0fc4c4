/* The eye's renderer over random scenes: anatomy, settings, light and view over their whole ranges; iris maps and pigments as
 * strangers make them; each eye in four lights and views. Nothing that comes out is not a number, is negative or covers more
 * than all of a pixel. Energy: the fitted model alone is never brighter than the even room it stands in; with the photograph's
 * detail, a texel is brightened no more than draw/eye/colour.c says. Flagged: a scene that was refused. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "draw/eye/look.h"
#include "draw/eye/render.h"
#include "image/exr.h"
#include "tests/lib/scratch.h"
#include "tests/lib/stress.h"

// Small ones: a hundred thousand scenes say more than few large ones.
enum lighting { ANY_LIGHT, EVEN_ROOM, MODEL_ALONE };
enum { MAP = 24, PICTURE = 10, VEINS = 32, ROOM = 8, LOOKS = 4 };
enum hostility { TAME, NOT_NUMBERS, INFINITE, NEGATIVE, ENORMOUS, TINY, BLACK, SPIKES, HOSTILITIES };
static const char *const hostilities[] = { "tame", "not numbers", "infinite", "negative", "enormous", "tiny", "black", "spikes" };

struct paths {
	char texture[512], json[512], relief[512], pigment[512];
};

/* One of the interval's ends in one of eight cases: extremes meet. */
static double over(struct rng *rng, double lo, double hi)
{
	int end = rng_below(rng, 16);
	return end == 0 ? lo : end == 1 ? hi : rng_range(rng, lo, hi);
}

/* The ranges of config/capture.conf's keys. */
static struct eye any_eye(struct rng *rng)
{
	struct eye eye = { over(rng, 5, 12), over(rng, 0, 2), over(rng, 1, 2), over(rng, 4, 8), rng_below(rng, 4) ? over(rng, 0.7, 1.2) : NAN,
		           over(rng, 1.5, 6), rng_below(rng, 2), over(rng, 4, 12), over(rng, 0, 2), over(rng, 0.2, 1.2), over(rng, 1, 2) };
	return eye;
}

/* Those of config/render.conf. */
static struct scene_conf any_conf(struct rng *rng)
{
	struct scene_conf c = { .map_size = 16 << rng_below(rng, 4), .search = 2 + rng_below(rng, 16), .shadow = rng_below(rng, 12), .steps = 2 + rng_below(rng, 10),
		.quadrature = rng_below(rng, 3), .path = rng_below(rng, 2), .shading = rng_below(rng, 2), .bands = 3 + rng_below(rng, 4),
		.detail = over(rng, 0, 1), .own_width = 0.2, .ratio_most = 2.5, .ratio_chroma = 1.5, .limbus_width = over(rng, 0.05, 2), .sclera_radius = over(rng, 9, 16),
		.vein_density = over(rng, 0, 0.2), .veins_px = VEINS, .seed = rng_below(rng, 1000) };
	for (int i = 0; i < 3; i++)
		c.sclera_rgb[i] = over(rng, 0, 1);
	return c;
}

static float strange(struct rng *rng, enum hostility kind, float tame)
{
	static const float not_numbers[] = { NAN, -NAN, INFINITY };
	bool hit = rng_below(rng, 5) == 0;
	switch (kind) {
	case NOT_NUMBERS: return hit ? not_numbers[rng_below(rng, 2)] : tame;
	case INFINITE: return hit ? (rng_below(rng, 2) ? INFINITY : -INFINITY) : tame;
	case NEGATIVE: return hit ? -tame : tame;
	case ENORMOUS: return tame * 1e30f;
	case TINY: return tame * 1e-38f;
	case BLACK: return 0;
	case SPIKES: return rng_below(rng, 20) ? tame : 1e6f;
	default: return tame;
	}
}

static bool write_files(const struct paths *at, struct rng *rng, enum hostility colour, enum hostility height, struct err *err)
{
	double extent = over(rng, 4, 9);
	struct exr_info info = { .extent_mm = extent, .made_by = "{}" };
	struct image texture = image_new(MAP, MAP, 4), relief = image_new(MAP, MAP, 2);
	for (int i = 0; i < MAP * MAP; i++) {
		for (int c = 0; c < 3; c++)
			texture.px[4 * i + c] = strange(rng, colour, (float)over(rng, 0, 1));
		texture.px[4 * i + 3] = strange(rng, colour == BLACK ? TAME : colour, (float)(rng_below(rng, 6) > 0));
		relief.px[2 * i] = strange(rng, height, (float)over(rng, -0.3, 0.3));
		relief.px[2 * i + 1] = strange(rng, height, (float)over(rng, 0.02, 1));
	}
	char *pupil = mem_printf("{\"pupil\": {\"cx\": %g, \"cy\": %g, \"r\": %g}}", over(rng, -3, 3), over(rng, -3, 3), over(rng, -1, 9));
	double most = colour && rng_below(rng, 4) == 0 ? 1e3 : 1;
	char *pigment = mem_printf("{\"abl\": {\"melanin\": {\"value\": %g}, \"eumelanin_ratio\": {\"value\": %g}, \"thickness_mm\": %g},"
	                           "\"stroma\": {\"melanin\": {\"value\": %g}, \"eumelanin_ratio\": {\"value\": %g}, \"thickness_scale\": {\"value\": %g}},"
	                           "\"exposure\": {\"value\": %g}, \"illuminant\": \"D65\", \"scattering\": \"%s\"}", over(rng, 0, most),
	                           over(rng, 0, 1), over(rng, 0.01, 0.2), over(rng, 0, most), over(rng, 0, 1), over(rng, 0.1, 5), over(rng, 0.1, 5),
	                           rng_below(rng, 2) ? "multiple" : "single");
	bool ok = exr_write(at->texture, &texture, (const char *const[]){ "R", "G", "B", "W" }, EXR_FLOAT, &info, err)
	          && exr_write(at->relief, &relief, (const char *const[]){ "Y", "T" }, EXR_FLOAT, &info, err)
	          && file_write(at->json, pupil, strlen(pupil), err) && file_write(at->pigment, pigment, strlen(pigment), err);
	image_free(&texture);
	image_free(&relief);
	free(pupil);
	free(pigment);
	return ok;
}

/* A room with up to three lamps of up to 1e4 times its light. */
static struct envmap any_light(struct rng *rng, bool even)
{
	static const double one[3] = { 1, 1, 1 };
	struct envmap_box boxes[3];
	int n = even ? 0 : rng_below(rng, 4);
	for (int i = 0; i < n; i++) {
		double z = over(rng, -1, 1), phi = rng_range(rng, 0, 2 * M_PI), r = sqrt(fmax(1 - z * z, 0)), power = pow(10, rng_range(rng, 0, 4));
		boxes[i] = (struct envmap_box){ { r * cos(phi), r * sin(phi), z }, { over(rng, 0.03, 1), over(rng, 0.03, 1) }, { power, power, power }, 0 };
	}
	double ceiling[3], floor[3];
	for (int c = 0; c < 3; c++) {
		ceiling[c] = over(rng, 0, 1);
		floor[c] = over(rng, 0.001, 1);
	}
	struct envmap env = envmap_room(ROOM, even ? one : ceiling, even ? one : floor, even ? 1 : over(rng, 0, 1), n, boxes);
	if (!even)
		envmap_normalise(&env);
	return env;
}

struct bright {
	double channel, mean, luminance;  // the brightest number; the brightest pixel's mean; its luminance (linear Rec. 709)
};

/* What is no picture is wrong. */
static struct bright brightest(struct stress *s, const struct image *image)
{
	struct bright most = { 0 };
	for (long i = 0; i < (long)image->width * image->height; i++) {
		const float *px = image->px + 4 * i;
		double r = (double)px[0], g = (double)px[1], b = (double)px[2];
		if (!isfinite(px[0] + px[1] + px[2] + px[3]))
			stress_wrong(s, "pixel %ld: %g %g %g, cover %g", i, r, g, b, (double)px[3]);
		else if (px[0] < 0 || px[1] < 0 || px[2] < 0)
			stress_wrong(s, "pixel %ld is darker than black: %g %g %g", i, r, g, b);
		else if (px[3] < 0 || px[3] > 1.0001f)
			stress_wrong(s, "pixel %ld is covered by %g", i, (double)px[3]);
		most.channel = fmax(most.channel, fmax(r, fmax(g, b)));
		most.mean = fmax(most.mean, (r + g + b) / 3);
		most.luminance = fmax(most.luminance, 0.2126 * r + 0.7152 * g + 0.0722 * b);
	}
	return most;
}

static struct scene_view any_view(const struct scene *s, struct rng *rng)
{
	double yaw = rng_below(rng, 3) ? over(rng, -1.4, 1.4) : over(rng, -M_PI, M_PI);
	struct scene_view view = scene_view_turned(s, yaw, over(rng, -1.4, 1.4), over(rng, 10, 60), PICTURE);
	view.samples = 1 + rng_below(rng, 3);
	view.textured = rng_below(rng, 8) == 0;
	for (int i = 0; i < 2 && rng_below(rng, 8) == 0; i++)
		view.slip[i][2] = over(rng, -1, 1);
	return view;
}

/* Energy. Reflectances of 1 at most send on what an even room sends. Light gains n^2 in radiance where it enters the eye and
 * loses it where it leaves; the renderer leaves both to the exposure (tissue.h: light inside is given as irradiance), so the model
 * alone is no brighter than n^2 times the room, up to what 256 beams leave of evenness. With all of the photograph's detail, a texel (1 at most) is multiplied by up to ratio_most in the
 * mean of its channels and a channel by ratio_chroma (1.5) beside that mean, which raises the mean of three by 11/9 at most (two at
 * their upper limit, one at its lower); a mirror is no brighter than the lamp. A tenth: the sclera's light is summed over the
 * map's coarse pixels. */
static void judge(struct stress *run, const struct scene *s, const struct bright *most, double lamp, enum lighting in)
{
	double squared = s->eye.index * s->eye.index;
	double channel = s->conf.ratio_most * s->conf.ratio_chroma + 1.1 * lamp, mean = s->conf.ratio_most * 11 / 9 + 1.1 * lamp;
	if (in == MODEL_ALONE && most->luminance > 1.1 * squared * lamp)
		stress_wrong(run, "the model alone is of luminance %.3g in a room of %.3g times n^2 = %.3g", most->luminance, lamp, squared);
	if (in != MODEL_ALONE && most->channel > channel)
		stress_wrong(run, "as bright as %.3g, at most %.3g, in light of %.3g", most->channel, channel, lamp);
	if (in != MODEL_ALONE && most->mean > mean)
		stress_wrong(run, "as bright as %.3g in the mean, at most %.3g, in light of %.3g", most->mean, mean, lamp);
}

/* The brightest place of one picture over the brightest light. first: the photograph's light too, from which all of its detail
 * has to come out again. */
static double shine(struct stress *run, struct scene *s, const int beams[2], enum lighting in, bool tame, bool first)
{
	struct rng *rng = &run->rng;
	bool even = in != ANY_LIGHT;
	struct envmap env = any_light(rng, even);
	struct scene_lighting light = scene_lighting_of(&env, rng_below(rng, 4) || even ? &env : 0, beams[0], beams[1]);
	struct scene_view seen = scene_view_turned(s, even ? 0 : over(rng, -0.6, 0.6), even ? 0 : over(rng, -0.6, 0.6), 24, 32), view = any_view(s, rng);
	if (first)
		scene_fit_colour(s, &seen, &light);
	if (in == MODEL_ALONE)
		s->gain = 1;  // what the camera made of it left out
	struct image image = scene_render(s, &view, &light, 0);
	struct bright most = brightest(run, &image);
	double lamp = 0;
	for (long i = 0; i < 3L * env.map.width * env.map.height; i++)
		lamp = fmax(lamp, (double)env.map.px[i]);
	if (tame && (first || even) && (s->conf.detail == 1 || in == MODEL_ALONE))
		judge(run, s, &most, lamp, in);
	image_free(&image);
	envmap_free(&env);
	return in == MODEL_ALONE ? most.luminance / (lamp * s->eye.index * s->eye.index) : most.channel / lamp;
}

static void one(struct stress *s, const struct paths *at, bool hostile, enum lighting in)
{
	struct eye eye = any_eye(&s->rng);
	bool even = in != ANY_LIGHT;
	for (int i = 0; i < 100 && even && eye.iris_depth < eye_limbus_depth(&eye); i++)  // an iris that juts out of its cornea is none
		eye = any_eye(&s->rng);
	struct scene_conf conf = any_conf(&s->rng);
	enum hostility colour = hostile ? rng_below(&s->rng, HOSTILITIES) : TAME, height = hostile ? rng_below(&s->rng, HOSTILITIES) : TAME;
	conf.detail = in == MODEL_ALONE ? 0 : even || rng_below(&s->rng, 2) ? 1 : conf.detail;
	struct err err = { 0 };
	struct scene scene;
	struct scene_files files = { at->texture, at->json, at->relief, rng_below(&s->rng, 4) ? at->pigment : 0, 0 };
	stress_about(s, "R %.2f p %.2f n %.2f limbus %.1f iris %.1f; colour %s, relief %s; %s, %s, %d steps", eye.cornea_radius, eye.cornea_asphericity,
	             eye.index, eye.limbus_radius, eye.iris_depth, hostilities[colour], hostilities[height], conf.shading ? "texels" : "rays",
	             conf.path ? "ends" : "grid", conf.steps);
	if (!write_files(at, &s->rng, colour, height, &err) || !scene_load(&scene, &files, &eye, &conf, &err)) {
		stress_flagged(s);
		if (s->show)
			printf("  %s\n", err.msg);
		return;
	}
	// The same beams in all: fewer of them have other caustics, and an even room of one beam is not even.
	int beams[2] = { 1 + rng_below(&s->rng, 3), 1 << rng_below(&s->rng, 4) };
	if (in == MODEL_ALONE) {
		beams[0] = 32;
		beams[1] = 8;
		scene.optics.exposure = 1;
	}
	for (int i = 0; i < LOOKS; i++)
		stress_measure(s, shine(s, &scene, beams, in, colour == TAME, i == 0), in == MODEL_ALONE ? "of n^2 times the room" : "of the brightest light");
	scene_free(&scene);
}

int main(int argc, char **argv)
{
	struct stress s;
	struct paths at;
	omp_set_num_threads(1);  // pictures of 200 pixels: threads would wait for each other most of the time
	stress_start(&s, "render", argc, argv);
	scratch_open();
	snprintf(at.texture, sizeof at.texture, "%s", scratch_path("texture.exr"));
	snprintf(at.json, sizeof at.json, "%s", scratch_path("texture.json"));
	snprintf(at.relief, sizeof at.relief, "%s", scratch_path("relief.exr"));
	snprintf(at.pigment, sizeof at.pigment, "%s", scratch_path("pigment.json"));
	for (stress_family(&s, "whole ranges", 50000 / LOOKS); stress_case(&s);)
		one(&s, &at, false, ANY_LIGHT);
	for (stress_family(&s, "hostile maps", 30000 / LOOKS); stress_case(&s);)
		one(&s, &at, true, ANY_LIGHT);
	for (stress_family(&s, "an even room", 20000 / LOOKS); stress_case(&s);)
		one(&s, &at, false, EVEN_ROOM);
	for (stress_family(&s, "an even room, the model alone", 2000 / LOOKS); stress_case(&s);)
		one(&s, &at, false, MODEL_ALONE);
	scratch_close();
	return stress_end(&s);
}
