#include "bridge/nls.h"

#include <ceres/ceres.h>
#include <glog/logging.h>
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/* Central differences with the step that balances truncation and rounding, one-sided at the end of the function's domain. */
bool differences(nls_fn fn, void *ctx, int n, int m, const double *x, double *J)
{
	std::vector<double> at(x, x + n), up(m), down(m);
	for (int j = 0; j < n; j++) {
		double h = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::fabs(x[j]));
		at[j] = x[j] + h;
		bool above = fn(ctx, at.data(), up.data(), nullptr);
		at[j] = x[j] - h;
		bool below = fn(ctx, at.data(), down.data(), nullptr);
		at[j] = x[j];
		if (!above && !below)
			return false;
		if (!above && !fn(ctx, at.data(), up.data(), nullptr))
			return false;
		if (!below && !fn(ctx, at.data(), down.data(), nullptr))
			return false;
		double span = (above ? h : 0) + (below ? h : 0);
		for (int i = 0; i < m; i++)
			J[static_cast<long>(i) * n + j] = (up[i] - down[i]) / span;
	}
	return true;
}

class Block : public ceres::CostFunction {
public:
	Block(nls_fn fn, void *ctx, int n, int m, bool numeric) : fn_(fn), ctx_(ctx), n_(n), m_(m), numeric_(numeric)
	{
		set_num_residuals(m);
		mutable_parameter_block_sizes()->push_back(n);
	}
	bool Evaluate(double const *const *x, double *r, double **jacobians) const override
	{
		double *J = jacobians ? jacobians[0] : nullptr;
		if (!fn_(ctx_, x[0], r, numeric_ ? nullptr : J))
			return false;
		return !J || !numeric_ || differences(fn_, ctx_, n_, m_, x[0], J);
	}

private:
	nls_fn fn_;
	void *ctx_;
	int n_, m_;
	bool numeric_;
};

/* Rank and covariance from the singular values of the column-scaled Jacobian: the scaling makes parameters of different units
 * comparable, and a direction that the data does not determine is reported instead of inverted. */
void covariance(nls_result *result, const Matrix &J, double *cov)
{
	const int n = static_cast<int>(J.cols());
	Eigen::VectorXd scale(n);
	Matrix S = J;
	for (int j = 0; j < n; j++) {
		double norm = J.col(j).norm();
		scale[j] = norm > 0 ? norm : 1;
		S.col(j) /= scale[j];
	}
	Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eig(S.transpose() * S);
	const Eigen::VectorXd w = eig.eigenvalues().cwiseMax(0.0);
	const double top = w[n - 1], floor = top * 1e-13;
	result->rank = 0;
	for (int j = 0; j < n; j++)
		result->rank += w[j] > floor && top > 0;
	result->condition = w[0] > 0 ? std::sqrt(top / w[0]) : std::numeric_limits<double>::infinity();
	if (!cov)
		return;
	const Eigen::MatrixXd V = eig.eigenvectors();
	for (int a = 0; a < n; a++)
		for (int b = 0; b < n; b++) {
			double sum = 0;
			for (int j = 0; j < n; j++)
				if (w[j] > floor)
					sum += V(a, j) * V(b, j) / w[j];
			cov[a * n + b] = sum / (scale[a] * scale[b]);
		}
	for (int a = 0; a < n; a++)
		for (int j = 0; j < n; j++)
			if (!(w[j] > floor) && std::fabs(V(a, j)) > 1e-6) {
				for (int b = 0; b < n; b++)
					cov[a * n + b] = cov[b * n + a] = 0;
				cov[a * n + a] = std::numeric_limits<double>::infinity();
			}
}

struct Bounds {
	const double *lo, *hi;  // null: none
};

ceres::Solver::Options options_of(const nls_conf *conf)
{
	ceres::Solver::Options options;
	options.linear_solver_type = ceres::DENSE_QR;
	options.logging_type = ceres::SILENT;
	options.num_threads = 1;  // one block: threads do not pay
	options.max_num_iterations = conf && conf->max_iter ? conf->max_iter : 50;
	if (conf && conf->ftol > 0)
		options.function_tolerance = conf->ftol;
	if (conf && conf->gtol > 0)
		options.gradient_tolerance = conf->gtol;
	if (conf && conf->xtol > 0)
		options.parameter_tolerance = conf->xtol;
	return options;
}

