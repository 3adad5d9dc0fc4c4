/* say: the one place that prints: log lines, errors, and the figures a stage leaves for the review page. */
#ifndef BASE_SAY_H
#define BASE_SAY_H
#include <stdarg.h>
#include <stdbool.h>

/* "limbus: text" to stderr, on one line whatever the text holds (control bytes are shown as \xNN). */
void say_line(const char *who, const char *fmt, va_list ap);
void say_error(const char *who, const char *text);

/* Figures and skips of this run, in memory until written to work/log/STAGE.json with the time it took. */
void say_log_open(void);
void say_log_figure(const char *key, double value, const char *unit);
void say_log_skipped(const char *text);
/* An artifact of this run: made, or kept because it stands as it would be made again. */
void say_log_artifact(const char *rel, bool made);
void say_log_write(const char *path, const char *stage, double seconds, const char *error);

#endif
