/* odds_net: the network that tells the odds from what was looked at (config/odds.onnx), and what follows from them.
 */
#ifndef LIMBUS_ODDS_NET_H
#define LIMBUS_ODDS_NET_H
#include "base/err.h"
#include "limbus/odds.h"

/* Natural logarithms of the odds that centre and semi-axes are all off by less than odds_tolerance[i] of the semi-axis; they rise with i. */
enum { ODDS_CURVE = 9 };
extern const double odds_tolerance[ODDS_CURVE];

/* The same for any tolerance, semi-axes; beyond the first and the last as there. */
double odds_log(const double curve[ODDS_CURVE], double tolerance);

/* The error, semi-axes, that 68 % do not exceed; 0 below the least tolerance. */
double odds_one_sigma(const double curve[ODDS_CURVE]);

/* How many times as wide as its own sigma (odds_sigma, above 0) says an ellipse's error is, at least 1: the largest part of the error, which as a rule is one alone, the
 * height that lids hide, is below its sigma in 68 % of all cases. */
double odds_wider(double sigma, const double curve[ODDS_CURVE]);

struct odds_net;

/* Loads the network, or the one that comes with the programs. False, err set: the file is missing, damaged or of another shape. odds_close, which
 * accepts null. One call at a time for each. */
bool odds_open(struct odds_net **net, const char *path, struct err *err);
bool odds_open_shipped(struct odds_net **net, struct err *err);
void odds_close(struct odds_net *net);

/* False, err set, where the network does not run. */
bool odds_of(double curve[ODDS_CURVE], const double x[ODDS_TRAITS], struct odds_net *net, struct err *err);

#endif
