#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "tests/lib/unseen/unseen_impl.h"

/* $UNSEEN_KEEP/SEED_NUMBER_WIDTHxHEIGHT; null: nothing is kept. free(). */
static char *path_of(uint64_t seed, int i, int width, int height)
{
	const char *dir = getenv("UNSEEN_KEEP");
	return dir && *dir ? mem_printf("%s/%llu_%d_%dx%d", dir, (unsigned long long)seed, i, width, height) : 0;
}

bool unseen_kept(struct unseen *u, uint64_t seed, int i, int width, int height)
{
	char *path = path_of(seed, i, width, height);
	FILE *f = path ? fopen(path, "rb") : 0;
	free(path);
	if (!f)
		return false;
	bool ok = fread(u, sizeof *u, 1, f) == 1;
	const size_t n = ok ? 3 * (size_t)u->photo.width * (size_t)u->photo.height : 0;
	uint8_t *rgb = mem_array(n + 1, 1);
	ok = ok && fread(rgb, 1, n, f) == n;
	if (ok)
		u->photo = unseen_photo(rgb, u->photo.width, u->photo.height);
	free(rgb);
	fclose(f);
	return ok;
}

void unseen_keep(const struct unseen *u, uint64_t seed, int i, int width, int height)
{
	char *path = path_of(seed, i, width, height), *beside = path ? mem_printf("%s.new", path) : 0;
	FILE *f = path ? fopen(beside, "wb") : 0;
	if (f) {
		bool ok = fwrite(u, sizeof *u, 1, f) == 1;
		for (long k = 0; k < 3L * u->photo.width * u->photo.height; k++)
			ok = ok && putc(u->photo.rgb[k] >> 8, f) != EOF;
		if (fclose(f) || !ok || rename(beside, path))
			remove(beside);
	}
	free(path);
	free(beside);
}
