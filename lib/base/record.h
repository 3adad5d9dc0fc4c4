/* record: what a stage made from what, by the bytes; and whether that still holds.
 * Kept in work/.made/STAGE.json. Hashes of unchanged files are remembered by size, inode and times
 * (work/.made/hashes), so that checking a hundred photographs reads none of them.
 */
#ifndef BASE_RECORD_H
#define BASE_RECORD_H
#include <jansson.h>

#include "base/conf.h"
#include "base/opt.h"

struct record {
	char *capture;       // path of the capture folder
	const char *stage;
	json_t *old, *now;   // {stage, program, config {}, each [pattern], lists {dir: hash}, outputs {path: {hash, inputs {path: hash}}}, complete}
	json_t *hashes;      // path -> {size, inode, mtime, ctime, hash}
	bool hashes_changed;
};

/* Loads the old record, if any; begins a new one. config: the lines of opt_print. */
struct record *record_open(const char *capture, const char *stage, const char *program_path, const char *config);
void record_free(struct record *record);

/* The hash of a file of the capture folder, from memory when it has not changed. Borrowed; null if unreadable. */
const char *record_hash(struct record *record, const char *rel);

/* The hash of a folder's sorted listing. Registers the listing as an input. */
void record_list(struct record *record, const char *dir, const char *hash);

/* Registers a pattern of keys ("view.*.distance_mm", in full) that the stage reads: one more of them is a change. */
void record_each(struct record *record, const char *pattern);

bool record_fresh(struct record *record, const char *out, int n, const char *const in[]);
void record_made(struct record *record, const char *out, int n, const char *const in[]);

/* complete: the stage has done all its work. */
bool record_save(struct record *record, bool complete, struct err *err);

/* Hash of the sorted names. */
void record_listing_hash(char out[33], int n, char *const names[]);

#endif
