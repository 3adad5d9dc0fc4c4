/* nricp_solve: displacements of a graph's nodes that fit what was matched and keep the graph smooth. */
#ifndef REGISTER_NRICP_SOLVE_H
#define REGISTER_NRICP_SOLVE_H
#include <stdbool.h>

#include "register/nricp/graph.h"

/* What a node is asked to do: sum_i (place_i + t_i - goal_i)' K_i (place_i + t_i - goal_i). */
struct nricp_pulls {
	double (*k)[6];     // [n] K: xx xy xz yy yz zz
	double (*goal)[4];  // [n]
};

struct nricp_solver;
/* direct: by CHOLMOD, factored anew each time in an order found once; else conjugate gradients from what t is, at most
 * `steps` of them or to a residual of `tolerance`. nricp_solver_free. */
struct nricp_solver *nricp_solver_new(const struct nricp_graph *graph, bool direct, int steps, double tolerance);
void nricp_solver_free(struct nricp_solver *solver);

/* t gets the displacements of least stiffness (t' R t - 2 t' pull) + data. pull: of nricp_graph_pull. */
void nricp_solver_run(struct nricp_solver *solver, double (*t)[4], const struct nricp_pulls *data, const double (*pull)[4],
                      double stiffness);

#endif
