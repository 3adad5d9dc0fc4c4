#include "limbus/odds_net.h"

#include <math.h>
#include <stdlib.h>

#include "base/call.h"
#include "base/mem.h"
#include "net/net.h"

const double odds_tolerance[ODDS_CURVE] = { 0.0025, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06, 0.1 };

struct odds_net {
	struct net *net;
};

bool odds_open(struct odds_net **out, const char *path, struct err *err)
{
	struct net *net;
	*out = 0;
	if (!net_open(&net, path, (const int[3]){ ODDS_TRAITS, 1, 1 }, (const int[3]){ ODDS_CURVE, 1, 1 }, err))
		return false;
	*out = mem_new(1, sizeof **out);
	(*out)->net = net;
	return true;
}

bool odds_open_shipped(struct odds_net **net, struct err *err)
{
	char *path = call_config_file("odds.onnx");
	const bool ok = odds_open(net, path, err);
	free(path);
	return ok;
}

void odds_close(struct odds_net *net)
{
	if (net)
		net_close(net->net);
	free(net);
}

bool odds_of(double curve[ODDS_CURVE], const double x[ODDS_TRAITS], struct odds_net *net, struct err *err)
{
	float in[ODDS_TRAITS];
	for (int i = 0; i < ODDS_TRAITS; i++)
		in[i] = isfinite(x[i]) ? (float)x[i] : 0;
	struct net_picture p = { .in = in, .height = 1, .width = 1 };
	const bool ok = net_run(&p, 1, net->net, ODDS_TRAITS, err);
	// the first, and what each adds to the one before
	for (int i = 0; i < ODDS_CURVE && ok; i++)
		curve[i] = i ? curve[i - 1] + fmax(p.out[i], 0) + log1p(exp(-fabs(p.out[i]))) : p.out[i];
	free(p.out);
	return ok;
}

double odds_log(const double curve[ODDS_CURVE], double tolerance)
{
	int i = 1;
	while (i + 1 < ODDS_CURVE && tolerance > odds_tolerance[i])
		i++;
	const double part = log(tolerance / odds_tolerance[i - 1]) / log(odds_tolerance[i] / odds_tolerance[i - 1]);
	return curve[i - 1] + fmin(fmax(part, 0), 1) * (curve[i] - curve[i - 1]);
}

static const double ONE_SIGMA = 0.7662;  // log odds of 68.27 %

double odds_one_sigma(const double curve[ODDS_CURVE])
{
	if (curve[0] >= ONE_SIGMA)
		return 0;
	for (int i = 1; i < ODDS_CURVE; i++)
		if (curve[i] >= ONE_SIGMA)
			return odds_tolerance[i - 1] * pow(odds_tolerance[i] / odds_tolerance[i - 1], (ONE_SIGMA - curve[i - 1]) / (curve[i] - curve[i - 1]));
	return odds_tolerance[ODDS_CURVE - 1];
}

double odds_wider(double sigma, const double curve[ODDS_CURVE])
{
	return fmax(1, odds_one_sigma(curve) / sigma);
}
