/* Portraits of a made face: light in closed form, no holes, eyes where they are, the same bytes on any number of threads. */
#include "base/mem.h"
#include "draw/eye/look.h"
#include "draw/eye/lighting.h"
#include "draw/eye/view.h"
#include "draw/face/impl.h"
#include "draw/face/skin_look.h"
#include "math/rng.h"
#include "math/stats.h"
#include "math/vec.h"
#include "rig/drive.h"
#include "tests/lib/scenes/portrayed.h"
#include "tests/lib/unit.h"

#include <omp.h>

struct made {
	struct portrayed of;  // the same radiance from everywhere: 1
	double tear;  // mm
	double wet;   // of the caruncles
};

static int setup(void **state)
{
	struct made *m = calloc(1, sizeof *m);
	bool ok = portrayed_make(&m->of, 1);
	struct scene_view view = scene_view_turned(&m->of.eye, 0, 0, 27, 64);
	struct scene_lighting light = scene_lighting(&m->of.env, 0, 4);
	scene_fit_colour(&m->of.eye, &view, &light);
	m->tear = 0.3;
	*state = m;
	return ok ? 0 : 1;
}

static int teardown(void **state)
{
	struct made *m = *state;
	portrayed_free(&m->of);
	free(m);
	return 0;
}

static struct portrait *portrait_of(const struct made *m, double scatter)
{
	const struct scene *eyes[2] = { &m->of.eye, &m->of.eye };
	struct portrait_conf conf = { .lights = 64, .subdivide = 1, .samples = 2, .eye_samples = 1, .skin_rgb = { 0.5, 0.4, 0.3 }, .scatter_mm = scatter,
		                          .tear_mm = m->tear, .caruncle_wet = m->wet };
	return portrait_new(&m->of.rig, eyes, &m->of.env, &conf);
}

/* Light from everywhere gives an open surface irradiance 1 whichever way it faces; median cut stands for it by 64
 * directions of equal energy. */
static void even_light_is_one(void **state)
{
	struct made *m = *state;
	struct portrait *p = portrait_of(m, 0.01);
	double c[12];
	drive_look(c, &m->of.rig, 0, 0, 1);
	portrait_pose(p, c);
	struct portrait_view view = portrait_front(&m->of.rig, -1, 130, 0, 0, 130, 60);
	portrait_light(p, &view, true);
	int n = 0;
	for (int i = 0; i < m->of.rig.n; i++)
		if (p->mesh.open[i] > 0.999f && m->of.rig.part[i] == RIG_SKIN && p->near_start[i + 1] > p->near_start[i]) {
			NEAR(p->mesh.light[i][1], 1, 0.06);
			n++;
		}
	assert_true(n > 300);
	portrait_free(p);
}

/* Inside the sheet's outline every pixel shows skin or an eye, whatever the pose. */
static void no_holes(void **state)
{
	struct made *m = *state;
	struct portrait *p = portrait_of(m, 2);
	struct rng rng = { 31 };
	double c[12];
	for (int round = 0; round < 6; round++) {
		drive_look(c, &m->of.rig, rng_range(&rng, -20, 20), rng_range(&rng, -12, 12), rng_uniform(&rng));
		portrait_pose(p, c);
		struct portrait_view view = portrait_front(&m->of.rig, -1, 90, 0, 0, 240, 80);
		struct portrait_spot *spots = portrait_raster(p, &view, 2);
		int eye = 0;
		for (int i = 0; i < 480 * 160; i++) {
			assert_true(spots[i].face != -1);
			eye += spots[i].face < -1;
		}
		assert_true(eye > 100);  // the made lids never meet: eyes show
		free(spots);
	}
	portrait_free(p);
}

