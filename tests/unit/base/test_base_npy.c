/* Arrays and tables in files: round trips, files as NumPy writes them (bytes given here), hostile ones. */
#include "base/csv.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static void round_trip(void **state)
{
	(void)state;
	static const enum npy_type types[] = { NPY_F4, NPY_F8, NPY_I1, NPY_I2, NPY_I4, NPY_I8, NPY_U1, NPY_U2, NPY_U4, NPY_U8,
		                                   NPY_BOOL };
	struct err err = { 0 };
	unsigned char data[24 * 8];
	for (int i = 0; i < COUNT(data); i++)
		data[i] = (unsigned char)(i & 1);
	for (int t = 0; t < COUNT(types); t++)
		for (int ndim = 0; ndim <= 3; ndim++) {
			struct npy a = npy_of(types[t], ndim, (long[]){ 2, 3, 4 }, data), b, c;
			assert_true(npy_save(scratch_path("a.npy"), &a, &err) && npy_read(&b, scratch_path("a.npy"), 1000, &err));
			assert_int_equal(b.ndim, ndim);
			assert_int_equal(b.type, types[t]);
			assert_true(npy_expect(&b, "b", ndim, a.shape, &err));
			assert_memory_equal(b.data, data, (size_t)npy_count(&a) * npy_type_size(types[t]));
			struct npz_item items[] = { { "x", a }, { "y", b } };
			assert_true(npz_save(scratch_path("a.npz"), 2, items, "{}", &err)
			            && npz_read(&c, scratch_path("a.npz"), "y", 1000, &err));
			assert_memory_equal(c.data, data, (size_t)npy_count(&a) * npy_type_size(types[t]));
			npy_free(&b);
			npy_free(&c);
		}
	struct npy none;
	assert_false(npz_read(&none, scratch_path("a.npz"), "z", 1000, &err));
}

/* As numpy.save writes them: Fortran order, big-endian, formats 2 and 3. */
static void numpy_bytes(void **state)
{
	(void)state;
	struct err err = { 0 };
	static const char *const heads[] = {
		"{'descr': '>i2', 'fortran_order': True, 'shape': (2, 3), }",
		"{'descr': '<i2', 'fortran_order': True, 'shape': (2, 3), }",
		"{\"shape\": (2,3), \"fortran_order\": True, \"descr\": \">i2\"}",
	};
	for (int h = 0; h < COUNT(heads); h++)
		for (int version = 1; version <= 3; version++) {
			unsigned char file[200] = "\x93NUMPY";
			size_t n = strlen(heads[h]), at = version == 1 ? 10 : 12;
			file[6] = (unsigned char)version;
			file[8] = (unsigned char)n;
			memcpy(file + at, heads[h], n);
			// [[0 1 2] [3 4 5]], first index fastest
			static const unsigned char order[] = { 0, 3, 1, 4, 2, 5 };
			for (int i = 0; i < 6; i++)
				file[at + n + 2 * (size_t)i + (h == 1 ? 0 : 1)] = order[i];
			struct npy a;
			assert_true(npy_parse(&a, file, at + n + 12, "numpy", 100, &err));
			double *x = npy_doubles(&a);
			for (int i = 0; i < 6; i++)
				assert_true(x[i] == i);
			free(x);
			npy_free(&a);
			assert_false(npy_parse(&a, file, at + n + 11, "numpy", 100, &err));
			ERR_HAS(err, "cut off");
			err = (struct err){ 0 };
		}
}

static void rows(void **state)
{
	(void)state;
	struct err err = { 0 };
	float row[70][3];
	for (int i = 0; i < 210; i++)
		row[i / 3][i % 3] = (float)i;
	struct npy head, whole = npy_of(NPY_F4, 2, (long[]){ 70, 3 }, row);
	assert_true(npy_save(scratch_path("r.npy"), &whole, &err));
	struct npy_rows *in = npy_rows_open(&head, scratch_path("r.npy"), &err);
	double out[16 * 3];
	long got, total = 0;
	assert_non_null(in);
	while (npy_rows_next(in, 16, out, &got, &err) && got)
		for (long i = 0; i < 3 * got; i++)
			assert_true(out[i] == (double)total++);
	assert_int_equal(total, 210);
	assert_true(npy_rows_seek(in, 41, &err) && npy_rows_next(in, 2, out, &got, &err));
	assert_true(got == 2 && out[0] == 123 && out[5] == 128);
	assert_false(npy_rows_seek(in, 71, &err));
	err = (struct err){ 0 };
	assert_memory_equal(&head.shape, &whole.shape, sizeof head.shape);
	npy_rows_close(in);
}

static void hostile_head(const char *text, const char *says)
{
	unsigned char file[300] = "\x93NUMPY\1";
	struct err err = { 0 };
	struct npy a;
	size_t n = strlen(text);
	file[8] = (unsigned char)n;
	memcpy(file + 10, text, n);
	assert_false(npy_parse(&a, file, 10 + n + 8, "x.npy", 1000, &err));
	ERR_HAS(err, says);
	assert_null(strchr(err.msg, '\n'));
	assert_null(a.data);
}

