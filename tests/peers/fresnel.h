/* fresnel: Fresnel's equations for unpolarised light. */
#ifndef PEERS_FRESNEL_H
#define PEERS_FRESNEL_H

/* Transmittance from index n1 into n2; cos_i: of the angle of incidence, on the side of n1. 0 in total reflection. */
double fresnel_transmittance(double cos_i, double n1, double n2);

#endif