static void eyes_are_where_they_are(void **state)
{
	struct made *m = *state;
	struct portrait *p = portrait_of(m, 2);
	double c[12];
	drive_look(c, &m->of.rig, 0, 0, 1);
	portrait_pose(p, c);
	const double *o = m->of.rig.globe[0].center;
	double scale = m->of.rig.globe[0].radius / 11.8;
	// From the front: the corneal apex; from the side and from behind: the sclera, which is the globe's own sphere.
	float front[3] = { (float)o[0], (float)o[1], (float)o[2] + 100 }, side[3] = { (float)o[0] + 100, (float)o[1], (float)o[2] - 2 };
	double apex = m->of.eye.sclera_z * scale, r = m->of.rig.globe[0].radius;
	NEAR(portrait_eye_hit(p, 0, front, (float[]){ 0, 0, -1 }), 100 - apex, 1e-3);
	NEAR(portrait_eye_hit(p, 0, side, (float[]){ -1, 0, 0 }), 100 - sqrt(r * r - 4), 1e-3);
	assert_true(isinf(portrait_eye_hit(p, 0, front, (float[]){ 0, 0, 1 })));
	// Turned by 20 degrees to the left, the apex stands where Fick's formula says.
	drive_look(c, &m->of.rig, 20, 0, 1);
	portrait_pose(p, c);
	float from[3] = { (float)(o[0] + 100 * sin(M_PI / 9)), (float)o[1], (float)(o[2] + 100 * cos(M_PI / 9)) };
	NEAR(portrait_eye_hit(p, 0, from, (float[]){ (float)-sin(M_PI / 9), 0, (float)-cos(M_PI / 9) }), 100 - apex, 1e-3);
	portrait_free(p);
}

static void same_bytes_on_any_number_of_threads(void **state)
{
	struct made *m = *state;
	int threads = omp_get_max_threads();
	struct image image[2];
	double c[12];
	for (int k = 0; k < 2; k++) {
		omp_set_num_threads(k ? 3 : 1);
		struct portrait *p = portrait_of(m, 2);
		drive_look(c, &m->of.rig, 10, -5, 0.7);
		portrait_pose(p, c);
		struct portrait_view view = portrait_front(&m->of.rig, -1, 110, 0.1, 0, 150, 60);
		portrait_light(p, &view, true);
		image[k] = portrait_draw(p, &view);
		portrait_free(p);
	}
	omp_set_num_threads(threads);
	assert_memory_equal(image[0].px, image[1].px, 150 * 60 * 4 * sizeof(float));
	for (int i = 0; i < 150 * 60 * 4; i++)
		assert_true(image[0].px[i] >= 0 && isfinite(image[0].px[i]));
	image_free(&image[0]);
	image_free(&image[1]);
}

/* A quarter of a circle from the globe to the lid: its normal against the circle's own, and upright where it meets the lid. */
static void meniscus(void **state)
{
	(void)state;
	const float up[3] = { 0, 0, 1 }, from[3] = { 1, 0, 0 };
	for (float d = 0.01f; d < 0.3f; d += 0.02f) {
		float n[3];
		double x = 0.3 - (double)d, slope = -x / sqrt(0.3 * 0.3 - x * x);  // of R - sqrt(R^2 - (R - d)^2)
		portrait_meniscus(n, up, from, d, 0.3f);
		NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
		NEAR(n[0] / n[2], -slope, 1e-4 * (1 - slope));
	}
	float n[3];
	portrait_meniscus(n, up, from, 0, 0.3f);
	NEAR(n[0], 1, 1e-6);
	portrait_meniscus(n, up, from, 0.3f, 0.3f);
	NEAR(n[2], 1, 1e-6);
}

/* The place of a globe that a pixel's middle would show without lids; false: beside it. */
static bool globe_at(double at[3], const struct portrait *p, const struct portrait_rays *rays, int side, int x, int y)
{
	float dir[3];
	portrait_ray(dir, rays, x + 0.5, y + 0.5);
	const float t = portrait_eye_hit(p, side, rays->origin, dir);
	for (int c = 0; c < 3; c++)
		at[c] = (double)(rays->origin[c] + t * dir[c]);
	return isfinite(t);
}

static double apart(const double a[3], const double b[3])
{
	double d[3];
	vec_add(d, a, -1, b);
	return vec_norm(d);
}

