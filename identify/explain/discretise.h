#pragma once

#include <Eigen/Core>

namespace handloop::identify {

/// Exact step of x' = A x + B u over h seconds for inputs that are linear within the step:
/// x(h) = transition x(0) + at_start u(0) + at_end u(h). A constant input u takes at_start + at_end.
struct LinearStep {
  Eigen::MatrixXd transition;  ///< n x n
  Eigen::MatrixXd at_start;    ///< n x inputs
  Eigen::MatrixXd at_end;      ///< n x inputs
};

/// By the exponential of Van Loan's augmented matrix (IEEE TAC 23 (1978) 395).
LinearStep discretise(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double h_s);

/// The scalar case x' = -rate x + u / scale in closed form, exact for any rate >= 0 (also where exp underflows).
struct ScalarStep {
  double transition, at_start, at_end;
};
ScalarStep discretise_decay(double rate_per_s, double gain, double h_s);

}  // namespace handloop::identify
