/* Portraits of people that are not in the repository: EYEWRIGHT_PORTRAITS=DIR holds NAME.jpg and NAME_mask.jpg, of the same size, irises
 * white on black. Three crops of each eye: the iris alone, loose, the whole region of the eye. Masks are drawn by hand, some 3 % inside the
 * limbus, with lids cut off: right is where both sides of the ellipse are within 4 % of the radius of the mask's, so widened. Where a lid cuts a
 * side off, the limbus lies beyond it: a second count judges by the other one, and by this only that it is not inside. LOOKING=NAME,...
 * names those who look into the lens: their tilt ought to be none. Measures only; writes nothing of the pictures.
 */
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/unseen/answer.h"
#include "tests/lib/unseen/crew.h"

enum { EYES_MAX = 256, CROPS = 3 };
static const double reach[CROPS] = { 1.3, 2, 3.5 }, widened = 1.03, allowed = 0.04;  // of the radius
static const double arc_reach = 0.35, arc_sagitta = 0.13;           // of half the width: a circle's sagitta is 0.063
static const char *const crop_name[CROPS] = { "tight", "loose", "the eye's region" };

struct iris { char name[64]; double x, y, side[2], radius; bool looks, limbus[2]; };  // side: x of its left and right; whether they are limbus
struct result { bool ok, right, shown; double theta, sigma, seconds; };  // shown: right where the sides are limbus, refused or not
struct portraits { const char *dir; int n; struct iris iris[EYES_MAX]; struct result (*result)[CROPS]; };

static bool load(struct photo *photo, const char *dir, const char *name, const char *tail)
{
	struct err err = { 0 };
	char *path = mem_printf("%s/%s%s.jpg", dir, name, tail);
	const bool ok = photo_load(photo, path, 100, &err);
	free(path);
	return ok;
}

/* Columns of the first and last px of a region in each row of the mask. */
struct rows { int *first, *last; };

/* One connected white region from px (x, y): its pixels are made black. rows: of its rows, overwritten. */
static void region(struct photo *mask, int x, int y, int box[4], long *count, struct rows *rows)
{
	long n = 0, room = 1 << 12, *stack = mem_array((size_t)room, sizeof *stack);
	stack[n++] = (long)y * mask->width + x;
	while (n) {
		const long at = stack[--n];
		const int u = (int)(at % mask->width), v = (int)(at / mask->width);
		if (mask->rgb[3 * at + 1] < 32768)
			continue;
		mask->rgb[3 * at + 1] = 0;
		const bool new_row = ++*count == 1 || v < box[1] || v > box[3];
		rows->first[v] = new_row || u < rows->first[v] ? u : rows->first[v];
		rows->last[v] = new_row || u > rows->last[v] ? u : rows->last[v];
		box[0] = u < box[0] ? u : box[0];
		box[1] = v < box[1] ? v : box[1];
		box[2] = u > box[2] ? u : box[2];
		box[3] = v > box[3] ? v : box[3];
		if (n + 4 >= room)
			stack = mem_grow(stack, (size_t)(room *= 2), sizeof *stack);
		if (u > 0)
			stack[n++] = at - 1;
		if (u + 1 < mask->width)
			stack[n++] = at + 1;
		if (v > 0)
			stack[n++] = at - mask->width;
		if (v + 1 < mask->height)
			stack[n++] = at + mask->width;
	}
	free(stack);
}

static bool named(const char *list, const char *name)
{
	const size_t n = strlen(name);
	for (const char *at = list; at && *at; at = strchr(at, ',') ? strchr(at, ',') + 1 : "")
		if (!strncmp(at, name, n) && (at[n] == ',' || !at[n]))
			return true;
	return false;
}

/* Whether the outline at[] of a region, in the rows of box, is an arc of a circle of some `half` px where it reaches `end`: where a lid or the corner of
 * the eye cuts the iris, the outline turns sharply there. */
static bool is_arc(const int *at, int end, const int box[4], double half)
{
	int from = -1, to = -1;
	for (int v = box[1]; v <= box[3]; v++)
		if (at[v] == end) {
			from = from < 0 ? v : from;
			to = v;
		}
	const double up = 0.5 * (from + to) - arc_reach * half, down = 0.5 * (from + to) + arc_reach * half;
	if (up < box[1] || down > box[3])
		return false;
	return fmax(abs(at[(int)up] - end), abs(at[(int)down] - end)) < arc_sagitta * half;
}