/* The layer of distances against the spots that the picture is made of: within a pixel of the nearest skin of the mask. */
static void distances_are_to_the_lids(void **state)
{
	struct made *m = *state;
	enum { W = 150, H = 60 };
	double c[12];
	struct portrait *p = portrait_of(m, 2);
	drive_look(c, &m->of.rig, 0, 0, 1);
	portrait_pose(p, c);
	struct portrait_view view = portrait_front(&m->of.rig, -1, 110, 0, 0, W, H);
	struct image picture = portrait_draw(p, &view), layers = portrait_layers(p, &view, &picture);
	struct portrait_spot *spots = portrait_raster(p, &view, 1);
	const struct portrait_rays rays = portrait_rays_of(&view);
	double mm = 110.0 / W;  // at the globes' depth
	double off[2] = { 0 };
	int seen = 0;
	for (int i = 0; i < W * H; i++) {
		const float *px = layers.px + PORTRAIT_LAYERS * i;
		if (isinf(px[1]))
			continue;
		const int side = i % W < W / 2;  // the person's right is the picture's left
		double nearest = INFINITY, across = INFINITY, here[3], there[3], wide = 0;
		assert_true(globe_at(here, p, &rays, side, i % W, i / W));
		for (int k = 0; k < 2; k++)
			wide = globe_at(there, p, &rays, side, i % W + (k ? 0 : 1), i / W + k) ? fmax(wide, apart(here, there)) : INFINITY;
		for (int j = 0; j < W * H; j++)
			if (spots[j].face >= 0) {
				across = fmin(across, hypot(j % W - i % W, j / W - i / W) * mm);
				nearest = globe_at(there, p, &rays, side, j % W, j / W) ? fmin(nearest, apart(here, there)) : nearest;
			}
		assert_true(px[0] > 800 && px[0] < 1000);  // a portrait's distance, mm
		if (!(fabs((double)px[1] - nearest) < 1.5 * wide))
			fail_msg("pixel %d, %d: %g mm, not %g", i % W, i / W, (double)px[1], nearest);
		seen++;
		off[0] += pow((double)px[1] - across, 2);
		off[1] += pow((double)px[1] - nearest, 2);
	}
	print_message("distances: %d pixels, %.3f mm rms off those across the screen, %.3f off those in view space\n", seen, sqrt(off[0] / seen), sqrt(off[1] / seen));
	assert_true(seen > 100 && off[1] < off[0]);
	free(spots);
	image_free(&picture);
	image_free(&layers);
	portrait_free(p);
}

/* Diffuse and specular light are the picture, neither is negative; normals stand on the plane through neighbours' depths. */
static void layers_make_the_picture(void **state)
{
	struct made *m = *state;
	enum { W = 240, H = 96 };
	double c[12];
	m->wet = 1;
	struct portrait *p = portrait_of(m, 2);
	m->wet = 0;
	drive_look(c, &m->of.rig, 8, 0, 1);
	portrait_pose(p, c);
	struct portrait_view view = portrait_front(&m->of.rig, -1, 110, 0.2, 0, W, H);
	portrait_light(p, &view, true);
	struct image picture = portrait_draw(p, &view), layers = portrait_layers(p, &view, &picture);
	double shine = 0, off[W * H];
	int n = 0;
	for (int y = 0; y + 1 < H; y++)
		for (int x = 0; x + 1 < W; x++) {
			const float *q = image_at(&layers, x, y), *r = image_at(&layers, x + 1, y), *s = image_at(&layers, x, y + 1), *N = q + PORTRAIT_NORMAL;
			for (int k = 0; k < 3; k++) {
				NEAR(q[PORTRAIT_DIFFUSE + k] + q[PORTRAIT_SPECULAR + k], image_at(&picture, x, y)[k], 1e-6);
				assert_true(q[PORTRAIT_DIFFUSE + k] >= 0 && q[PORTRAIT_SPECULAR + k] >= -1e-6f);
			}
			shine += (double)q[PORTRAIT_SPECULAR];
			if (!(q[0] > 0 && r[0] > 0 && s[0] > 0 && N[2] != 0) || fabsf(q[0] - r[0]) > 0.3f || fabsf(q[0] - s[0]) > 0.3f)
				continue;
			double a[3], b[3], o[3], e[2][3], flat[3];
			double (*const at[3])[3] = { &o, &a, &b };
			for (int k = 0; k < 3; k++) {
				double z = (double)(k == 0 ? q : k == 1 ? r : s)[0];
				double at_k[3] = { (x + 0.5 + (k == 1) - view.center_px[0]) / view.focal_px * z, (y + 0.5 + (k == 2) - view.center_px[1]) / view.focal_px * z, z };
				memcpy(*at[k], at_k, sizeof at_k);
			}
			vec_add(e[0], a, -1, o);
			vec_add(e[1], b, -1, o);
			vec_cross(flat, e[1], e[0]);
			vec_unit(flat, flat);
			NEAR(N[0] * N[0] + N[1] * N[1] + N[2] * N[2], 1, 1e-4);
			off[n++] = acos(fmin(1, flat[0] * (double)N[0] + flat[1] * (double)N[1] + flat[2] * (double)N[2])) * 180 / M_PI;
		}
	print_message("layers: normals of %d pixels, off by %.2f degrees in the median, %.1f at 95 %%\n", n, stats_quantile(n, off, 0.5), stats_quantile(n, off, 0.95));
	assert_true(n > 5000 && shine > 1);
	assert_true(stats_quantile(n, off, 0.5) < 3);  // facets against smooth normals
	assert_true(stats_quantile(n, off, 0.95) < 20);
	image_free(&picture);
	image_free(&layers);
	portrait_free(p);
}

