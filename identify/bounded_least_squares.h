#pragma once

#include <Eigen/Core>
#include <functional>

namespace handloop::identify {

/// Row-major, residuals by parameters.
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Fills the residuals at x and, where `jacobian` is not null, its entries too (already sized). Returns false where the
/// model cannot be evaluated at x.
using ResidualFunction = std::function<bool(const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> residuals,
                                            Eigen::Ref<Jacobian>* jacobian)>;

struct LeastSquaresSettings {
  int max_iterations = 200;
  double function_tolerance = 1e-14;
  double parameter_tolerance = 1e-11;
};

struct LeastSquaresResult {
  Eigen::VectorXd x;
  double sum_of_squares = 0.0;
  bool converged = false;
};

/// Minimises the sum of squared residuals within lower <= x <= upper (trust region, Ceres). Parameters should be scaled
/// to order one by the caller. The start is moved inside the bounds. Local: several starts are the caller's business.
LeastSquaresResult minimise(const ResidualFunction& function, Eigen::Index residuals, Eigen::VectorXd start,
                            const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                            const LeastSquaresSettings& settings = {});

}  // namespace handloop::identify