static void hostile(void **state)
{
	(void)state;
	hostile_head("{'descr': '|O', 'fortran_order': False, 'shape': (1,), }", "type |O");
	hostile_head("{'descr': '<c16', 'fortran_order': False, 'shape': (1,), }", "type <c16");
	hostile_head("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1,), }", "plain numbers");
	hostile_head("{'descr': '<f8', 'fortran_order': False, 'shape': (999999999999999999, 99), }", "beyond any memory");
	hostile_head("{'descr': '<f8', 'fortran_order': False, 'shape': (0, 999999999999999999, 99), }", "beyond any memory");
	hostile_head("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999999,), }", "beyond any memory");
	hostile_head("{'descr': '<f8', 'fortran_order': False, 'shape': (-1,), }", "whole numbers");
	hostile_head("{'descr': '<f8', 'fortran_order': False, 'shape': (1,1,1,1,1,1,1), }", "at most 6");
	hostile_head("{'descr': '<f8', 'fortran_order': False, 'shape': (1000,), }", "must be <= 1000");
	hostile_head("{'descr': '<f8', 'fortran_order': False, 'shape': (1", "whole numbers");
	hostile_head("{'descr': '<f8', 'shape': (1,), }", "fortran_order");
	hostile_head("{'descr': '<f8', 'fortran_order': False, }", "without a shape");
	struct err err = { 0 };
	struct npy a;
	assert_false(npz_read(&a, scratch_text("no.npz", "PK\3\4 this is no zip"), "x", 100, &err));
	ERR_HAS(err, "not an .npz file");
	err = (struct err){ 0 };
	assert_null(npy_rows_open(&a, scratch_text("short.npy", "\x93NUM"), &err));
	ERR_HAS(err, "not an .npy file");
}

/* Numbers that no measurement gives are named by their place. */
static void ranges(void **state)
{
	(void)state;
	float f[4] = { 1, -2, NAN, 3 };
	double d[2] = { 1e13, -INFINITY };
	struct err err = { 0 };
	struct npy floats = npy_of(NPY_F4, 1, (long[]){ 4 }, f), doubles = npy_of(NPY_F8, 1, (long[]){ 2 }, d);
	assert_true(npy_in_range(&floats, 3, true, 0, "f.npy", &err));
	assert_false(npy_in_range(&floats, 3, false, 10, "f.npy", &err));
	ERR_HAS(err, "f.npy: number 12 = nan: must be in [-3, 3]");
	err = (struct err){ 0 };
	assert_false(npy_in_range(&floats, 2.5, true, 0, "f.npy", &err));
	ERR_HAS(err, "number 3 = 3");
	err = (struct err){ 0 };
	assert_false(npy_in_range(&doubles, 1e15, true, 0, "d.npy", &err));
	ERR_HAS(err, "number 1 = -inf");
}

/* What bytes a zip of zeros unpacks to is told by its directory before any of it is unpacked. */
static void bomb(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct npy a, big = npy_of(NPY_U1, 1, (long[]){ 1 << 20 }, mem_new(1 << 20, 1));
	assert_true(npz_save(scratch_path("b.npz"), 1, &(struct npz_item){ "x", big }, 0, &err));
	assert_false(npz_read(&a, scratch_path("b.npz"), "x", 1 << 18, &err));
	ERR_HAS(err, "must be <=");
	npy_free(&big);
}

static void tables(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct csv_table t, u;
	assert_true(csv_read(&t, scratch_text("a.csv", "\xef\xbb\xbf# who\r\n\"a\"; b;c\r\n1;;\" 3\"\r\n\r\n# no\r\n-1e-3;;2"), &err));
	assert_int_equal(t.n_columns, 3);
	assert_int_equal(t.n_rows, 2);
	assert_true(csv_at(&t, 0, 0) == 1 && isnan(csv_at(&t, 0, 1)) && csv_at(&t, 0, 2) == 3);
	assert_true(csv_at(&t, 1, csv_column(&t, "a")) == -1e-3 && isnan(csv_at(&t, 1, 1)));
	assert_int_equal(t.line[1], 6);
	assert_true(csv_save(scratch_path("b.csv"), &t, &err) && csv_read(&u, scratch_path("b.csv"), &err));
	for (int r = 0; r < 2; r++)
		for (int c = 0; c < 3; c++)
			assert_true(csv_at(&t, r, c) == csv_at(&u, r, c) || isnan(csv_at(&t, r, c)));
	csv_table_free(&t);
	csv_table_free(&u);
	t = csv_table_new(1, (const char *const[]){ "a,b" });
	csv_add(&t, (double[]){ NAN });
	csv_add(&t, (double[]){ 0.1 });
	assert_true(csv_save(scratch_path("c.csv"), &t, &err) && csv_read(&u, scratch_path("c.csv"), &err));
	assert_int_equal(u.n_rows, 2);
	assert_int_equal(csv_need(&u, "a,b", "c.csv", &err), 0);
	assert_int_equal(csv_need(&u, "x", "c.csv", &err), -1);
	ERR_HAS(err, "c.csv: no column x");
	csv_table_free(&t);
	csv_table_free(&u);
}

static void bad_tables(void **state)
{
	(void)state;
	static const struct {
		const char *text, *says;
	} cases[] = {
		{ "", "is empty" },                     { "a,b\n1\n", ":2: 1 fields, must be 2" },
		{ "a,b\n1,2,3\n", ":2: more fields" },  { "a\n\n1x\n", ":3: a = 1x: must be a finite number" },
		{ "a\ninf\n", ":2: a = inf" },          { "a\nNaN\n", ":2: a = NaN: must be a finite number" },
	         { "a,a\n", "twice" },
		{ "a,,b\n", "name of column 2" },       { "a\n\"1\n2\n", ":2: a quote that does not end" },
	};
	for (int i = 0; i < COUNT(cases); i++) {
		struct csv_table t;
		struct err err = { 0 };
		assert_false(csv_read(&t, scratch_text("bad.csv", cases[i].text), &err));
		ERR_HAS(err, cases[i].says);
		csv_table_free(&t);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(round_trip), cmocka_unit_test(numpy_bytes), cmocka_unit_test(rows),
		cmocka_unit_test(hostile),    cmocka_unit_test(bomb),        cmocka_unit_test(tables),
		cmocka_unit_test(bad_tables),    cmocka_unit_test(ranges),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
