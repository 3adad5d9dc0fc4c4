/* conf: keys and values from configuration files and the command line, each with the place it came from.
 * There are three layers: config/STAGE.conf, capture.conf, command line; a later one has precedence.
 */
#ifndef BASE_CONF_H
#define BASE_CONF_H
#include "base/err.h"

struct conf_item {
	char *key;         // full: "limbus.edge_sigma", "camera.focal_px"
	char *value;       // may be empty: unset
	const char *file;  // as given by the caller, or "command line"; owned by the conf
	int line;          // 0 on the command line
	int layer;         // 0 defaults, 1 capture.conf, 2 command line
};

struct conf {
	struct conf_item *items;
	int n;
	char **files;
	int n_files;
};

/* Appends the items of a file: one "key = value" a line, of at most 1000 bytes without the line's end (the key, with inih as Debian
 * builds it, of at most 198). A comment begins with ; or # at the beginning of a line, or with ; after a space.
 * prefix  put before each key ("limbus."), or ""
 * layer   as in struct conf_item
 * Returns false, err set with file, line and rule, for a key given twice in the file, a longer line, a zero byte, or a line that is
 * not "key = value"; and for a missing file, except in layer 1 (an empty capture.conf and none are the same). */
bool conf_load(struct conf *conf, const char *path, const char *prefix, int layer, struct err *err);

/* Appends one item of the command line (layer 2). Key and value are copied. */
void conf_add(struct conf *conf, const char *key, const char *value);

/* Finds the item that holds for `key`: that of the highest layer. quality: the preset in effect ("draft") or null: within the
 * defaults, "key.draft" has precedence over "key". Returns null when there is none; owned by conf. */
const struct conf_item *conf_find(const struct conf *conf, const char *key, const char *quality);

void conf_free(struct conf *conf);

#endif
