/* say: the one place that prints log lines and errors, and the log of figures that a stage leaves for the review page. */
#ifndef BASE_SAY_H
#define BASE_SAY_H
#include <stdarg.h>
#include <stdbool.h>

/* Prints "limbus: text" to stderr as one line; control bytes are shown as \xNN. */
void say_line(const char *who, const char *fmt, va_list ap);
void say_error(const char *who, const char *text);

/* The log of this process's run: figures, sentences about what was skipped, artifacts. Kept in memory until say_log_write writes
 * it to work/log/STAGE.json with the seconds the run took and its error, or null. */
void say_log_open(void);
void say_log_figure(const char *key, double value, const char *unit);
void say_log_skipped(const char *text);
/* An artifact of this run: made, or kept because it was up to date. */
void say_log_artifact(const char *rel, bool made);
void say_log_write(const char *path, const char *stage, double seconds, const char *error);

#endif
