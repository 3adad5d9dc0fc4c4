#include <stdlib.h>
#include <string.h>
#include <zip.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "base/npy/head.h"

/* Zip archives are read from memory, so that a pipe or device under that name is refused as everywhere. */
static zip_t *open_zip(char **bytes, const char *path, size_t limit, struct err *err)
{
	size_t size;
	zip_error_t why;
	if (!file_read(bytes, &size, path, limit, err))
		return 0;
	zip_error_init(&why);
	zip_source_t *source = zip_source_buffer_create(*bytes, size, 0, &why);
	zip_t *zip = source ? zip_open_from_source(source, ZIP_RDONLY, &why) : 0;
	if (!zip) {
		err_set(err, "%s: not an .npz file: %s", path, zip_error_strerror(&why));
		if (source)
			zip_source_free(source);
		free(*bytes);
		*bytes = 0;
	}
	zip_error_fini(&why);
	return zip;
}

static bool read_entry(struct npy *out, zip_t *zip, const char *where, const char *entry, size_t limit, struct err *err)
{
	zip_stat_t st;
	if (zip_stat(zip, entry, 0, &st) || !(st.valid & ZIP_STAT_SIZE))
		return err_set(err, "%s: is not in the file", where);
	if (st.size > limit + NPY_HEAD_MAX + 12)
		return err_set(err, "%s: %llu bytes, must be <= %zu", where, (unsigned long long)st.size, limit);
	zip_file_t *file = zip_fopen(zip, entry, 0);
	if (!file)
		return err_set(err, "%s: cannot be unpacked: %s", where, zip_strerror(zip));
	// The directory may claim more bytes than the data holds: memory grows with what is read.
	size_t have = 0, room = 1 << 16;
	char *bytes = mem_array(room, 1);
	zip_int64_t got;
	while ((got = zip_fread(file, bytes + have, room - have)) > 0) {
		have += (size_t)got;
		if (have == room)
			bytes = mem_grow(bytes, room *= 2, 1);
		if (have > st.size)
			break;
	}
	zip_fclose(file);
	bool ok = got >= 0 && have == st.size ? npy_parse(out, bytes, have, where, limit, err)
	                                      : err_set(err, "%s: cannot be unpacked: damaged", where);
	free(bytes);
	return ok;
}

bool npz_read(struct npy *out, const char *path, const char *name, size_t limit, struct err *err)
{
	char *bytes;
	*out = (struct npy){ 0 };
	zip_t *zip = open_zip(&bytes, path, limit, err);
	if (!zip)
		return false;
	char *entry = mem_printf("%s.npy", name), *where = mem_printf("%s: %s", path, name);
	bool ok = read_entry(out, zip, where, entry, limit, err);
	zip_discard(zip);
	free(bytes);
	free(entry);
	free(where);
	return ok;
}

bool npz_has(const char *path, const char *name, size_t limit)
{
	char *bytes, *entry = mem_printf("%s.npy", name);
	struct err none = { 0 };
	zip_t *zip = open_zip(&bytes, path, limit, &none);
	const bool has = zip && zip_name_locate(zip, entry, 0) >= 0;
	if (zip) {
		zip_discard(zip);
		free(bytes);
	}
	free(entry);
	return has;
}

/* Adds an entry; bytes: ownership passes on. Stored uncompressed and dated 1980-01-01: the same bytes with every zlib on every
 * day. */
static bool add_entry(zip_t *zip, const char *name, void *bytes, size_t size)
{
	zip_source_t *source = zip_source_buffer(zip, bytes, size, 1);
	if (!source) {
		free(bytes);
		return false;
	}
	zip_int64_t at = zip_file_add(zip, name, source, ZIP_FL_ENC_UTF_8);
	if (at < 0) {
		zip_source_free(source);
		return false;
	}
	return !zip_set_file_compression(zip, (zip_uint64_t)at, ZIP_CM_STORE, 0)
	       && !zip_file_set_dostime(zip, (zip_uint64_t)at, 0, 0x21, 0);
}

static bool add_all(zip_t *zip, int n, const struct npz_item items[], const char *made_by)
{
	for (int i = 0; i < n; i++) {
		const struct npy *a = &items[i].array;
		size_t size = (size_t)npy_count(a) * npy_type_size(a->type);
		unsigned char *bytes = malloc(NPY_HEAD_WRITTEN + size);
		char *name = mem_printf("%s.npy", items[i].name);
		size_t begins = bytes ? npy_head_write(bytes, a) : 0;
		if (bytes && size)
			memcpy(bytes + begins, a->data, size);
		bool ok = bytes && add_entry(zip, name, bytes, begins + size);
		free(name);
		if (!ok)
			return false;
	}
	return !made_by || add_entry(zip, "made_by.json", strdup(made_by), strlen(made_by));
}

bool npz_save(const char *path, int n, const struct npz_item items[], const char *made_by, struct err *err)
{
	zip_error_t why;
	zip_error_init(&why);
	zip_source_t *memory = zip_source_buffer_create(0, 0, 0, &why);
	zip_t *zip = memory ? zip_open_from_source(memory, ZIP_CREATE | ZIP_TRUNCATE, &why) : 0;
	zip_error_fini(&why);
	if (!zip) {
		if (memory)
			zip_source_free(memory);
		return err_set(err, "%s: cannot be packed", path);
	}
	zip_source_keep(memory);
	zip_stat_t st;
	char *bytes = 0;
	bool ok = add_all(zip, n, items, made_by) && !zip_close(zip);
	if (!ok)
		zip_discard(zip);
	ok = ok && !zip_source_open(memory) && !zip_source_stat(memory, &st);
	if (ok) {
		bytes = mem_array((size_t)st.size + 1, 1);
		ok = zip_source_read(memory, bytes, st.size) == (zip_int64_t)st.size && !zip_source_close(memory);
	}
	ok = ok ? file_write(path, bytes, (size_t)st.size, err) : err_set(err, "%s: cannot be packed", path);
	zip_source_free(memory);
	free(bytes);
	return ok;
}
