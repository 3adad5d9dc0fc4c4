#include "tests/peers/peer.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/npy/npy.h"

bool peer_installed(const char *bench, const char *module, const char *package)
{
	char *command = mem_printf("/usr/bin/python3 -c 'import %s' >/dev/null 2>&1", module);
	bool there = !system(command);
	free(command);
	if (!there)
		fprintf(stderr, "%s: %s is not installed: apt-get install %s; its rows are left out\n", bench, module, package);
	return there;
}

struct bench_time peer_times(FILE *from)
{
	enum { MOST = 100 };
	double t[MOST];
	int n = 0;
	char line[4000], *at = line;
	if (!from || !fgets(line, sizeof line, from))
		return (struct bench_time){ NAN, NAN, NAN };
	for (char *end; n < MOST; at = end) {
		t[n] = strtod(at, &end);
		if (end == at)
			break;
		n++;
	}
	return n ? bench_time_of(n, t) : (struct bench_time){ NAN, NAN, NAN };
}

double *peer_array(const char *path, long n)
{
	struct npy array;
	struct err err = { 0 };
	if (!npy_read(&array, path, NPY_LIMIT, &err))
		return 0;
	double *x = npy_count(&array) == n ? npy_doubles(&array) : 0;
	npy_free(&array);
	return x;
}