/* Tears change what lies along the lids and nothing else: no skin, and nothing of the globe further from skin than they reach, found here pixel by pixel. */
static void tears_stay_at_the_lids(void **state)
{
	struct made *m = *state;
	enum { W = 300, H = 120, REACH = 8 };  // 110 mm / 300 px: 0.7 mm are 1.9 px; the made lids stand up to 2 mm before the globe
	struct image image[2];
	struct portrait_spot *spots = 0;
	double c[12];
	for (int k = 0; k < 2; k++) {
		m->tear = k ? 0.5 : 0;
		struct portrait *p = portrait_of(m, 2);
		drive_look(c, &m->of.rig, 0, 0, 1);
		portrait_pose(p, c);
		struct portrait_view view = portrait_front(&m->of.rig, -1, 110, 0, 0, W, H);
		portrait_light(p, &view, true);
		image[k] = portrait_draw(p, &view);
		if (k)
			spots = portrait_raster(p, &view, 1);
		portrait_free(p);
	}
	m->tear = 0.3;
	int changed = 0, brighter = 0;
	for (int i = 0; i < W * H; i++) {
		if (!memcmp(image[0].px + 4 * i, image[1].px + 4 * i, 4 * sizeof(float)))
			continue;
		int x = i % W, y = i / W, skin = 0;
		for (int v = y - REACH; v <= y + REACH; v++)
			for (int u = x - REACH; u <= x + REACH; u++)
				skin += u >= 0 && v >= 0 && u < W && v < H && spots[v * W + u].face >= 0;
		assert_true(skin > 0);
		changed++;
		brighter += image[1].px[4 * i] > image[0].px[4 * i];
	}
	print_message("tears: %d pixels, %d of them brighter\n", changed, brighter);
	assert_true(changed > 50 && brighter > changed / 2);  // what is mirrored outweighs what the fluid takes
	free(spots);
	image_free(&image[0]);
	image_free(&image[1]);
}

/* The tear line along the lower lids is wet in every column, half way down as well, looking down, too: what it mirrors there, where a pixel is nearly as
 * wide as the line is high, is by far more than a twentieth of what it does in the median. */
