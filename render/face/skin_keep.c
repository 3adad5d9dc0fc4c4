/* Keeps pictures that do not depend on render.gaze and render.aperture when only these change. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/asked.h"
#include "base/call.h"
#include "base/mem.h"
#include "render/face/skin.h"

static const uint64_t MOST = (uint64_t)16 << 30;  // bytes of a file that is hashed

/* Hash of program, configuration without gaze and aperture, and inputs. False where one of them cannot be read. */
static bool key_of(char key[33], struct skin_job *job, int n, const char *const in[])
{
	static const char *const typed[] = { "gaze = ", "aperture = ", "render.gaze = ", "render.aperture = " };
	char *text = 0, *slice = 0, hash[33], *program = call_program_path();
	size_t size = 0, slice_size = 0;
	struct err none = { 0 };
	FILE *out = open_memstream(&text, &size), *conf = open_memstream(&slice, &slice_size);
	bool ok = file_hash(hash, program, MOST, &none);
	fputs(hash, out);
	opt_print(conf, job->stage->name, job->stage->n_opts, job->stage->opts, &job->stage->conf);
	fclose(conf);
	for (char *line = strtok(slice, "\n"); line; line = strtok(0, "\n")) {
		bool skip = false;
		for (int k = 0; k < COUNT(typed); k++)
			skip = skip || !strncmp(line, typed[k], strlen(typed[k]));
		if (!skip)
			fprintf(out, "\n%s", line);
	}
	for (int i = 0; i < n; i++) {
		const char *path = stage_path(job->stage, "%s", in[i]);
		bool there = file_exists(path);
		ok = ok && (!there || file_hash(hash, path, MOST, &none));
		fprintf(out, "\n%s %s", in[i], there ? hash : "-");
	}
	fclose(out);
	file_hash_bytes(key, text, size);
	free(text);
	free(slice);
	free(program);
	return ok;
}

/* work/.made/render_NAME_clip.mp4.key */
static const char *key_path(struct skin_job *job, const char *rel)
{
	const char *name = strrchr(rel, '/');
	return stage_path(job->stage, "work/.made/%s_%s.key", job->stage->name, name ? name + 1 : rel);
}

/* The key, and the hash of what was made with it. */
static bool label_of(char label[67], struct skin_job *job, const char *rel, int n, const char *const in[])
{
	char key[33], out[33];
	struct err none = { 0 };
	const char *path = stage_path(job->stage, "%s", rel);
	if (!file_exists(path) || !key_of(key, job, n, in) || !file_hash(out, path, MOST, &none))
		return false;
	snprintf(label, 67, "%s %s", key, out);
	return true;
}

bool skin_kept(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err)
{
	char label[67], *was = 0;
	size_t size;
	struct err none = { 0 };
	if (stage_fresh(job->stage, rel, n, in))
		return true;
	if (job->stage->force || !label_of(label, job, rel, n, in))
		return false;
	bool same = file_read(&was, &size, key_path(job, rel), 256, &none) && !strcmp(was, label);
	free(was);
	return same && stage_made(job->stage, rel, n, in, err);
}

bool skin_made(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err)
{
	char label[67];
	// The key first: what is recorded as made is not looked at again, and would stay without one if this ends in between.
	const bool kept = asked_trouble() || !label_of(label, job, rel, n, in) || file_write(key_path(job, rel), label, strlen(label), err);
	return kept && stage_made(job->stage, rel, n, in, err);
}