/* Irises of one mask: the two largest regions. */
static void irises(struct portraits *p, const char *name)
{
	struct photo mask, photo;
	if (!load(&mask, p->dir, name, "_mask"))
		return;
	if (!load(&photo, p->dir, name, "") || photo.width != mask.width || photo.height != mask.height) {
		fprintf(stderr, "%s: photograph and mask are not of one size\n", name);
		photo_free(&mask);
		return;
	}
	photo_free(&photo);
	struct rows rows = { mem_array((size_t)mask.height, sizeof *rows.first), mem_array((size_t)mask.height, sizeof *rows.last) };
	for (int y = 0; y < mask.height; y++)
		for (int x = 0; x < mask.width; x++) {
			int box[4] = { x, y, x, y };
			long count = 0;
			if (mask.rgb[3 * ((long)y * mask.width + x) + 1] < 32768)
				continue;
			region(&mask, x, y, box, &count, &rows);
			const double wide = box[2] + 1 - box[0], high = box[3] + 1 - box[1];
			if (wide < 20 || high < 0.3 * wide || high > 1.3 * wide || (double)count < 0.5 * wide * high || p->n == EYES_MAX)
				continue;
			struct iris *i = &p->iris[p->n++];
			snprintf(i->name, sizeof i->name, "%.63s", name);
			i->x = box[0] + 0.5 * wide;
			i->y = box[1] + 0.5 * high;
			i->radius = 0.5 * wide * widened;
			i->side[0] = i->x - i->radius;
			i->side[1] = i->x + i->radius;
			i->limbus[0] = is_arc(rows.first, box[0], box, 0.5 * wide);
			i->limbus[1] = is_arc(rows.last, box[2], box, 0.5 * wide);
			i->looks = named(getenv("LOOKING"), name);
		}
	free(rows.first);
	free(rows.last);
	photo_free(&mask);
}

static struct photo cut(const struct photo *photo, const struct iris *i, double reaches, double at[2])
{
	const int x0 = (int)fmax(i->x - reaches * i->radius, 0), y0 = (int)fmax(i->y - reaches * i->radius, 0);
	const int x1 = (int)fmin(i->x + reaches * i->radius, photo->width), y1 = (int)fmin(i->y + reaches * i->radius, photo->height);
	struct photo out = *photo;
	out.width = x1 - x0;
	out.height = y1 - y0;
	out.rgb = mem_array((size_t)out.width * (size_t)out.height * 3, sizeof *out.rgb);
	for (int y = 0; y < out.height; y++)
		memcpy(out.rgb + 3L * y * out.width, photo->rgb + 3 * ((long)(y + y0) * photo->width + x0), 3 * sizeof *out.rgb * (size_t)out.width);
	at[0] = x0;
	at[1] = y0;
	return out;
}

/* Where the ellipse's row through its centre ends to the left and right: extents of the ellipse along x. */
static double half_width(const struct ellipse *e)
{
	return hypot(e->a * cos(e->angle), e->b * sin(e->angle));
}

/* Whether ellipses that are known roughly count as taken, as the stage uses them for want of a better. */
static bool roughly;

static void one(void *ctx, int eye)
{
	struct portraits *p = ctx;
	const struct iris *i = &p->iris[eye];
	struct photo photo;
	if (!load(&photo, p->dir, i->name, ""))
		return;
	for (int c = 0; c < CROPS; c++) {
		double at[2];
		struct photo crop = cut(&photo, i, reach[c], at);
		struct answer a;
		answer_ours(&a, &crop, NAN);
		const bool taken = a.ok || (roughly && a.rough > 0 && a.rough <= ANSWER_ROUGH);
		const double x = a.e.cx + at[0], y = a.e.cy + at[1], w = half_width(&a.e), most = allowed * i->radius;
		// The mask's height is the lids': of y it tells only that the centre is within the iris.
		const double off[2] = { i->side[0] - (x - w), x + w - i->side[1] };  // outwards
		const bool within = a.e.a > 0 && fabs(y - i->y) < 0.6 * i->radius, right = taken && within && fabs(off[0]) < most && fabs(off[1]) < most;
		bool shown = within && (i->limbus[0] || i->limbus[1]);
		for (int k = 0; k < 2; k++)
			shown = shown && off[k] > -most && (!i->limbus[k] || off[k] < most);
		p->result[eye][c] = (struct result){ taken, right, shown, a.theta, a.theta_sigma, a.seconds };
		photo_free(&crop);
	}
	photo_free(&photo);
}

