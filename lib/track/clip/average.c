#include "track/clip/average.h"

#include <math.h>
#include <stdbool.h>

#include "base/mem.h"

/* mm. Skin lies in front of the eyeballs' centres by about an eyeball's radius between the eyes, and level with them at the temples' edge of the orbit: eyes stand 16 mm
 * out of it (Hertel; Migliori and Gladstone 1984), which is what the cornea does of its centre and some. */
static const double between = 12, fall = 0.005;  // z = between - fall x^2
static const double wide = 66, high = 44, step = 2;
static const double nose_wide = 14, nose_top = -8;

static bool is_nose(double x, double y)
{
	return fabs(x) < nose_wide && y < nose_top;
}

void average_skin(struct mesh *mesh, double half_apart)
{
	const int columns = (int)(2 * wide / step) + 1, rows = (int)(2 * high / step) + 1;
	const double size = half_apart / 31.5;
	*mesh = (struct mesh){ .vertices = mem_new((size_t)columns * (size_t)rows, sizeof *mesh->vertices),
		                   .faces = mem_new(2 * (size_t)columns * (size_t)rows, sizeof *mesh->faces), .n_vertices = columns * rows };
	for (int i = 0; i < rows; i++)
		for (int k = 0; k < columns; k++) {
			const double x = -wide + step * k, y = -high + step * i, at[3] = { x, y, between - fall * x * x };
			const int32_t a = i * columns + k, b = a + 1, c = a + columns, d = c + 1;
			for (int m = 0; m < 3; m++)
				mesh->vertices[a][m] = (float)(size * at[m]);
			if (i + 1 == rows || k + 1 == columns || is_nose(x + 0.5 * step, y + 0.5 * step))
				continue;
			const int32_t face[2][3] = { { a, b, d }, { a, d, c } };
			for (int f = 0; f < 2; f++, mesh->n_faces++)
				for (int m = 0; m < 3; m++)
					mesh->faces[mesh->n_faces][m] = face[f][m];
		}
}
