/* db_impl: private to db.c and db_matches.c. */
#ifndef SFM_COLMAP_DB_IMPL_H
#define SFM_COLMAP_DB_IMPL_H
#include <sqlite3.h>

#include "sfm/colmap/db.h"

/* A table of our own beside COLMAP's: pictures that a finished model was made with. */
#define DB_DONE "eyewright_done"

struct db {
	sqlite3 *sql;
	char *path;
};

/* From here on SQLite opens and removes its files through the gate (base/gate.h). */
void db_gate(void);

bool db_run(struct db *db, const char *text, struct err *err);

/* Null, err set, when SQLite refuses the text. */
sqlite3_stmt *db_prepare(struct db *db, const char *text, struct err *err);

/* Runs a statement that gives no rows, and ends it. False for a null one, whose error stands in err already. */
bool db_finish(struct db *db, sqlite3_stmt *s, struct err *err);

#endif
