#include "canvas.h"

#include <stdlib.h>

#include "scene.h"

struct canvas canvas_new(int width, int height)
{
	const size_t n = (size_t)width * (size_t)height;
	return (struct canvas){ .width = width, .height = height, .rgb = calloc(3 * n, sizeof(float)), .hair = calloc(n, sizeof(float)),
		.mirror = calloc(n, sizeof(float)), .body = calloc(n, sizeof(float)), .label = calloc(n, 1), .mm = 1 };
}

void canvas_free(struct canvas *c)
{
	free(c->rgb);
	free(c->hair);
	free(c->mirror);
	free(c->body);
	free(c->label);
	*c = (struct canvas){ 0 };
}

void canvas_view(struct canvas *c, float u, float v, float x, float y, float mm, float turn, bool mirrored)
{
	const float co = cosf(turn), si = sinf(turn), f = mirrored ? -1 : 1;
	c->mm = mm;
	c->m[0][0] = f * mm * co;
	c->m[0][1] = f * mm * si;
	c->m[1][0] = mm * si;
	c->m[1][1] = -mm * co;
	const float det = c->m[0][0] * c->m[1][1] - c->m[0][1] * c->m[1][0];
	c->inv[0][0] = c->m[1][1] / det;
	c->inv[0][1] = -c->m[0][1] / det;
	c->inv[1][0] = -c->m[1][0] / det;
	c->inv[1][1] = c->m[0][0] / det;
	c->at[0] = u - c->m[0][0] * x - c->m[0][1] * y;
	c->at[1] = v - c->m[1][0] * x - c->m[1][1] * y;
}

void canvas_px(float px[2], const struct canvas *c, float u, float v)
{
	const float du = u - c->at[0], dv = v - c->at[1];
	px[0] = c->inv[0][0] * du + c->inv[0][1] * dv;
	px[1] = c->inv[1][0] * du + c->inv[1][1] * dv;
}

/* One straight piece, px; widths at both ends, px. */
static void piece(struct canvas *c, const float a[2], const float b[2], float wide_a, float wide_b, const float rgb[3], float opacity)
{
	const float reach = 0.5F * fmaxf(wide_a, wide_b) + 1;
	const int x0 = (int)fmaxf(fminf(a[0], b[0]) - reach, 0), x1 = (int)fminf(fmaxf(a[0], b[0]) + reach, (float)c->width - 1);
	const int y0 = (int)fmaxf(fminf(a[1], b[1]) - reach, 0), y1 = (int)fminf(fmaxf(a[1], b[1]) + reach, (float)c->height - 1);
	const float dx = b[0] - a[0], dy = b[1] - a[1], length = dx * dx + dy * dy + 1e-6F;
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			const float ex = (float)x + 0.5F - a[0], ey = (float)y + 0.5F - a[1], t = (ex * dx + ey * dy) / length;
			// Each piece ends where the next begins.
			if (t < 0 || t >= 1)
				continue;
			const float off = fabsf(ex * dy - ey * dx) / sqrtf(length), wide = wide_a + t * (wide_b - wide_a);
			float cover = fminf(wide, 1) * fminf(fmaxf(0.5F + 0.5F * fmaxf(wide, 1) - off, 0), 1) * opacity;
			if (cover <= 0)
				continue;
			const long i = (long)y * c->width + x;
			c->hair[i] = 1 - (1 - c->hair[i]) * (1 - cover);
			for (int k = 0; k < 3; k++)
				c->rgb[3 * i + k] += cover * (rgb[k] - c->rgb[3 * i + k]);
		}
}

void canvas_hair(struct canvas *c, const float p[3][2], float width, const float rgb[3], float opacity)
{
	float q[3][2], least[2] = { 1e9F, 1e9F }, most[2] = { -1e9F, -1e9F };
	for (int i = 0; i < 3; i++) {
		canvas_px(q[i], c, p[i][0], p[i][1]);
		for (int k = 0; k < 2; k++) {
			least[k] = fminf(least[k], q[i][k]);
			most[k] = fmaxf(most[k], q[i][k]);
		}
	}
	if (most[0] < 0 || most[1] < 0 || least[0] > (float)c->width || least[1] > (float)c->height)
		return;
	const float size = fmaxf(most[0] - least[0], most[1] - least[1]), wide = width / c->mm;
	const int n = size < 4 ? 1 : size < 15 ? 3 : size < 60 ? 6 : 10;
	float a[2] = { q[0][0], q[0][1] };
	for (int i = 1; i <= n; i++) {
		const float t = (float)i / (float)n, s = 1 - t;
		const float b[2] = { s * s * q[0][0] + 2 * s * t * q[1][0] + t * t * q[2][0], s * s * q[0][1] + 2 * s * t * q[1][1] + t * t * q[2][1] };
		piece(c, a, b, wide * (1 - 0.67F * (float)(i - 1) / (float)n), wide * (1 - 0.67F * t), rgb, opacity);
		a[0] = b[0];
		a[1] = b[1];
	}
}

void canvas_label_hair(struct canvas *c)
{
	for (long i = 0; i < (long)c->width * c->height; i++)
		if (c->hair[i] > 0.5F)
			c->label[i] = EVIDENCE_LASH;
}
