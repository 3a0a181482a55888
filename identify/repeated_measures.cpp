#include "identify/repeated_measures.h"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <stdexcept>

namespace handloop::identify {

namespace {

/// Greenhouse and Geisser's epsilon from the covariance of the conditions.
double sphericity_epsilon(const Eigen::MatrixXd& values) {
  const auto k = static_cast<double>(values.cols());
  const Eigen::MatrixXd centred = values.rowwise() - values.colwise().mean();
  Eigen::MatrixXd S = centred.transpose() * centred;
  const Eigen::VectorXd rows = S.rowwise().mean();
  const double grand = S.mean();
  S.colwise() -= rows;
  S.rowwise() -= rows.transpose();
  S.array() += grand;
  const double square = S.squaredNorm();
  return square > 0 ? std::clamp(S.trace() * S.trace() / ((k - 1) * square), 1 / (k - 1), 1.0) : 1.0;
}

double upper_tail(double F, double numerator, double denominator) {
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(numerator, denominator), F));
}

PairedComparison compare(const Eigen::MatrixXd& values, Eigen::Index a, Eigen::Index b) {
  PairedComparison out{a, b};
  const Eigen::VectorXd d = values.col(b) - values.col(a);
  const auto n = static_cast<double>(d.size());
  out.mean_difference = d.mean();
  const double variance = (d.array() - d.mean()).square().sum() / (n - 1);
  if (!(variance > 0)) {
    out.p = out.mean_difference == 0 ? 1.0 : 0.0;
    return out;
  }
  out.t = out.mean_difference / std::sqrt(variance / n);
  out.p = 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(n - 1), std::abs(out.t)));
  return out;
}

}  // namespace

RepeatedMeasures repeated_measures(const Eigen::MatrixXd& values) {
  if (values.rows() < 2 || values.cols() < 2) {
    throw std::invalid_argument("repeated measures need two subjects and two conditions or more");
  }
  if (!values.allFinite()) throw std::invalid_argument("repeated measures need a value for each subject and condition");
  RepeatedMeasures out;
  out.subjects = values.rows();
  out.conditions = values.cols();
  const auto n = static_cast<double>(values.rows()), k = static_cast<double>(values.cols());
  const double grand = values.mean();
  const double between_conditions = n * (values.colwise().mean().array() - grand).square().sum();
  const double between_subjects = k * (values.rowwise().mean().array() - grand).square().sum();
  const double total = (values.array() - grand).square().sum();
  const double error = total - between_conditions - between_subjects;
  out.numerator_freedom = k - 1;
  out.denominator_freedom = (k - 1) * (n - 1);
  if (total > 0 && error > 1e-14 * total) {
    out.F = between_conditions / out.numerator_freedom / (error / out.denominator_freedom);
    out.epsilon = sphericity_epsilon(values);
    out.p = upper_tail(out.F, out.numerator_freedom, out.denominator_freedom);
    out.p_greenhouse_geisser =
        upper_tail(out.F, out.epsilon * out.numerator_freedom, out.epsilon * out.denominator_freedom);
  }
  for (Eigen::Index a = 0; a < values.cols(); ++a) {
    for (Eigen::Index b = a + 1; b < values.cols(); ++b) out.pairs.push_back(compare(values, a, b));
  }
  // Holm and Sidak, step-down: the i-th smallest p of m is judged among the m - i that are left.
  std::vector<std::size_t> order(out.pairs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return out.pairs[a].p < out.pairs[b].p; });
  double running = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    auto& pair = out.pairs[order[i]];
    const auto left = static_cast<double>(order.size() - i);
    running = std::max(running, -std::expm1(left * std::log1p(-std::min(pair.p, 1 - 1e-16))));
    pair.p_holm_sidak = std::min(1.0, running);
  }
  return out;
}

}  // namespace handloop::identify
