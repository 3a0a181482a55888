#include "identify/bounded_least_squares.h"

#include <ceres/ceres.h>

namespace handloop::identify {

namespace {

class DynamicResiduals final : public ceres::CostFunction {
 public:
  DynamicResiduals(const ResidualFunction& function, Eigen::Index residuals, Eigen::Index parameters)
      : function_(function), residuals_(residuals), parameters_(parameters) {
    set_num_residuals(static_cast<int>(residuals));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(parameters[0], parameters_);
    Eigen::Map<Eigen::VectorXd> r(residuals, residuals_);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Jacobian> map(jacobians[0], residuals_, parameters_);
      Eigen::Ref<Jacobian> jacobian(map);
      return function_(x, r, &jacobian);
    }
    return function_(x, r, nullptr);
  }

 private:
  const ResidualFunction& function_;
  Eigen::Index residuals_, parameters_;
};

}  // namespace

LeastSquaresResult minimise(const ResidualFunction& function, Eigen::Index residuals, Eigen::VectorXd start,
                            const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                            const LeastSquaresSettings& settings) {
  LeastSquaresResult result;
  result.x = start.cwiseMax(lower).cwiseMin(upper);
  ceres::Problem problem;
  problem.AddResidualBlock(new DynamicResiduals(function, residuals, result.x.size()), nullptr, result.x.data());
  for (int i = 0; i < result.x.size(); ++i) {
    problem.SetParameterLowerBound(result.x.data(), i, lower(i));
    problem.SetParameterUpperBound(result.x.data(), i, upper(i));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = settings.max_iterations;
  options.function_tolerance = settings.function_tolerance;
  options.parameter_tolerance = settings.parameter_tolerance;
  options.gradient_tolerance = 0;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  result.sum_of_squares = 2 * summary.final_cost;
  result.converged = summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE;
  return result;
}

}  // namespace handloop::identify
