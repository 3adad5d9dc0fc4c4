#include "tests/lib/unseen/altered.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

const char *const altered_kind[ALTERED_KINDS] = { "mirrored", "turned by steps of 15 deg", "cropped", "half size", "2800 to 8000 K", "+- 1.5 EV" };

struct altered altered_all(int i)
{
	static const double kelvin[4] = { 2800, 3600, 5000, 8000 };
	if (i == 0)
		return (struct altered){ ALTERED_MIRRORED, 0 };
	if (i < 24)
		return (struct altered){ ALTERED_TURNED, i * M_PI / 12 };
	if (i < 26)
		return (struct altered){ ALTERED_CROPPED, i == 24 ? 0.5 : 0.15 };
	if (i == 26)
		return (struct altered){ ALTERED_HALF, 0 };
	return i < 31 ? (struct altered){ ALTERED_LIGHT, kelvin[i - 27] } : (struct altered){ ALTERED_EXPOSED, i == 31 ? -1.5 : 1.5 };
}

static struct photo blank(const struct photo *like, int width, int height)
{
	struct photo p = *like;
	p.width = width;
	p.height = height;
	p.rgb = mem_array((size_t)width * (size_t)height * 3, sizeof *p.rgb);
	return p;
}

static double cubic(double t)
{
	t = fabs(t);
	return t < 1 ? 1 - 2.5 * t * t + 1.5 * t * t * t : t < 2 ? 2 - 4 * t + 2.5 * t * t - 0.5 * t * t * t : 0;
}

/* Catmull and Rom's interpolation; beyond the picture its margin goes on. */
static void sample(uint16_t out[3], const struct photo *p, double x, double y)
{
	const int i = (int)floor(x - 0.5), j = (int)floor(y - 0.5);
	double sum[3] = { 0 };
	for (int k = -1; k <= 2; k++)
		for (int l = -1; l <= 2; l++) {
			const int u = i + l < 0 ? 0 : i + l >= p->width ? p->width - 1 : i + l, v = j + k < 0 ? 0 : j + k >= p->height ? p->height - 1 : j + k;
			const double w = cubic(x - 0.5 - (i + l)) * cubic(y - 0.5 - (j + k));
			for (int c = 0; c < 3; c++)
				sum[c] += w * p->rgb[3 * ((long)v * p->width + u) + c];
		}
	for (int c = 0; c < 3; c++)
		out[c] = (uint16_t)(257 * lround(fmin(fmax(sum[c], 0), 65535) / 257));
}

static double decoded(double v)
{
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static uint16_t encoded(double v)
{
	v = fmin(v, 1);
	return (uint16_t)(257 * lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055)));
}

/* Gains of linear red, green, blue; the brightness of white stays for another light. */
static void gains(double gain[3], const struct altered *how)
{
	static const double metres[3] = { 610e-9, 545e-9, 465e-9 }, luma[3] = { 0.2126, 0.7152, 0.0722 };
	double sum = 0;
	for (int c = 0; c < 3; c++) {
		const double x = 0.014388 / metres[c];
		gain[c] = how->kind == ALTERED_EXPOSED ? exp2(how->amount) : (exp(x / 6500) - 1) / (exp(x / how->amount) - 1);
		sum += luma[c] * gain[c];
	}
	for (int c = 0; c < 3 && how->kind == ALTERED_LIGHT; c++)
		gain[c] /= sum;
}

/* Corners of the crop: the limbus with a margin, and a share of what is left on every side. */
static void crop(int box[4], const struct photo *p, const struct altered *how, const struct ellipse *e)
{
	const double reach = 1.15 * e->a, low[2] = { e->cx - reach, e->cy - reach }, high[2] = { e->cx + reach, e->cy + reach }, all[2] = { p->width, p->height };
	for (int k = 0; k < 2; k++) {
		box[k] = (int)(fmax(low[k], 0) * (1 - how->amount));
		box[2 + k] = (int)ceil(all[k] - (all[k] - fmin(high[k], all[k])) * (1 - how->amount));
	}
}

struct photo altered_photo(const struct photo *photo, const struct altered *how, const struct ellipse *about)
{
	int box[4] = { 0, 0, photo->width, photo->height };
	const int shrink = how->kind == ALTERED_HALF ? 2 : 1;
	double gain[3] = { 1, 1, 1 };
	if (how->kind == ALTERED_CROPPED)
		crop(box, photo, how, about);
	if (how->kind >= ALTERED_LIGHT)
		gains(gain, how);
	struct photo out = blank(photo, (box[2] - box[0]) / shrink, (box[3] - box[1]) / shrink);
	const double co = cos(how->amount), si = sin(how->amount);
	for (int y = 0; y < out.height; y++)
		for (int x = 0; x < out.width; x++) {
			uint16_t *to = out.rgb + 3 * ((long)y * out.width + x);
			const uint16_t *from = photo->rgb + 3 * ((long)(y * shrink + box[1]) * photo->width + x * shrink + box[0]);
			const double dx = x + 0.5 - about->cx, dy = y + 0.5 - about->cy;
			if (how->kind == ALTERED_TURNED)
				sample(to, photo, about->cx + co * dx + si * dy, about->cy + co * dy - si * dx);
			else if (how->kind == ALTERED_MIRRORED)
				memcpy(to, photo->rgb + 3 * ((long)y * photo->width + photo->width - 1 - x), 3 * sizeof *to);
			else
				for (int c = 0; c < 3; c++) {
					const uint16_t *below = from + 3L * photo->width;
					to[c] = how->kind == ALTERED_HALF ? (uint16_t)(257 * ((from[c] + from[c + 3] + below[c] + below[c + 3]) / 4 / 257))
					        : how->kind >= ALTERED_LIGHT ? encoded(gain[c] * decoded(from[c] / 65535.0)) : from[c];
				}
		}
	return out;
}

struct ellipse altered_ellipse(const struct ellipse *e, const struct photo *photo, const struct altered *how, const struct ellipse *about)
{
	struct ellipse out = *e;
	int box[4];
	const double dx = e->cx - about->cx, dy = e->cy - about->cy, co = cos(how->amount), si = sin(how->amount);
	switch (how->kind) {
	case ALTERED_MIRRORED:
		out.cx = photo->width - e->cx;
		out.angle = M_PI - e->angle;
		break;
	case ALTERED_TURNED:
		out.cx = about->cx + co * dx - si * dy;
		out.cy = about->cy + si * dx + co * dy;
		out.angle += how->amount;
		break;
	case ALTERED_CROPPED:
		crop(box, photo, how, about);
		out.cx -= box[0];
		out.cy -= box[1];
		break;
	case ALTERED_HALF:
		out = (struct ellipse){ e->cx / 2, e->cy / 2, e->a / 2, e->b / 2, e->angle };
		break;
	default: break;
	}
	return out;
}
