/* stage: what every program has in common: its options, its capture folder, its log and progress, and the
 * record of what it made from what.
 *
 *     struct stage stage;
 *     struct err err = { 0 };
 *     stage_start(&stage, "limbus", "find the limbus ...", argc, argv, COUNT(opts), opts);
 *     if (stage_photos(...) && ...)
 *             stage_note(&stage, "...");
 *     return stage_end(&stage, &err);
 *
 * What follows stage_start may be called from several threads at once, but for stage_progress and stage_end.
 * Only stage_* prints or exits. Paths handed to stage_* are relative to the capture folder
 * ("photos/left.jpg", "work/iris/texture.exr").
 *
 * work/.made/STAGE.json records the program, its slice of the configuration, and the bytes (hashes) of every
 * file read and written. Whether a stage has to run again follows from that record and the bytes on disk,
 * never from dates: record.h.
 */
#ifndef BASE_STAGE_H
#define BASE_STAGE_H
#include <stdbool.h>
#include <stddef.h>

#include "base/err.h"
#include "base/file.h"
#include "base/opt.h"

struct record;

struct stage {
	const char *name;
	const char *capture;  // path of the capture folder; "." when not given
	int threads;          // what --threads says, or all; set in OpenMP already
	bool quiet, force;
	struct conf conf;
	int n_opts;
	const struct opt *opts;
	struct record *record;
	char **strings;  // owned results of stage_path() and stage_made_by()
	int n_strings, lock;
	double start_s, progress_s;
	int progress_shown;
	char progress_what[64];  // the work that is counted now
	double what_s, called_s; // when it began; when stage_progress was last called
	bool progress_open;  // an unfinished progress line stands on the terminal
};

/* Parses, loads the configuration, fills the table's pointers, locks work/ against a second make.
 * --help, --version and --print-config print and exit 0; a wrong call exits 2, bad configuration exits 1. */
void stage_start(struct stage *stage, const char *name, const char *about, int argc, char **argv, int n_opts,
                 const struct opt opts[]);

/* The capture folder's path joined with a relative one. Owned by the stage, valid until stage_end. */
__attribute__((format(printf, 2, 3)))
const char *stage_path(struct stage *stage, const char *fmt, ...);

/* The names in a folder of the capture, sorted; the listing becomes an input, so that a file added or taken
 * away is noticed. Free with file_list_free. */
bool stage_list(struct stage *stage, struct file_list *out, const char *dir, struct err *err);

/* True when `out` stands as this very program made it from these bytes with this configuration: skip it. */
bool stage_fresh(struct stage *stage, const char *out, int n, const char *const in[]);

/* JSON text {stage, version, config, inputs} to embed in the artifact made from these inputs. Owned by the
 * stage. No date, no absolute path, no thread count: equal inputs give equal bytes. */
const char *stage_made_by(struct stage *stage, int n, const char *const in[]);

/* Records that `out` has been made from `in`. Call after it is written. */
bool stage_made(struct stage *stage, const char *out, int n, const char *const in[], struct err *err);

/* One line of log to stderr, unless --quiet. */
__attribute__((format(printf, 2, 3)))
void stage_note(struct stage *stage, const char *fmt, ...);

/* The same even with --quiet: something the user has to know. */
__attribute__((format(printf, 2, 3)))
void stage_warn(struct stage *stage, const char *fmt, ...);

/* Shows progress with the time left: a bar on a terminal, plain lines elsewhere, nothing in short runs. */
void stage_progress(struct stage *stage, int done, int total, const char *what);

/* A number for the review page: work/log/STAGE.json, beside the seconds the stage took. */
void stage_figure(struct stage *stage, const char *key, double value, const char *unit);

/* A sentence for the review page's list of what was not computed and why. */
__attribute__((format(printf, 2, 3)))
void stage_skipped(struct stage *stage, const char *fmt, ...);

/* The same for what another line, of this stage or of one before, has said already: recorded, not printed. */
__attribute__((format(printf, 2, 3)))
void stage_skipped_as_said(struct stage *stage, const char *fmt, ...);

/* Writes the record and the log; prints the error, if any. Returns the exit status: 0, or 1 with an error. */
int stage_end(struct stage *stage, struct err *err);

#endif
