#include "tests/lib/stress.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void stress_start(struct stress *s, const char *name, int argc, char **argv)
{
	*s = (struct stress){ .program = argv[0], .name = name, .share = 1, .seed = 1, .family_index = -1, .only_family = -1,
		.only_case = -1 };
	for (int i = 1; i < argc; i++) {
		const char *value = strchr(argv[i], '=');
		if (value && !strncmp(argv[i], "--share=", 8)) {
			s->share = atof(value + 1);
		} else if (value && !strncmp(argv[i], "--seed=", 7)) {
			s->seed = strtoull(value + 1, 0, 10);
		} else if (value && !strncmp(argv[i], "--family=", 9)) {
			s->only_family = atol(value + 1);
		} else if (value && !strncmp(argv[i], "--case=", 7)) {
			s->only_case = atol(value + 1);
		} else {
			fprintf(stderr, "%s: [--share=X] [--seed=N] [--family=N [--case=N]]\n", argv[0]);
			exit(2);
		}
	}
	s->show = s->only_case >= 0;
}

static void print_command(const struct stress *s, long index)
{
	printf("\n    %s --seed=%llu --family=%ld --case=%ld", s->program, (unsigned long long)s->seed, s->family_index, index);
}

static void end_family(struct stress *s)
{
	if (!s->family[0] || s->cases == 0)
		return;
	printf("%s: %s: %ld cases, %ld flagged, %ld wrong", s->name, s->family, s->cases, s->flagged, s->wrong);
	if (s->worst_case >= 0) {
		if (s->measure)
			printf("; worst %.3g %s", s->worst, s->measure);
		else
			printf("; worst loses %.1f digits", s->worst);
		print_command(s, s->worst_case);
		printf("  %s", s->worst_about);
	} else if (s->first_flagged >= 0) {
		printf("; nothing to measure, the first flagged");
		print_command(s, s->first_flagged);
		printf("  %s", s->flagged_about);
	}
	if (s->wrong) {
		print_command(s, s->first_wrong);
		printf("  WRONG: %s", s->why);
	}
	printf("\n");
	fflush(stdout);
	s->run_all += s->cases;
	s->wrong_all += s->wrong;
}

void stress_family(struct stress *s, const char *family, long cases)
{
	end_family(s);
	snprintf(s->family, sizeof s->family, "%s", family);
	s->family_index++;
	s->cases = (long)ceil((double)cases * s->share);
	if (s->only_family >= 0 && s->only_family != s->family_index)
		s->cases = 0;
	s->flagged = s->wrong = 0;
	s->worst = -INFINITY;
	s->measure = 0;
	s->worst_case = s->first_wrong = s->first_flagged = s->index = -1;
	s->case_flagged = s->case_wrong = false;
	if (s->only_case >= 0 && s->cases) {
		s->index = s->only_case - 1;
		s->cases = 1;
	}
}

/* One number of the three that name a case, well mixed, so that neighbours have nothing in common. */
static uint64_t seed_of(const struct stress *s)
{
	struct rng rng = { s->seed };
	rng.state = rng_bits(&rng) + (uint64_t)s->family_index;
	rng.state = rng_bits(&rng) + (uint64_t)s->index;
	return rng_bits(&rng);
}

bool stress_case(struct stress *s)
{
	long end = s->only_case >= 0 ? s->only_case + 1 : s->cases;
	s->index++;
	s->case_flagged = s->case_wrong = false;
	s->about[0] = 0;
	s->rng.state = seed_of(s);
	return s->cases && s->index < end;
}

void stress_about(struct stress *s, const char *fmt, ...)
{
	va_list ap;
	va_start(ap, fmt);
	vsnprintf(s->about, sizeof s->about, fmt, ap);
	va_end(ap);
	if (s->show)
		printf("%s\n", s->about);
}

void stress_measure(struct stress *s, double value, const char *unit)
{
	s->measure = unit;
	if (s->show)
		printf("  %.6g %s\n", value, unit ? unit : "digits lost");
	if (isnan(value))
		stress_wrong(s, "not a number");
	if (!(value > s->worst))
		return;
	s->worst = value;
	s->worst_case = s->index;
	memcpy(s->worst_about, s->about, sizeof s->about);
}

void stress_lost_of(struct stress *s, double error, double digit)
{
	stress_measure(s, isnan(error) ? NAN : fmax(log10(error / digit), 0), 0);
}

void stress_lost(struct stress *s, double error)
{
	stress_lost_of(s, error, DBL_EPSILON);
}

void stress_flagged(struct stress *s)
{
	if (s->show)
		printf("  flagged\n");
	if (s->first_flagged < 0) {
		s->first_flagged = s->index;
		memcpy(s->flagged_about, s->about, sizeof s->about);
	}
	s->flagged += !s->case_flagged;
	s->case_flagged = true;
}

void stress_wrong(struct stress *s, const char *fmt, ...)
{
	char why[200];
	va_list ap;
	va_start(ap, fmt);
	vsnprintf(why, sizeof why, fmt, ap);
	va_end(ap);
	if (s->show)
		printf("  WRONG: %s\n", why);
	if (!s->wrong)
		snprintf(s->why, sizeof s->why, "%s", why);
	if (s->first_wrong < 0)
		s->first_wrong = s->index;
	s->wrong += !s->case_wrong;
	s->case_wrong = true;
}

int stress_end(struct stress *s)
{
	end_family(s);
	printf("%s: %ld cases, %ld wrong\n", s->name, s->run_all, s->wrong_all);
	return s->wrong_all > 0 || s->run_all == 0;
}
