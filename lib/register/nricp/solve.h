/* nricp_solve: the linear solver of a round: displacements of a graph's nodes that fit the matches and keep the graph smooth. */
#ifndef REGISTER_NRICP_SOLVE_H
#define REGISTER_NRICP_SOLVE_H
#include <stdbool.h>

#include "register/nricp/graph.h"

/* The data term: sum_i (place_i + t_i - goal_i)' K_i (place_i + t_i - goal_i). */
struct nricp_pulls {
	double (*k)[6];     // [n] K: xx xy xz yy yz zz
	double (*goal)[4];  // [n]
};

struct nricp_solver;
/* A solver for a graph, which must outlive it. nricp_solver_free, which accepts null.
 * direct            true: CHOLMOD, with one symbolic factorisation for all calls; false: preconditioned conjugate gradients
 * steps, tolerance  of the conjugate gradients: most steps, and the relative residual at which they stop */
struct nricp_solver *nricp_solver_new(const struct nricp_graph *graph, bool direct, int steps, double tolerance);
void nricp_solver_free(struct nricp_solver *solver);

/* Minimises stiffness (t' R t - 2 t' pull) + data over the displacements.
 * t     [graph->n], in: where conjugate gradients start; out: the displacements
 * pull  [graph->n], of nricp_graph_pull */
void nricp_solver_run(struct nricp_solver *solver, double (*t)[4], const struct nricp_pulls *data, const double (*pull)[4],
                      double stiffness);

#endif