/* One run of Ceres from x; parameters in `held` stay where they are. */
bool run(nls_result *result, Block *block, std::vector<double> &x, const Bounds &bounds, const std::vector<int> &held,
         const nls_conf *conf, err *err)
{
	ceres::Problem::Options borrowed;
	borrowed.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
	ceres::Problem problem(borrowed);
	const int n = static_cast<int>(x.size());
	problem.AddResidualBlock(block, nullptr, x.data());
	for (int j = 0; j < n; j++) {
		if (bounds.lo && std::isfinite(bounds.lo[j]))
			problem.SetParameterLowerBound(x.data(), j, bounds.lo[j]);
		if (bounds.hi && std::isfinite(bounds.hi[j]))
			problem.SetParameterUpperBound(x.data(), j, bounds.hi[j]);
	}
	if (!held.empty())
		problem.SetManifold(x.data(), new ceres::SubsetManifold(n, held));
	ceres::Solver::Summary summary;
	ceres::Solve(options_of(conf), &problem, &summary);
	if (!summary.IsSolutionUsable())
		return err_set(err, "least squares: no usable solution");
	result->cost = summary.final_cost;
	result->iterations += static_cast<int>(summary.iterations.size()) - 1;
	result->converged = summary.termination_type == ceres::CONVERGENCE;
	if (held.empty())
		result->cost0 = summary.initial_cost;
	return true;
}

/* Finds the active bounds: parameters at a bound where the cost descends beyond it. */
std::vector<int> pressed(const std::vector<double> &x, const Bounds &bounds, const Eigen::VectorXd &gradient)
{
	std::vector<int> held;
	for (int j = 0; j < static_cast<int>(x.size()); j++)
		if ((bounds.lo && x[j] <= bounds.lo[j] && gradient[j] > 0) || (bounds.hi && x[j] >= bounds.hi[j] && gradient[j] < 0))
			held.push_back(j);
	return held;
}

/* Active set method round Ceres, which clips its step at the bounds and so changes its direction: with correlated parameters and
 * an active bound it stops short of the minimum. Parameters at an active bound are held there and the others solved again, until
 * the set stays the same. */
bool solve(nls_result *result, int n, double *x, const Bounds &bounds, int m, nls_fn fn, void *ctx,
           const nls_conf *conf, double *cov, err *err)
{
	Block block(fn, ctx, n, m, conf && conf->numeric);
	std::vector<double> at(x, x + n), r(m);
	std::vector<int> held, before;
	Matrix J(m, n);
	*result = {};
	for (int round = 0; round < 2 * n + 2; round++) {
		if (static_cast<int>(held.size()) < n && !run(result, &block, at, bounds, held, conf, err))
			return false;
		const double *values = at.data();
		double *jacobian = J.data();
		if (!block.Evaluate(&values, r.data(), &jacobian))
			return err_set(err, "least squares: no derivatives at the solution");
		before = held;
		held = pressed(at, bounds, J.transpose() * Eigen::Map<Eigen::VectorXd>(r.data(), m));
		if (held == before)
			break;
	}
	std::copy(at.begin(), at.end(), x);
	covariance(result, J, cov);
	return true;
}

}  // namespace

/* Errors are returned in struct err. Once: the flag is shared by all threads. */
static void hush()
{
	static const int level = FLAGS_minloglevel = google::GLOG_FATAL;
	static_cast<void>(level);
}

bool nls_solve(nls_result *result, int n, double *x, const double *lo, const double *hi, int m, nls_fn fn, void *ctx,
               const nls_conf *conf, double *cov, err *err)
{
	try {
		hush();
		return solve(result, n, x, Bounds{ lo, hi }, m, fn, ctx, conf, cov, err);
	} catch (const std::exception &e) {
		return err_set(err, "least squares: %s", e.what());
	}
}

double nls_check_jacobian(int n, const double *x, int m, nls_fn fn, void *ctx)
{
	try {
		std::vector<double> r(m);
		Matrix J(m, n), D(m, n);
		if (!fn(ctx, x, r.data(), J.data()) || !differences(fn, ctx, n, m, x, D.data()))
			return std::numeric_limits<double>::infinity();
		double worst = 0;
		for (int j = 0; j < n; j++) {
			double norm = std::max(D.col(j).norm(), 1e-300);
			worst = std::max(worst, (J.col(j) - D.col(j)).norm() / norm);
		}
		return worst;
	} catch (const std::exception &) {
		return std::numeric_limits<double>::infinity();
	}
}
