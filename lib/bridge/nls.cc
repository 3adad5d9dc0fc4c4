#include "bridge/nls.h"

#include <ceres/ceres.h>
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/* Central differences with the step that balances truncation against rounding, one-sided where the function ends. */
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

/* Rank and covariance from the singular values of the column-scaled Jacobian: parameters of unlike units are
 * compared fairly, and a direction the data does not see is reported instead of inverted. */
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

bool solve(nls_result *result, int n, double *x, const double *lo, const double *hi, int m, nls_fn fn, void *ctx,
           const nls_conf *conf, double *cov, err *err)
{
	ceres::Problem problem;
	auto *block = new Block(fn, ctx, n, m, conf && conf->numeric);
	problem.AddResidualBlock(block, nullptr, x);
	for (int j = 0; j < n; j++) {
		if (lo && std::isfinite(lo[j]))
			problem.SetParameterLowerBound(x, j, lo[j]);
		if (hi && std::isfinite(hi[j]))
			problem.SetParameterUpperBound(x, j, hi[j]);
	}
	ceres::Solver::Options options;
	options.linear_solver_type = ceres::DENSE_QR;
	options.logging_type = ceres::SILENT;
	options.num_threads = 1;  // one block: threads would only cost
	options.max_num_iterations = conf && conf->max_iter ? conf->max_iter : 50;
	if (conf && conf->ftol > 0)
		options.function_tolerance = conf->ftol;
	if (conf && conf->gtol > 0)
		options.gradient_tolerance = conf->gtol;
	if (conf && conf->xtol > 0)
		options.parameter_tolerance = conf->xtol;
	ceres::Solver::Summary summary;
	ceres::Solve(options, &problem, &summary);
	if (!summary.IsSolutionUsable())
		return err_set(err, "least squares: no usable solution");
	*result = {};
	result->cost0 = summary.initial_cost;
	result->cost = summary.final_cost;
	result->iterations = static_cast<int>(summary.iterations.size()) - 1;
	result->converged = summary.termination_type == ceres::CONVERGENCE;
	std::vector<double> r(m);
	Matrix J(m, n);
	const double *at = x;
	double *jacobian = J.data();
	if (!block->Evaluate(&at, r.data(), &jacobian))
		return err_set(err, "least squares: no derivatives at the solution");
	covariance(result, J, cov);
	return true;
}

}  // namespace

bool nls_solve(nls_result *result, int n, double *x, const double *lo, const double *hi, int m, nls_fn fn, void *ctx,
               const nls_conf *conf, double *cov, err *err)
{
	try {
		return solve(result, n, x, lo, hi, m, fn, ctx, conf, cov, err);
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
