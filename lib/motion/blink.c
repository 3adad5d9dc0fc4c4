#include "motion/blink.h"

#include "motion/saccade.h"

struct blink blink_make(double start, double amplitude, const struct blink_conf *conf)
{
	double down = conf->down_s + conf->down_per_deg * amplitude;
	double closure = amplitude / conf->full;
	return (struct blink){ start, down, conf->hold_s, down * conf->up_over_down, amplitude, closure < 1 ? closure : 1 };
}

double blink_interval(struct rng *rng, const struct blink_conf *conf)
{
	double f;
	int tries = 0;
	do
		f = conf->frequency[0] + conf->frequency[1] * rng_normal(rng);
	while ((f < conf->frequency_range[0] || f > conf->frequency_range[1]) && ++tries < 1000);
	f = f < conf->frequency_range[0] ? conf->frequency_range[0] : f > conf->frequency_range[1] ? conf->frequency_range[1] : f;
	return 1 / f;
}

double blink_amplitude(struct rng *rng, const struct blink_conf *conf)
{
	double a = conf->amplitude[0] + conf->amplitude[1] * rng_normal(rng);
	return a > 0 ? a : 0;
}

double blink_end(const struct blink *b)
{
	return b->start + b->down + b->hold + b->up;
}

double blink_closure(const struct blink *b, double t)
{
	if (t >= blink_end(b))
		return 0;
	t -= b->start;
	if (t <= b->down)
		return b->closure * minimum_jerk(t / b->down);
	return b->closure * (1 - minimum_jerk((t - b->down - b->hold) / b->up));
}

double blink_eye(const struct blink *b, double t)
{
	t -= b->start;
	double out = 0.8 * b->down, back = b->down + 0.8 * b->up;
	return t <= out ? minimum_jerk(t / out) : 1 - minimum_jerk((t - out) / back);
}