static void the_line_is_continuous(void **state)
{
	struct made *m = *state;
	enum { W = 200, H = 150 };
	static const double look[][3] = { { 0, 0, 1 }, { 15, 0, 1 }, { 0, -15, 1 }, { 0, 0, 0.7 } };
	struct portrait *p = portrait_of(m, 2);
	double c[12];
	for (int k = 0; k < COUNT(look); k += SANITISED ? 3 : 1)
		for (int side = SANITISED && k ? 1 : 0; side < (SANITISED && !k ? 1 : 2); side++) {
			struct image image[2];
			double by[W], line[W], sorted[W], uneven = 0;
			int n = 0, dry = 0;
			drive_look(c, &m->of.rig, look[k][0], look[k][1], look[k][2]);
			portrait_pose(p, c);
			struct portrait_view view = portrait_front(&m->of.rig, side, 48, 0, 0, W, H);
			portrait_light(p, &view, true);
			for (int wet = 0; wet < 2; wet++) {
				p->conf.tear_mm = wet ? 0.3 : 1e-5;
				struct image picture = portrait_draw(p, &view);
				image[wet] = portrait_layers(p, &view, &picture);
				image_free(&picture);
			}
			const int samples = p->conf.samples;
			struct portrait_spot *spots = portrait_raster(p, &view, samples);
			for (int x = 0; x < W; x++) {
				int bottom = -1;
				for (int y = samples * H - 1; y >= 0 && bottom < 0; y--)
					for (int i = 0; i < samples; i++)
						bottom = spots[((long)y * W + x) * samples + i].face == -2 - side ? y / samples : bottom;
				if (bottom < 4)
					continue;
				by[n] = line[n] = 0;
				for (int y = bottom - 4; y <= bottom; y++) {
					line[n] += (double)image_at(&image[1], x, y)[PORTRAIT_SPECULAR + 1];
					by[n] += (double)image_at(&image[1], x, y)[PORTRAIT_SPECULAR + 1] - (double)image_at(&image[0], x, y)[PORTRAIT_SPECULAR + 1];
				}
				n++;
			}
			assert_true(n > 40);
			memcpy(sorted, by, sizeof sorted);
			const double median = stats_median(n, sorted);
			for (int i = 2; i + 2 < n; i++) {  // the corners' own columns show a sliver of the eye
				dry += by[i] < 0.05 * median && line[i] < median;  // or the globe, seen along itself, mirrors more than its line
				uneven += fabs(by[i] - by[i - 1]) / (n - 4) / median;
			}
			print_message("tear line, look %g %g, open %g, side %d: %d of %d columns dry, %.2f uneven\n", look[k][0], look[k][1], look[k][2], side, dry, n, uneven);
			assert_int_equal(dry, 0);
			free(spots);
			image_free(&image[0]);
			image_free(&image[1]);
		}
	p->conf.tear_mm = m->tear;
	portrait_free(p);
}

/* Depth of the lake: its slope is the meniscus' own lean. What it absorbs: Beer and Lambert over the way down, a mean over
 * diffuse light refracted into it (by quadrature here), and the way up. */
static void lake_absorbs(void **state)
{
	(void)state;
	const float up[3] = { 0, 0, 1 }, from[3] = { 1, 0, 0 };
	NEAR(portrait_lake_depth(0, 0.4f), 0.4, 1e-6);
	NEAR(portrait_lake_depth(0.4f, 0.4f), 0, 1e-6);
	for (float d = 0.05f; d < 0.4f; d += 0.05f) {
		float n[3];
		portrait_meniscus(n, up, from, d, 0.4f);
		double slope = (double)(portrait_lake_depth(d + 1e-3f, 0.4f) - portrait_lake_depth(d - 1e-3f, 0.4f)) / 2e-3;
		NEAR(slope, (double)(-n[0] / n[2]), 2e-3 * (1 + fabs(slope)));  // differences of floats
	}
	double n = (double)(float)LOOK_FILM_INDEX, way = 0;
	enum { STEPS = 1000 };
	for (int k = 0; k < STEPS; k++)
		way += 1 / sqrt(1 - (k + 0.5) / STEPS / (n * n)) / STEPS;  // over sin^2 of the incidence: cosine-weighted
	NEAR(way, LAKE_LIGHT_WAY, 1e-3);
	const double absorb[3] = { 0.5, 0.05, 0 };
	float straight[3], aslant[3];
	portrait_lake_light(straight, 0.4f, 1, absorb);
	portrait_lake_light(aslant, 0.4f, 0.5f, absorb);
	for (int c = 0; c < 3; c++) {
		NEAR(straight[c], exp(-absorb[c] * 0.4 * (1 + way)), 1e-4);
		NEAR(aslant[c], exp(-absorb[c] * 0.4 * (1 / cos(asin(sqrt(0.75) / n)) + way)), 1e-4);
	}
}

/* Tear fluid that absorbs red darkens red alone, and only where the layer says that a lake stands; the lake is deepest at the
 * inner corner, and nowhere deeper than it is high. */
