#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "tests/lib/truth/truth.h"
#include "tests/lib/unseen/altered.h"
#include "tests/lib/unseen/unseen.h"

enum { FOLDERS = 1000 };

static int is_whole(const struct dirent *d)
{
	char *done = mem_printf("%s/%s/truth.json", getenv("EYEWRIGHT_TRACED"), d->d_name);
	const bool is = d->d_name[0] != '.' && file_exists(done);
	free(done);
	return is;
}

/* Names in order; *n of them. */
static struct dirent **folders(int *n)
{
	struct dirent **list = 0;
	*n = getenv("EYEWRIGHT_TRACED") ? scandir(getenv("EYEWRIGHT_TRACED"), &list, is_whole, alphasort) : 0;
	return list;
}

static void release(int n, struct dirent **list)
{
	for (int i = 0; i < n; i++)
		free(list[i]);
	free(list);
}

int unseen_traced_count(void)
{
	int n;
	struct dirent **list = folders(&n);
	release(n, list);
	return n > 0 ? 2 * n : 0;
}

bool unseen_traced(struct unseen *u, int k)
{
	int n;
	struct dirent **list = folders(&n);
	char *dir = mem_printf("%s/%s", getenv("EYEWRIGHT_TRACED"), list[k / 2]->d_name);
	struct truth truth;
	struct err err = { 0 };
	const bool ok = truth_load(&truth, dir, &err) && photo_load(&u->photo, truth.photo, 100, &err);
	if (ok) {
		u->maker = UNSEEN_TRACED;
		u->n = 1;
		u->aspect = 1;
		u->warmth = 1;
		u->opening = 1 - truth.covered;
		u->eye[0] = (struct unseen_eye){ truth.limbus, truth.pupil, 1 - truth.covered, truth.theta };
		if (k % 2) {
			const struct altered tungsten = { ALTERED_LIGHT, 2900 };
			struct photo warm = altered_photo(&u->photo, &tungsten, &truth.limbus);
			photo_free(&u->photo);
			u->photo = warm;
			u->warmth = 3;
		}
	} else {
		fprintf(stderr, "%s\n", err.msg);
	}
	free(dir);
	release(n, list);
	return ok;
}
