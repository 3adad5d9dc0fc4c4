/* posterior: of all trials of one photograph, the likeliest limbus, its best rival, and the chance that the answer is off.
 */
#ifndef LIMBUS_POSTERIOR_H
#define LIMBUS_POSTERIOR_H
#include "limbus/trial.h"

/* Weighs the trials against each other and against "none of them": those that say the same as a likelier one add nothing, each
 * other one that overlaps it is a rival. Fills best and rival (indices, -1: none) and gross, which is 1 where there is none. */
void posterior_of(struct posterior *posterior, const struct trials *trials);

/* Whether trial i says the same as a likelier one: so many sigmas apart at most (struct same_conf) where either was seen. What lids hide may
 * differ, and has its sigma. */
bool trial_repeats(const struct trials *trials, int i);

/* After the likeliest one was measured in full: widens its covariance (of q, px) as its odds say, adds to it what the rivals say,
 * each by its chance, and to gross where the full measurement is another ellipse than the trial was. */
void posterior_settle(struct posterior *posterior, struct rim *rim, const struct trials *trials);

/* The least tolerance above conf->tolerance, of odds_tolerance and at most conf->rough_tolerance, from which the answer, the full measurement rim of the likeliest
 * trial, is farther off with a chance of conf->rough_gross at most; 0: none. */
double posterior_taken_at(const struct posterior *posterior, const struct rim *rim, const struct trials *trials);

#endif
