/* stage: what every program has in common: its options, its capture folder, its log and progress, and the record of what it made
 * from which inputs.
 *
 *     struct stage stage;
 *     struct err err = { 0 };
 *     stage_start(&stage, "limbus", "find the limbus ...", argc, argv, COUNT(opts), opts);
 *     if (stage_photos(...) && ...)
 *             stage_note(&stage, "...");
 *     return stage_end(&stage, &err);
 *
 * After stage_start, all functions but stage_progress and stage_end may be called from several threads at once.
 * Only stage_* prints or exits. Paths passed to stage_* are relative to the capture folder ("photos/left.jpg",
 * "work/iris/texture.exr").
 *
 * work/.made/STAGE.json records the program, its slice of the configuration, and the hash of every file read and written. Whether a
 * stage has to run again follows from that record and the bytes on disk, never from dates (record.h).
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
	const char *only;     // the one part to make (--only); null: all
	int threads;          // of --threads, or all; set in OpenMP already
	bool quiet, force;
	struct conf conf;
	int n_opts;
	const struct opt *opts;
	struct record *record;
	char **strings;  // owned results of stage_path() and stage_made_by()
	int n_strings, lock;
	double start_s, progress_s;
	int progress_shown;
	char progress_what[64];  // the piece of work that progress is shown of
	double what_s;           // when it was first told of
	int what_done, done;     // what was done of it then, and when it was last told of
	bool progress_open;  // an unfinished progress line stands on the terminal
};

/* First in main, of programs with many short parallel loops: starts the program anew with threads that sleep while they wait, unless OMP_WAIT_POLICY is set. OpenMP
 * reads it when a program starts; threads that spin take the time of other programs, and of this one's decoders: limbus takes three times as long on a busy machine.
 * OpenBLAS begins its own when a program starts, which spin, too: it begins none. */
void stage_calm(char **argv);

/* Parses the command line, loads the configuration, fills the table's pointers, and locks work/ against a second program.
 * name, about   of the program, for --help and messages
 * opts[n_opts]  must outlive the stage
 * --help, --version and --print-config print and exit 0; a wrong call exits 2, bad configuration exits 1. */
void stage_start(struct stage *stage, const char *name, const char *about, int argc, char **argv, int n_opts,
                 const struct opt opts[]);

/* The capture folder's path joined with a relative one. Owned by the stage, valid until stage_end. */
__attribute__((format(printf, 2, 3)))
const char *stage_path(struct stage *stage, const char *fmt, ...);

/* Lists the names in a folder of the capture, sorted, as file_list. The listing is recorded as an input, so that a file added or
 * removed makes the stage run again. Names of more than 200 bytes are left out, and logged so: what is made of them has longer ones,
 * and file systems end at 255. file_list_free. */
bool stage_list(struct stage *stage, struct file_list *out, const char *dir, struct err *err);

/* Whether a file of the capture is there. That it is, or is not, is recorded as an input; its bytes are not. */
bool stage_has(struct stage *stage, const char *rel);

/* Whether `out` is up to date: made by this very program from in[n] with these bytes and this configuration. It need not be made
 * again then. */
bool stage_fresh(struct stage *stage, const char *out, int n, const char *const in[]);

/* JSON text {stage, version, config, inputs} to embed in the artifact made from in[n]. Owned by the stage, valid until stage_end.
 * It has no date, absolute path or number of threads: equal inputs give equal bytes. */
const char *stage_made_by(struct stage *stage, int n, const char *const in[]);

/* Records that `out` has been made from in[n]; to be called after it is written. Returns false, err set, when the record cannot
 * be saved. */
bool stage_made(struct stage *stage, const char *out, int n, const char *const in[], struct err *err);

/* Puts aside (aside.h) what earlier runs have made below `dir` ("work/render") and this one has neither made nor found to be up to date: what
 * is read of that folder behind this call is of the capture as it is now. stage_end does it with all of work/, where the run was a whole one and
 * nothing failed. */
bool stage_put_aside(struct stage *stage, const char *dir, struct err *err);

/* Prints one line of log to stderr, unless --quiet. */
__attribute__((format(printf, 2, 3)))
void stage_note(struct stage *stage, const char *fmt, ...);

/* The same with --quiet too: a warning. */
__attribute__((format(printf, 2, 3)))
void stage_warn(struct stage *stage, const char *fmt, ...);

/* Shows progress: a bar on a terminal, plain lines elsewhere, nothing in short runs. With it the time left, by what has been done since a piece of work was first told of:
 * its preparation is over by then. Another piece begins where `what` differs or less is done than before. */
void stage_progress(struct stage *stage, int done, int total, const char *what);

/* Logs a number for the review page, in work/log/STAGE.json. */
void stage_figure(struct stage *stage, const char *key, double value, const char *unit);

/* Prints, and logs for the review page, a sentence that says what was not computed and why. */
__attribute__((format(printf, 2, 3)))
void stage_skipped(struct stage *stage, const char *fmt, ...);

/* The same without printing, where this stage or one before it has printed as much already. */
__attribute__((format(printf, 2, 3)))
void stage_skipped_as_said(struct stage *stage, const char *fmt, ...);

/* Writes the record and the log; prints the error, if any. Returns the exit status: 0, or 1 with an error. */
int stage_end(struct stage *stage, struct err *err);

#endif
