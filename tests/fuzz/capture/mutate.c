/* What the fuzzer changes of a capture: a key of capture.conf, a number of a text, a value of a binary file, an entry. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/capture/folder.h"
#include "tests/fuzz/capture/keys.h"

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);

/* The entry's bytes as they are changed. */
static uint8_t room[1 << 20];

static int below(uint64_t *seed, size_t n)
{
	return n ? (int)(keys_random(seed) % n) : 0;
}

/* Stems of photographs and characters, for keys with a star. */
static int stems(const char *out[FOLDER_MOST], char kept[FOLDER_MOST][FOLDER_NAME], const struct folder *f)
{
	int n = 0;
	for (int i = 0; i < f->n; i++) {
		const char *slash = strrchr(f->entries[i].name, '/');
		if (!slash || !strncmp(f->entries[i].name, "work/", 5))
			continue;
		snprintf(kept[n], FOLDER_NAME, "%s", slash + 1);
		kept[n][strcspn(kept[n], ".")] = 0;
		out[n] = kept[n];
		n++;
	}
	return n;
}

/* A line of capture.conf: its key's own line is replaced, or it is added. */
static void change_conf(struct folder *f, uint64_t *seed)
{
	static char kept[FOLDER_MOST][FOLDER_NAME];
	const char *names[FOLDER_MOST];
	struct folder_entry *conf = 0;
	char line[2048];
	for (int i = 0; i < f->n && !conf; i++)
		conf = strcmp(f->entries[i].name, "capture.conf") ? 0 : &f->entries[i];
	const size_t n = keys_line(line, sizeof line, stems(names, kept, f), names, seed);
	if (!conf && f->n < FOLDER_MOST) {
		conf = &f->entries[f->n++];
		*conf = (struct folder_entry){ '@', "capture.conf", room, 0 };
	}
	if (!conf || !n || conf->size + n >= sizeof room)
		return;
	const size_t key = strcspn(line, "=") + 1;
	size_t out = 0;
	bool put = false;
	for (size_t at = 0; at < conf->size;) {
		const uint8_t *end = memchr(conf->data + at, '\n', conf->size - at);
		const size_t m = end ? (size_t)(end - conf->data) + 1 - at : conf->size - at;
		if (m > key && !memcmp(conf->data + at, line, key)) {
			memcpy(room + out, line, put ? 0 : n);
			out += put ? 0 : n;
			put = true;
		} else {
			memmove(room + out, conf->data + at, m);
			out += m;
		}
		at += m;
	}
	if (!put)
		memcpy(room + out, line, n);
	conf->data = room;
	conf->size = out + (put ? 0 : n);
}

static bool of_number(int c)
{
	return (c >= '0' && c <= '9') || c == '-' || c == '.';
}

/* One number of a text becomes another. */
static void change_number(struct folder_entry *e, uint64_t *seed)
{
	char to[64];
	size_t at = (size_t)below(seed, e->size), end;
	for (size_t i = 0; i < e->size && !of_number(e->data[at]); i++)
		at = (at + 1) % e->size;
	for (end = at; end < e->size && of_number(e->data[end]); end++)
		;
	keys_number(to, sizeof to, seed);
	const size_t n = strlen(to);
	if (e->size + n >= sizeof room)
		return;
	memcpy(room, e->data, at);
	memcpy(room + at, to, n);
	memcpy(room + at + n, e->data + end, e->size - end);
	e->size = e->size - (end - at) + n;
	e->data = room;
}

/* A word of a binary file becomes a float or a whole number at a limit. */
static void change_word(struct folder_entry *e, uint64_t *seed)
{
	static const uint32_t words[] = { 0, 1, 0xffffffff, 0x7fffffff, 0x80000000, 0x7fc00000, 0x7f800000, 0xff800000, 0x7f7fffff, 0x00000001, 0x3f800000,
		0xbf800000, 0x10000, 0xffff };
	static const double doubles[] = { 0, -1, 1e300, -1e300, 1e-300, 0.0 / 0.0, 1 / 0.0 };
	if (e->size < 16 || e->size > sizeof room)
		return;
	memcpy(room, e->data, e->size);
	const size_t at = (size_t)below(seed, e->size - 8) & (keys_random(seed) % 4 ? ~(size_t)3 : ~(size_t)0);
	if (keys_random(seed) % 3)
		memcpy(room + at, &words[below(seed, sizeof words / sizeof *words)], 4);
	else
		memcpy(room + at, &doubles[below(seed, sizeof doubles / sizeof *doubles)], 8);
	e->data = room;
}

static void change_bytes(struct folder_entry *e, uint64_t *seed)
{
	if (e->size > sizeof room / 2)
		return;
	memcpy(room, e->data, e->size);
	e->data = room;
	// Within a window of a long file, or a cut.
	const size_t at = (size_t)below(seed, e->size + 1), n = e->size - at < 64 ? e->size - at : 64;
	if (keys_random(seed) % 8 == 0)
		e->size = at;
	else if (e->size < 512 || n < 8)
		e->size = LLVMFuzzerMutate(room, e->size, e->size + 256);
	else
		LLVMFuzzerMutate(room + at, n, n);
}

/* An entry goes, comes again under another name, becomes another kind, or takes another's bytes. */
static void change_entry(struct folder *f, int i, uint64_t *seed)
{
	struct folder_entry *e = &f->entries[i];
	char was[FOLDER_NAME];
	switch (keys_random(seed) % 5) {
	case 0:
		memmove(e, e + 1, (size_t)(--f->n - i) * sizeof *e);
		return;
	case 1:
		if (f->n >= FOLDER_MOST)
			return;
		f->entries[f->n] = *e;
		e = &f->entries[f->n++];
		strcpy(was, e->name);
		snprintf(e->name, sizeof e->name, "%.*s%c%s", (int)(strrchr(was, '/') ? strrchr(was, '/') - was + 1 : 0), was, (int)('a' + keys_random(seed) % 26),
		         strrchr(was, '/') ? strrchr(was, '/') + 1 : was);
		return;
	case 2:
		e->kind = "@/|~"[keys_random(seed) % 4];
		return;
	case 3: {
		const struct folder_entry *other = &f->entries[below(seed, (size_t)f->n)];
		e->data = other->data;
		e->size = other->size;
		return;
	}
	default:
		e->size = 0;
	}
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned begin)
{
	static struct folder f;
	uint64_t seed = begin;
	folder_parse(&f, data, size);
	if (f.n == 0 || keys_random(&seed) % 64 == 0)
		return LLVMFuzzerMutate(data, size, most);
	const int i = below(&seed, (size_t)f.n);
	switch (keys_random(&seed) % 16) {
	case 0: change_entry(&f, i, &seed); break;
	case 1: case 2: change_bytes(&f.entries[i], &seed); break;
	case 3: case 4: case 5: change_word(&f.entries[i], &seed); break;
	case 6: case 7: case 8: change_number(&f.entries[i], &seed); break;
	default: change_conf(&f, &seed);
	}
	uint8_t *out = malloc(most);
	const size_t n = folder_pack(out, most, &f);
	if (n)
		memcpy(data, out, n);
	free(out);
	return n ? n : size;
}