/* goals: of an ellipse that may be off by as much as is allowed here. */
static void report(const struct portraits *p, const char *method, bool goals)
{
	int right = 0, wrong = 0, n = 0, off = 0, looking = 0;
	double *tilt = mem_array((size_t)(CROPS * p->n), sizeof *tilt);
	printf("%s\n%-20s %6s %6s %6s %8s   %s\n", method, "", "n", "right", "WRONG", "refused", "right by the sides that are limbus: taken, refused");
	for (int c = 0; c < CROPS; c++) {
		int count[3] = { 0 }, shown[2] = { 0 };
		for (int e = 0; e < p->n; e++) {
			const struct result *r = &p->result[e][c];
			count[r->right ? 0 : r->ok ? 1 : 2]++;
			shown[r->ok] += r->shown;
			if (p->iris[e].radius >= 45) {
				n++;
				right += r->right;
				wrong += r->ok && !r->right;
			}
			if (p->iris[e].looks && r->ok) {
				tilt[looking++] = r->theta * 180 / M_PI;
				off += !(r->theta <= 2 * r->sigma);
			}
		}
		printf("%-20s %6d %6d %6d %8d   %4d, %d\n", crop_name[c], p->n, count[0], count[1], count[2], shown[1], shown[0]);
		bench_row("portraits, wrong but called ok", method, crop_name[c], (struct bench_time){ NAN, NAN, NAN }, "photograph", 100.0 * count[1] / p->n, "%", "of all");
	}
	if (looking)
		printf("of %d crops of those who look into the lens: median tilt %.1f deg, %d within two sigmas of the front\n", looking, stats_median(looking, tilt), looking - off);
	if (goals) {
		bench_goal("portraits, radius 45 px or more: right", ">= 80 %", 100.0 * right / n, "%", right >= 0.8 * n);
		bench_goal("portraits, radius 45 px or more: wrong but called ok", "<= 3 %", 100.0 * wrong / n, "%", wrong <= 0.03 * n);
	}
	if (goals && looking)
		bench_goal("portraits that look into the lens: within 2 sigma of frontal", ">= 90 %", 100.0 * (looking - off) / looking, "%", off <= 0.1 * looking);
	free(tilt);
}

int main(int argc, char **argv)
{
	bench_open("limbus_portraits", argc, argv);
	struct portraits *p = mem_new(1, sizeof *p);
	p->dir = getenv("EYEWRIGHT_PORTRAITS");
	DIR *dir = p->dir ? opendir(p->dir) : 0;
	char *names[1000];
	int n = 0;
	for (struct dirent *d; dir && n < 1000 && (d = readdir(dir));) {
		char *tail = strstr(d->d_name, "_mask.jpg");
		if (tail)
			names[n++] = mem_printf("%.*s", (int)(tail - d->d_name), d->d_name);
	}
	if (dir)
		closedir(dir);
	for (int i = 0; i < n; i++) {
		irises(p, names[i]);
		free(names[i]);
	}
	int cut_off = 0;
	for (int i = 0; i < p->n; i++)
		cut_off += !p->iris[i].limbus[0] + !p->iris[i].limbus[1];
	if (p->n) {
		printf("%d irises; of their sides %d are lid, not limbus\n", p->n, cut_off);
		p->result = crew_array((size_t)p->n, sizeof *p->result);
		crew_run(p->n, one, p);
		report(p, "ours", false);
		roughly = true;
		crew_run(p->n, one, p);
		report(p, "ours, with those that are used roughly", false);
		roughly = false;
		answer_conf()->tolerance = allowed;
		crew_run(p->n, one, p);
		report(p, "ours, limbus.tolerance = 0.04", true);
	} else {
		printf("no portraits: EYEWRIGHT_PORTRAITS names no folder with NAME.jpg and NAME_mask.jpg; nothing is measured\n");
	}
	free(p);
	return bench_close();
}
