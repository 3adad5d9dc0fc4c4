/* record: which files a stage made from which inputs, by hashes of their bytes. Kept in work/.made/STAGE.json.
 * Hashes of files are cached by size, inode and times (work/.made/hashes), so that checking a hundred unchanged photographs reads
 * none of them. Whether a record still holds: record_holds.h.
 */
#ifndef BASE_RECORD_H
#define BASE_RECORD_H
#include <jansson.h>

#include "base/conf.h"
#include "base/opt.h"

struct record {
	char *capture;       // path of the capture folder
	const char *stage;
	json_t *old, *now;   // {stage, program, config {}, each [pattern], lists {dir: hash}, outputs {path: {hash, inputs {path: hash}}}, absent [path], there {path: true}, complete,
	                     // aside {path: as in outputs; null: not known to hold}: put aside; left {path: the same}: of earlier runs, in a record of one that did not end}
	json_t *hashes;      // path -> {size, inode, mtime, ctime, hash}
	bool hashes_changed;
};

/* Loads the stage's old record, if any, and begins a new one.
 * capture, stage  folder and name; stage must outlive the record
 * config          the lines of opt_print
 * record_free. */
struct record *record_open(const char *capture, const char *stage, const char *program_path, const char *config);
void record_free(struct record *record);

/* The hash of a file of the capture folder (rel; or an absolute path), from the cache when the file has not changed. Owned by the
 * record; null if unreadable. */
const char *record_hash(struct record *record, const char *rel);

/* Registers a folder's sorted listing, by its hash (record_listing_hash), as an input. */
void record_list(struct record *record, const char *dir, const char *hash);

/* Registers that a file is there, whatever it holds, as an input. */
void record_there(struct record *record, const char *rel);

/* Registers a pattern of keys ("view.*.distance_mm", in full) that the stage reads: a new key that matches is then a change. */
void record_each(struct record *record, const char *pattern);

/* Whether the file `out` stands as the last run recorded it, made by this program with this configuration from in[n] with these
 * bytes. If so it is recorded for this run too; one that was put aside is brought back. */
bool record_fresh(struct record *record, const char *out, int n, const char *const in[]);

/* Records that `out` has been made from in[n]. */
void record_made(struct record *record, const char *out, int n, const char *const in[]);

/* Records what the last run had made with this program and configuration, and this run did not ask about. */
void record_keep(struct record *record);

/* Writes the record, with what was looked for in vain (asked.h), and the cache of hashes if it changed. complete: the stage has done all its
 * work. Where a disk has failed to give a file nothing counts as made. Returns false, err set, when
 * that fails. */
bool record_save(struct record *record, bool complete, struct err *err);

/* Hash of sorted names[n]. */
void record_listing_hash(char out[33], int n, char *const names[]);

#endif
