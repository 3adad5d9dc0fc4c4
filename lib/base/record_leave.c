#include "base/record_leave.h"

#include <stdlib.h>

#include "base/aside.h"
#include "base/mem.h"
#include "base/record_impl.h"
#include "base/record_left.h"

static char *log_of(const char *stage)
{
	return mem_printf("work/log/%s.json", stage);
}

bool record_leave(const char *capture, const char *stage, struct err *err)
{
	if (!aside_stands(capture, stage, false))
		return true;
	struct record *r = record_open_old(capture, stage);
	char *log = log_of(stage);
	json_t *made;
	const char *key;
	bool ok = true;
	for (int i = 0; i < RECORD_KINDS; i++)
		json_object_foreach(json_object_get(r->old, record_kinds[i]), key, made) {
			char *rel = record_path_of(key);
			ok = ok && aside_put(capture, rel, err);
			free(rel);
		}
	// The record at last: where this is ended before, the next goes on from it.
	ok = ok && aside_put(capture, log, err) && aside_move_record(capture, stage, true, err);
	free(log);
	record_free(r);
	return ok;
}

bool record_return(const char *capture, const char *stage, struct err *err)
{
	if (aside_stands(capture, stage, false) || !aside_stands(capture, stage, true))
		return true;
	// The record at first: what is not back when this is ended record_fresh brings.
	if (!aside_move_record(capture, stage, false, err))
		return false;
	struct record *r = record_open_old(capture, stage);
	char *log = log_of(stage);
	json_t *made;
	const char *key;
	aside_take(capture, log);
	json_object_foreach(json_object_get(r->old, "outputs"), key, made) {
		char *rel = record_path_of(key);
		aside_take(capture, rel);
		free(rel);
	}
	free(log);
	record_free(r);
	return true;
}
