#include "control/structured_singular_value.h"

#include <cmath>
#include <string>

#include "models/errors.h"

extern "C" void ab13md_(const char* fact, const int* n, std::complex<double>* z, const int* ldz, const int* m,
                        const int* nblock, const int* itype, double* x, double* bound, double* d, double* g, int* iwork,
                        double* dwork, const int* ldwork, std::complex<double>* zwork, const int* lzwork, int* info,
                        std::size_t fact_length);

namespace handloop::control {

MuBound mu_upper_bound(const Eigen::MatrixXcd& matrix, const std::vector<UncertaintyBlock>& blocks) {
  const int n = static_cast<int>(matrix.rows()), m = static_cast<int>(blocks.size());
  int total = 0;
  std::vector<int> size, type;
  for (const auto& block : blocks) {
    if (block.size < 1 || (block.real && block.size != 1)) {
      throw InputError("mu: blocks are complex of size 1 or more, or real of size 1");
    }
    total += block.size;
    size.push_back(block.size);
    type.push_back(block.real ? 1 : 2);
  }
  if (matrix.rows() != matrix.cols() || total != n) {
    throw InputError("mu: blocks of total size " + std::to_string(total) + " for a matrix of " +
                     std::to_string(matrix.rows()) + " rows and " + std::to_string(matrix.cols()) +
                     " columns; they must be equal");
  }
  MuBound bound;
  bound.scaling = Eigen::VectorXd::Ones(n);
  if (n == 0 || matrix.isZero(0)) return bound;
  if (n == 1 && !blocks[0].real) {
    bound.value = std::abs(matrix(0, 0));
    return bound;
  }
  Eigen::MatrixXcd z = matrix;
  const auto count = [](int words) { return static_cast<std::size_t>(words); };
  const int real_work = 2 * n * n * m - n * n + 9 * m * m + n * m + 11 * n + 33 * m - 11;
  const int complex_work = 6 * n * n * m + 12 * n * n + 6 * m + 6 * n - 3;
  std::vector<double> x(count(2 * m)), d(count(n)), g(count(n)), dwork(count(real_work));
  std::vector<int> iwork(count(std::max(4 * m - 2, n)));
  std::vector<std::complex<double>> zwork(count(complex_work));
  int info = 0;
  ab13md_("N", &n, z.data(), &n, &m, size.data(), type.data(), x.data(), &bound.value, d.data(), g.data(), iwork.data(),
          dwork.data(), &real_work, zwork.data(), &complex_work, &info, 1);
  if (info != 0 || !std::isfinite(bound.value))
    throw RequirementError("mu: SLICOT AB13MD failed with info " + std::to_string(info));
  for (int i = 0; i < n; ++i) bound.scaling(i) = d[count(i)];
  const double least = bound.scaling.minCoeff();
  if (least > 0) bound.scaling /= least;
  return bound;
}

}  // namespace handloop::control
