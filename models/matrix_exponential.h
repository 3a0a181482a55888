#pragma once

#include <Eigen/Core>

namespace handloop::models {

/// exp(A) of a square matrix by scaling, squaring and Pade approximants (Higham 2005, Eigen's implementation, which is
/// slow to compile and is therefore instantiated once, here). Allocates.
Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& a);

}  // namespace handloop::models
