/* import FOLDER NAME: reads a character as transfer does, with its limits, and prints what it has, seconds, and MiB at most, each of the process of
 * its own that reads, and of this one; below that the means of places, of texture coordinates over corners of what has a picture, and of the first blend shape's displacements. */
#include <stdio.h>
#include <sys/resource.h>
#include <time.h>

#include "character/import.h"

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double most_mib(int whose)
{
	struct rusage u;
	getrusage(whose, &u);
	return (double)u.ru_maxrss / 1024;
}

static double processor_s(int whose)
{
	struct rusage u;
	getrusage(whose, &u);
	return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) + 1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static void print_means(const struct mesh *mesh, const struct look *l)
{
	double x[3] = { 0 }, uv[2] = { 0 }, by[3] = { 0 };
	long n = 0;
	const int moved = l->n_shapes ? l->shape_start[1] : 0;
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int d = 0; d < 3; d++)
			x[d] += (double)mesh->vertices[i][d] / mesh->n_vertices;
	for (int f = 0; f < l->n_faces; f++)
		for (int k = 0; k < 3 && l->face_material[f] >= 0 && l->material[l->face_material[f]].map[LOOK_COLOUR] >= 0; k++, n++)
			for (int d = 0; d < 2; d++)
				uv[d] += (double)l->uv[l->corner[f][k]][d];
	for (int i = 0; i < moved; i++)
		for (int d = 0; d < 3; d++)
			by[d] += (double)l->shape_by[i][d] / moved;
	printf("place %.6f %.6f %.6f uv %.5f %.5f shape %.6f %.6f %.6f\n", x[0], x[1], x[2], uv[0] / (double)n, uv[1] / (double)n, by[0], by[1], by[2]);
}

int main(int argc, char **argv)
{
	const struct character_limits limits = { 2000000, 20, 1536 };  // config/transfer.conf
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	const double from = now();
	if (argc != 3 || !character_import(&mesh, &look, argv[1], argv[2], &limits, &err)) {
		fprintf(stderr, "import: %s\n", argc == 3 ? err.msg : "FOLDER NAME");
		return 1;
	}
	printf("%d vertices %d faces %d textures %.2f s by the clock %.2f %.2f s of processors %.0f %.0f MiB\n", mesh.n_vertices, mesh.n_faces, look.n_textures,
	       now() - from, processor_s(RUSAGE_CHILDREN), processor_s(RUSAGE_SELF), most_mib(RUSAGE_CHILDREN),
	       most_mib(RUSAGE_SELF));
	print_means(&mesh, &look);
	mesh_free(&mesh);
	look_free(&look);
	return 0;
}
