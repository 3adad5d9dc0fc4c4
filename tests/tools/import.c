/* import FOLDER NAME: reads a character as transfer does, with its limits, and prints what it has, seconds, and MiB at most, each of the process of
 * its own that reads, and of this one. */
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
	mesh_free(&mesh);
	look_free(&look);
	return 0;
}
