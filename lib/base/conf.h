/* conf: keys and values from configuration files and the command line, each with the place it came from.
 * Three layers, later ones win: config/STAGE.conf, capture.conf, command line.
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

/* Appends the items of a file: one "key = value" a line, at most 1000 bytes each without the line's end, the key of them about 200;
 * a comment begins with ; or # at the line's beginning, or with ; behind a space.
 * prefix  put before each key ("limbus."), or ""
 * layer   as in struct conf_item
 * Returns false, err set with file, line and rule, for a key given twice in the file, a longer line, a zero byte, or a line that is
 * not "key = value"; and for a missing file, except in layer 1 (an empty capture.conf and none are the same). */
bool conf_load(struct conf *conf, const char *path, const char *prefix, int layer, struct err *err);

/* Appends one item of the command line. */
void conf_add(struct conf *conf, const char *key, const char *value);

/* The strongest item of that key, or 0. With quality q ("draft"), a default "key.q" goes before the default
 * "key"; what capture.conf or the command line say goes before both. */
const struct conf_item *conf_find(const struct conf *conf, const char *key, const char *quality);

void conf_free(struct conf *conf);

#endif
