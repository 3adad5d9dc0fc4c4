#include "track/clip/chunks.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/gate.h"
#include "base/mem.h"

static const char *const anchor = "work/skin/followed-key.part", *const prefix = "followed-", *const suffix = ".part";
static const size_t limit = (size_t)1 << 33;  // bytes of a chunk

/* A file of our own making: no archive and no other machine gives its inode and the nanosecond of its change. Returns false where there can be none. */
static bool anchor_of(long long out[4], struct stage *stage)
{
	struct stat st;
	const int fd = gate_create(stage_path(stage, "%s", anchor), O_WRONLY);
	const bool ok = fd >= 0 && !fstat(fd, &st) && S_ISREG(st.st_mode);
	if (ok) {
		const long long all[4] = { (long long)st.st_dev, (long long)st.st_ino, st.st_ctim.tv_sec, st.st_ctim.tv_nsec };
		memcpy(out, all, sizeof all);
	}
	if (fd >= 0)
		close(fd);
	return ok;
}

bool chunks_wanted(const struct track_clip *clip, const struct track_conf *conf)
{
	return !conf->limit && conf->chunk && clip->info.frames > conf->chunk;
}

struct chunks chunks_of(struct stage *stage, const struct track_clip *clip, const struct track_points *points, const struct track_conf *conf)
{
	struct chunks c = { .stage = stage };
	struct pack p = { .reading = false };
	struct err none = { 0 };
	char program[33];
	long long made[4];
	if (!chunks_wanted(clip, conf) || !clip->made_by || !file_hash(program, "/proc/self/exe", UINT64_MAX, &none) || !anchor_of(made, stage))
		return c;
	c.every = conf->chunk;
	char *made_by = mem_str(clip->made_by);
	long reference = clip->reference;
	double pose[4][4], at[2];
	memcpy(pose, clip->cam_from_head, sizeof pose);
	pack_bytes(&p, program, sizeof program);
	pack_bytes(&p, made_by, strlen(made_by));
	PACK(&p, made);
	PACK(&p, reference);
	PACK(&p, pose);
	for (int i = 0; i < points->n; i++) {
		memcpy(at, points->points.at[i], sizeof at);
		PACK(&p, at);
	}
	file_hash_bytes(c.key, p.bytes, p.n);
	pack_free(&p);
	free(made_by);
	return c;
}

/* Of frames from first on, into or out of p. */
static void pack_follow(struct pack *p, struct follow *f, long first)
{
	struct track_result *r = f->r;
	long n = r->n;
	const size_t points = (size_t)r->n_points;
	PACK(p, n);
	if (p->reading) {
		p->bad = p->bad || r->n != first || n < first || (size_t)(n - first) > p->n;
		if (p->bad)
			return;
		track_result_room(r, &f->room, n);
	}
	const size_t more = (size_t)(n - first);
	pack_bytes(p, r->time + first, more * sizeof *r->time);
	pack_bytes(p, r->lost_at + first, more * sizeof *r->lost_at);
	pack_bytes(p, r->pose + first, more * sizeof *r->pose);
	// where they lie in the modelling camera follows from the path of the whole clip
	pack_bytes(p, r->skin + (size_t)first * points, more * points * sizeof *r->skin);
	pack_bytes(p, r->confidence + (size_t)first * points, more * points * sizeof *r->confidence);
	r->n = n;
	PACK(p, r->still);
	PACK(p, r->lost);
	PACK(p, r->cut);
	PACK(p, f->pose);
	pack_bytes(p, f->rigid.off2, (size_t)f->rigid.n * sizeof *f->rigid.off2);
	if (f->skin)
		skin_track_pack(p, f->skin);
	track_eyes_pack(p, f->eyes, first);
	film_pack(p, r->film, first);
	folds_pack(p, r->folds, first);
}

static const char *path_of(struct chunks *c, int i)
{
	return stage_path(c->stage, "work/skin/%s%04d%s", prefix, i, suffix);
}

/* A chunk: key, the hash of what follows, and that. Returns false, nothing done, where there is none under that key that is whole. */
static bool read_one(struct chunks *c, struct follow *f)
{
	struct err none = { 0 };
	const char *path = path_of(c, c->n);
	char *bytes, hash[33];
	size_t size, head = 2 * sizeof c->key;
	if (!file_exists(path) || !file_read(&bytes, &size, path, limit, &none))
		return false;
	bool ok = size > head && !memcmp(bytes, c->key, sizeof c->key);
	if (ok) {
		file_hash_bytes(hash, bytes + head, size - head);
		ok = !memcmp(bytes + sizeof hash, hash, sizeof hash);
	}
	struct pack p = { .reading = true, .bytes = bytes + head, .n = ok ? size - head : 0 };
	if (ok)
		pack_follow(&p, f, c->first);
	const bool bad = ok && (p.bad || p.at != p.n);
	free(bytes);
	if (bad)
		c->every = -1;
	return ok && !bad;
}

bool chunks_read(struct chunks *c, struct follow *f)
{
	const long every = c->every;
	while (c->every > 0 && read_one(c, f)) {
		c->n++;
		c->first = f->r->n;
	}
	if (c->every >= 0)
		return true;
	// a whole chunk under the right key that does not fit: a fault of ours
	chunks_remove(c->stage);
	*c = (struct chunks){ .stage = c->stage, .every = every };
	return false;
}

void chunks_keep(struct chunks *c, struct follow *f)
{
	struct pack p = { .reading = false };
	struct err err = { 0 };
	char hash[33];
	if (!c->every || f->r->n - c->first < c->every)
		return;
	background_wait(f->background);
	pack_follow(&p, f, c->first);
	file_hash_bytes(hash, p.bytes, p.n);
	const struct file_part parts[] = { { c->key, sizeof c->key }, { hash, sizeof hash }, { p.bytes, p.n } };
	if (file_write_parts(path_of(c, c->n), COUNT(parts), parts, &err)) {
		c->n++;
		c->first = f->r->n;
	} else {
		stage_note(c->stage, "what has been followed is not kept, and a run that is killed begins anew: %s", err.msg);
		c->every = 0;
	}
	pack_free(&p);
}

void chunks_remove(struct stage *stage)
{
	struct file_list list;
	struct err none = { 0 };
	if (!file_list(&list, stage_path(stage, "work/skin"), &none))
		return;
	for (int i = 0; i < list.n; i++) {
		const size_t n = strlen(list.names[i]), tail = strlen(suffix);
		if (!strncmp(list.names[i], prefix, strlen(prefix)) && n > tail && !strcmp(list.names[i] + n - tail, suffix))
			file_remove(stage_path(stage, "work/skin/%s", list.names[i]), &none);
	}
	file_list_free(&list);
}
