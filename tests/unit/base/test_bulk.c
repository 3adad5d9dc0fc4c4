/* Arrays that lie on the disk against what was written to them, how much of them stays in memory, and states as bytes and back. */
#include <time.h>

#include "base/bulk.h"
#include "base/mem.h"
#include "base/pack.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const size_t MB = 1 << 20;

static size_t mapped(void)
{
	unsigned long all = 0, resident = 0, shared = 0;
	FILE *f = fopen("/proc/self/statm", "r");
	assert_non_null(f);
	assert_int_equal(fscanf(f, "%lu %lu %lu", &all, &resident, &shared), 3);
	fclose(f);
	return shared * (size_t)sysconf(_SC_PAGESIZE);
}

/* Two arrays that grow in turns, 96 MB in all: every number is there afterwards, and a quarter of a second later 16 MB of them at most (twice what was asked for). */
static void grows_on_the_disk(void **state)
{
	(void)state;
	const size_t step = MB / sizeof(long);
	const char *dir = scratch_open();
	const size_t before = mapped();
	struct bulk *b = bulk_open(dir, 8 * MB);
	long *p[2] = { 0 };
	for (size_t k = 0; k < 48; k++)
		for (int i = 0; i < 2; i++) {
			p[i] = bulk_grow(b, p[i], (k + 1) * step, sizeof(long));
			assert_int_equal(p[i][k * step], 0);
			for (size_t j = 0; j < step; j++)
				p[i][k * step + j] = (long)(k * step + j) * (i ? -1 : 1);
		}
	nanosleep(&(struct timespec){ 0, 250000000 }, 0);
	assert_true(mapped() < before + 16 * MB);
	for (size_t j = 0; j < 48 * step; j++)
		if (p[0][j] != (long)j || p[1][j] != -(long)j)
			fail_msg("number %zu: %ld and %ld", j, p[0][j], p[1][j]);
	bulk_free(b, p[1]);
	bulk_free(b, p[0]);
	bulk_close(b);
	// nothing has a name
	char *command = mem_printf("test -z \"$(ls -A '%s')\"", dir);
	assert_int_equal(system(command), 0);
	free(command);
	scratch_close();
}

/* Without a bulk, and where its folder cannot be: memory. */
static void else_in_memory(void **state)
{
	(void)state;
	struct bulk *nowhere = bulk_open("/proc/none/of/it", MB), *with[] = { 0, nowhere };
	for (int i = 0; i < 2; i++) {
		int *p = bulk_new(with[i], 1000, sizeof *p);
		assert_int_equal(p[999], 0);
		p[999] = 7;
		p = bulk_grow(with[i], p, 100000, sizeof *p);
		assert_int_equal(p[999], 7);
		bulk_free(with[i], p);
		bulk_free(with[i], 0);
	}
	bulk_close(nowhere);
	bulk_close(0);
}

static void there_and_back(void **state)
{
	(void)state;
	double x[3] = { 1, NAN, -0.0 };
	int n = 42;
	struct pack out = { .reading = false };
	PACK(&out, x);
	PACK(&out, n);
	assert_int_equal(out.n, sizeof x + sizeof n);
	double y[3];
	int m, more = 5;
	struct pack in = { .reading = true, .bytes = out.bytes, .n = out.n };
	PACK(&in, y);
	PACK(&in, m);
	assert_memory_equal(x, y, sizeof x);
	assert_int_equal(m, 42);
	assert_false(in.bad);
	PACK(&in, more);
	assert_true(in.bad && more == 0);
	pack_free(&in);
	pack_free(&out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(grows_on_the_disk),
		cmocka_unit_test(else_in_memory),
		cmocka_unit_test(there_and_back),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