static void lake_is_deep_at_the_corner(void **state)
{
	struct made *m = *state;
	enum { W = 1000, H = 400 };  // at the corners a pixel of 0.11 mm shows twice as much of the globe
	double c[12], deepest[2] = { 0, 0 };
	struct image image[2], layers = { 0 };
	for (int k = 0; k < 2; k++) {
		struct portrait *p = portrait_of(m, 2);
		p->conf.tear_absorb[0] = k;
		drive_look(c, &m->of.rig, 0, 0, 1);
		portrait_pose(p, c);
		struct portrait_view view = portrait_front(&m->of.rig, -1, 110, 0, 0, W, H);
		portrait_light(p, &view, true);
		image[k] = portrait_draw(p, &view);
		if (k)
			layers = portrait_layers(p, &view, &image[k]);
		assert_true(p->corner_known[0] && p->corner_known[1]);
		const float *near = p->corner[0], far[3] = { near[0] + 15, near[1], near[2] };
		NEAR(portrait_lake_height(p, 0, near), m->tear * (1 + LAKE_RISE), 1e-5);
		NEAR(portrait_lake_height(p, 0, far), m->tear, 1e-5);
		portrait_free(p);
	}
	int darker = 0;
	for (int i = 0; i < W * H; i++) {
		const float *a = image[0].px + 4 * i, *b = image[1].px + 4 * i, lake = layers.px[PORTRAIT_LAYERS * i + PORTRAIT_LAKE];
		int middle = abs(i % W - W / 2) < W / 5;  // the inner corners stand there
		assert_true(a[1] == b[1] && a[2] == b[2] && a[0] >= b[0]);
		assert_true(lake >= 0 && lake <= (float)(m->tear * (1 + LAKE_RISE)) + 1e-6f);
		darker += a[0] > b[0];
		deepest[middle] = fmax(deepest[middle], (double)lake);
	}
	print_message("lake: %d pixels darker, at most %.2f mm deep at the inner corners, %.2f elsewhere\n", darker, deepest[1], deepest[0]);
	assert_true(darker > 50);
	assert_true(deepest[1] > m->tear);
	image_free(&image[0]);
	image_free(&image[1]);
	image_free(&layers);
}

