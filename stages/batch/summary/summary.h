/* summary: many captures as one table and one page. What a capture's work/ tells is collected when it ends (batch/rows/), and put
 * together from all of these (batch/index.html, summary.csv, summary.json).
 * dir: the folder of captures, without a slash at its end. Names of captures and all that their work/ holds are strangers'.
 */
#ifndef STAGES_BATCH_SUMMARY_H
#define STAGES_BATCH_SUMMARY_H
#include <jansson.h>

#include "base/err.h"

/* Above these a fit is doubtful; thumb_px: the width of the pictures. */
struct summary_conf {
	double gross, theta_deg, difference;
	int thumb_px;
};

enum { ROW_LIMIT = 4 << 20 };  // bytes of a file in batch/rows

/* Reads what DIR/NAME/work tells: batch/rows/HASH.json {records [{part, of, numbers {}, texts {}}], review, thumb}, and its picture
 * batch/thumbs/HASH.jpg, written only where they change. HASH is that of the name. What cannot be read is left out: a folder may hold anything.
 * Returns false, err set, when batch/ cannot be written. */
bool summary_collect(const char *dir, const char *name, const struct summary_conf *conf, struct err *err);

/* Appends {part, of, numbers, texts} of a JSON object: its numbers, flags and texts, those of objects in it as "object.key", of arrays of
 * at most 16 numbers as "array.0"; made_by and what is longer or deeper is left out, and all beyond 256 of each. */
void record_add(json_t *records, const char *part, const char *of, const json_t *object);

/* The records of a file in batch/rows, which anybody may have written: what record_add would not have made is left out. given: may be null. */
json_t *records_checked(const json_t *given);

/* All captures with what became of them, worst first: [{capture, folder (encoded for an address), hash, state, reason, seconds, peak_mib, score, doubts [],
 * review, thumb, records []}]. state: failed, doubt, runs, waits, pass.
 * queued  file of lines NAME, STATE, REASON with tabs between, of captures without a result; may be missing; null: none
 * Null, err set, when dir cannot be read. json_decref. */
json_t *summary_all(const char *dir, const char *queued, const struct summary_conf *conf, struct err *err);

/* Fills in state, reason, doubts and score of one capture, from its result and its records. */
void summary_judge(json_t *capture, const char *result, const struct summary_conf *conf);

/* The number of a record; NAN where it has none of that key. */
double record_number(const json_t *record, const char *key);
const char *record_text(const json_t *record, const char *key);

/* Put the table into files of batch/. False, err set, when one cannot be written. */
bool summary_csv(const json_t *captures, const char *path, struct err *err);
bool summary_json(const json_t *captures, const char *path, struct err *err);
bool summary_page(const json_t *captures, const char *title, const char *path, struct err *err);

/* DIR/batch/FOLDER/HASH-of-name.ENDING; free(). */
char *summary_path(const char *dir, const char *folder, const char *name, const char *ending);

#endif
