#include "models/matrix_exponential.h"

#include <unsupported/Eigen/MatrixFunctions>

namespace handloop::models {

Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& a) {
  return a.exp();
}

}  // namespace handloop::models
