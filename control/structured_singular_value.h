#pragma once

#include <Eigen/Core>
#include <vector>

namespace handloop::control {

/// A block of the uncertainty: full complex of a size, or one real number.
struct UncertaintyBlock {
  int size = 1;
  bool real = false;
};

/// Upper bound on the structured singular value of a complex square matrix, with the scalings that prove it
/// (SLICOT AB13MD; Fan, Tits and Doyle 1991). Exact for up to three complex blocks. Throws InputError where the blocks
/// do not add up to the matrix, or real blocks are larger than 1; RequirementError where SLICOT fails. Allocates.
struct MuBound {
  double value = 0.0;
  Eigen::VectorXd scaling;  ///< D of || D M D^-1 ||, smallest 1
};
MuBound mu_upper_bound(const Eigen::MatrixXcd& matrix, const std::vector<UncertaintyBlock>& blocks);

}  // namespace handloop::control