/* A film in an even room: what it mirrors replaces what it keeps from below. And it lies on the inner corners alone. */
static void caruncle_is_wet(void **state)
{
	struct made *m = *state;
	m->wet = 1;
	struct portrait *p = portrait_of(m, 2);
	m->wet = 0;
	struct portrait *dry = portrait_of(m, 2);
	int wet = 0;
	for (int i = 0; i < p->mesh.n; i++) {
		double least = INFINITY;
		for (int s = 0; s < 2; s++) {
			double d[3];
			for (int k = 0; k < 3; k++)
				d[k] = (double)(p->mesh.rest[i][k] - p->corner[s][k]);
			least = fmin(least, vec_norm(d) * 12 / m->of.rig.globe[s].radius);
		}
		wet += p->mesh.wet[i] > 0;
		assert_true(p->mesh.wet[i] >= 0 && p->mesh.wet[i] <= 1 && dry->mesh.wet[i] == 0);
		// Its middle lies so far aside, and skin there up to 6 mm before the globe.
		assert_true(p->mesh.wet[i] == 0 || least < CARUNCLE_END_MM + hypot(CARUNCLE_OFF, 6));
		for (int k = 0; k < 3; k++)
			assert_true(p->mesh.wet[i] > 0 ? p->mesh.albedo[i][k] < dry->mesh.albedo[i][k] : p->mesh.albedo[i][k] == dry->mesh.albedo[i][k]);
	}
	print_message("caruncles: %d vertices moist\n", wet);
	assert_true(wet > 2);
	const float axes[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, n[3] = { 0, 0, -1 }, dir[3] = { 0.6f, 0, 0.8f };
	float rgb[3] = { 0.5f, 0.25f, 0.125f };
	portrait_wet_shade(rgb, p, axes, n, dir, 1, 1);
	double t = asin(0.6 / (double)(float)LOOK_FILM_INDEX), i = asin(0.6), share = 0.5 * (pow(sin(i - t) / sin(i + t), 2) + pow(tan(i - t) / tan(i + t), 2));
	NEAR(rgb[0], 0.5 + share * 0.5, 1e-3);
	NEAR(rgb[2], 0.125 + share * 0.875, 1e-3);
	portrait_free(p);
	portrait_free(dry);
}

static double depth_of(const struct rig_camera *camera, const float x[3])
{
	const double *m = camera->from_target[2];
	return m[0] * (double)x[0] + m[1] * (double)x[1] + m[2] * (double)x[2] + m[3];
}

/* A map that falls evenly to the picture's lower rim: every face that the camera sees leans downwards as steeply, so many px of
 * the map a mm as the camera sees it; without strength nothing changes. */
static void wrinkles_bend_normals(void **state)
{
	enum { SIZE = 1200, AT = -300 };
	static const float slope = 0.02f, open = 0.9f;  // mm a px
	struct made *m = *state;
	char *names[] = { "frown" }, *aus[] = { "smile", "frown" };
	struct wrinkle_maps maps = { .n = 1, .name = names, .folds = (bool[]){ true }, .x0 = AT, .y0 = AT, .px_per_mm = 9, .map = image_new(SIZE, SIZE, 2) };
	for (int i = 0; i < SIZE * SIZE; i++) {
		maps.map.px[2 * i] = -slope * (float)(i / SIZE);
		maps.map.px[2 * i + 1] = open;
	}
	struct portrait *p = portrait_of(m, 2);
	double c[16] = { 0 };
	struct portrait_view view = portrait_front(&m->of.rig, -1, 130, 0, 0, 130, 60);
	struct portrait_sky sky = portrait_sky_of(p, &view);
	portrait_wear(p, &maps, 2, aus);
	portrait_fold_pose(p, c);
	assert_false(p->folded);
	c[SKIN_EYE_INPUTS + 1] = 0.5;
	portrait_fold_pose(p, c);
	assert_true(p->folded);
	int n = 0, within = 0;
	double *off = calloc((size_t)p->mesh.n_faces, sizeof *off);
	for (int f = 0; f < p->first_lash; f++) {
		float normal[3], light[3] = { 1, 1, 1 }, third[3] = { 1 / 3.f, 1 / 3.f, 1 / 3.f };
		const int32_t *v = p->mesh.faces[f];
		double e[2][3], flat[3];
		for (int k = 0; k < 3; k++) {
			e[0][k] = (double)(p->mesh.x[v[1]][k] - p->mesh.x[v[0]][k]);
			e[1][k] = (double)(p->mesh.x[v[2]][k] - p->mesh.x[v[0]][k]);
		}
		vec_cross(flat, e[0], e[1]);
		if (vec_norm(flat) < 1e-9 || flat[2] < 0.97 * vec_norm(flat))
			continue;  // seen from in front alone
		for (int k = 0; k < 3; k++)
			normal[k] = (float)(flat[k] / vec_norm(flat));
		if (!portrait_fold(normal, light, p, &sky, f, third))
			continue;
		double along = ((double)normal[0] * flat[0] + (double)normal[1] * flat[1] + (double)normal[2] * flat[2]) / vec_norm(flat);
		double want = 0.5 * (double)slope * m->of.rig.camera.focal_px[0] / depth_of(&m->of.rig.camera, p->mesh.x[v[0]]);
		off[n] = tan(acos(fmin(1, along))) / want - 1;
		within += fabs(off[n]) < 0.1;
		assert_true((double)normal[1] < flat[1] / vec_norm(flat));
		for (int k = 0; k < 3; k++)
			NEAR(light[k], 1 - 0.5 * (1 - (double)open), 0.12);
		n++;
	}
	assert_true(n > 100);
	// foreshortening of faces turned by up to 14 degrees; where skin is bent most, vertices between others bulge out of its chart
	NEAR(stats_median(n, off), 0, 0.03);
	assert_true(within > 0.9 * n);
	free(off);
	portrait_free(p);
	image_free(&maps.map);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(wrinkles_bend_normals),
		cmocka_unit_test(the_line_is_continuous),
		cmocka_unit_test(even_light_is_one),
		cmocka_unit_test(no_holes),
		cmocka_unit_test(eyes_are_where_they_are),
		cmocka_unit_test(same_bytes_on_any_number_of_threads),
		cmocka_unit_test(meniscus),
		cmocka_unit_test(lake_absorbs),
		cmocka_unit_test(lake_is_deep_at_the_corner),
		cmocka_unit_test(caruncle_is_wet),
		cmocka_unit_test(layers_make_the_picture),
		cmocka_unit_test(distances_are_to_the_lids),
		cmocka_unit_test(tears_stay_at_the_lids),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
