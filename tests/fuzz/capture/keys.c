#include "tests/fuzz/capture/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { KEYS = 400, CHOICES = 12 };

static struct key {
	char *key, *choices[CHOICES];
	enum opt_type type;
	int count;
	double min, max;
} keys[KEYS];
static int n_keys;

void keys_take(const char *stage, int n, const struct opt opts[])
{
	for (int i = 0; i < n && !keys[i].key && i < KEYS; i++, n_keys++) {
		keys[i] = (struct key){ opt_full_key(stage, opts[i].key), { 0 }, opts[i].type, opts[i].count, opts[i].min, opts[i].max };
		for (int c = 0; opts[i].choices && opts[i].choices[c] && c < CHOICES; c++)
			keys[i].choices[c] = strdup(opts[i].choices[c]);
	}
}

uint64_t keys_random(uint64_t *seed)
{
	uint64_t z = *seed += 0x9e3779b97f4a7c15ull;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
	return z ^ (z >> 31);
}

static double chance(uint64_t *seed)
{
	return (double)(keys_random(seed) >> 11) * 0x1p-53;
}

void keys_number(char *out, size_t most, uint64_t *seed)
{
	static const char *const odd[] = { "0", "-0", "1", "-1", "1e-300", "-1e-300", "1e300", "-1e300", "nan", "inf", "-inf", "1e6", "-1e6", "255", "256",
		"65536", "2147483647", "2147483648", "-2147483648", "4294967296", "9223372036854775807", "1e-9", "0.5", "", "1.5.2", "0x10", "1e", "--1", "90", "180", "360" };
	snprintf(out, most, "%s", odd[keys_random(seed) % COUNT(odd)]);
}

/* One number of a key: at its limits or between, sometimes just outside. */
static void number(char *out, size_t most, const struct key *k, uint64_t *seed)
{
	const bool whole = k->type == OPT_T_INT;
	const double u = chance(seed);
	double x = 0;
	switch (keys_random(seed) % 10) {
	case 0: case 1: x = k->min; break;
	case 2: x = k->max; break;
	case 3: x = k->min + u * (k->max - k->min); break;
	case 4: x = k->min > 0 ? k->min * pow(k->max / k->min, u) : u * fmin(k->max, 10); break;
	case 5: x = whole ? k->min + floor(8 * u) : k->min + 1e-6 * u * (k->max - k->min); break;
	case 6: x = whole ? k->max + 1 : nextafter(k->max, INFINITY); break;
	case 7: x = whole ? k->min - 1 : nextafter(k->min, -INFINITY); break;
	case 8: x = fmin(k->max, fmax(k->min, floor(1000 * u))); break;
	default: keys_number(out, most, seed); return;
	}
	snprintf(out, most, "%.17g", whole ? floor(x) : x);
}

size_t keys_line(char *out, size_t most, int n, const char *const names[], uint64_t *seed)
{
	if (!n_keys)
		return 0;
	const struct key *k = &keys[keys_random(seed) % (uint64_t)n_keys];
	const char *star = strchr(k->key, '*'), *name = n ? names[keys_random(seed) % (uint64_t)n] : "a";
	int at = star ? snprintf(out, most, "%.*s%s%s = ", (int)(star - k->key), k->key, name, star + 1) : snprintf(out, most, "%s = ", k->key);
	static const char *const words[] = { "yes", "no", "", "left", "right", "light.exr", "shots.json", "subject.ply", "D65", "a b c", "../x", "%n%s", "a.json" };
	int count = k->type == OPT_T_REALS || (k->type == OPT_T_EACH && k->count) ? k->count : 1;
	const uint64_t odd = keys_random(seed) % 16;
	count += odd == 0 ? 1 : odd == 1 ? -1 : 0;
	for (int i = 0; i < count && at < (int)most - 40; i++) {
		char value[40];
		const bool text = k->type == OPT_T_STR || (k->type == OPT_T_EACH && !k->count) || k->type == OPT_T_BOOL;
		if (k->type == OPT_T_CHOICE && k->choices[0] && odd != 2) {
			int c = 0;
			while (c < CHOICES && k->choices[c])
				c++;
			snprintf(value, sizeof value, "%s", k->choices[keys_random(seed) % (uint64_t)c]);
		} else if (text || k->type == OPT_T_CHOICE)
			snprintf(value, sizeof value, "%s", words[keys_random(seed) % (k->type == OPT_T_BOOL && odd > 2 ? 2 : COUNT(words))]);
		else
			number(value, sizeof value, k, seed);
		at += snprintf(out + at, most - (size_t)at, "%s%s", i ? " " : "", value);
	}
	at += snprintf(out + at, most - (size_t)at, "\n");
	return at < (int)most ? (size_t)at : 0;
}
