#include "identify/local_polynomial.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/fourier.h"
#include "models/errors.h"

namespace handloop::identify {

using Complex = std::complex<double>;

namespace {

struct RecordTransform {
  std::vector<Complex> U, Y;
  double line_Hz = 0;
};

RecordTransform transform_record(std::span<const double> u, std::span<const double> y, double sample_time_s,
                                 double highest_Hz, std::size_t spare_lines) {
  if (u.size() != y.size()) {
    throw InputError(fmt::format("input has {} samples and output {}; both need the same number", u.size(), y.size()));
  }
  for (std::size_t n = 0; n < u.size(); ++n) {
    if (!std::isfinite(u[n]) || !std::isfinite(y[n])) {
      throw InputError(fmt::format("no finite value at sample {}; spectra need every sample", n + 1));
    }
  }
  const std::size_t length = smooth_length(u.size());
  RecordTransform out;
  if (length == 0) throw InputError("the recording holds no samples");
  out.line_Hz = 1.0 / (static_cast<double>(length) * sample_time_s);
  const auto wanted = static_cast<std::size_t>(std::ceil(highest_Hz / out.line_Hz)) + spare_lines;
  const std::size_t bins = std::min(wanted + 1, length / 2 + 1);
  out.U.resize(bins);
  out.Y.resize(bins);
  PairTransform{length, bins}(u.first(length), y.first(length), out.U, out.Y);
  return out;
}

struct LocalFit {
  Complex response{0};
  double coherence = 0;
  double variance = std::numeric_limits<double>::infinity();
};

/// Fit around line `centre` over the lines first .. first + count - 1.
LocalFit fit_around(const RecordTransform& record, std::size_t centre, std::size_t first, std::size_t count,
                    int degree) {
  const int terms = degree + 1;
  const auto rows = static_cast<Eigen::Index>(count);
  Eigen::MatrixXcd K(rows, 2 * terms);
  Eigen::VectorXcd Y(rows);
  const double width = static_cast<double>(count);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::size_t line = first + static_cast<std::size_t>(i);
    const double r = (static_cast<double>(line) - static_cast<double>(centre)) / width;
    double power = 1;
    for (int t = 0; t < terms; ++t, power *= r) {
      K(i, t) = power * record.U[line];
      K(i, terms + t) = power;
    }
    Y(i) = record.Y[line];
  }
  // Columns in force and in leakage differ by orders of magnitude; scaled alike, the normal matrix is well conditioned.
  const Eigen::VectorXd norms = K.colwise().norm().transpose();
  if (norms.minCoeff() <= 0) return {};
  K = K * norms.cwiseInverse().asDiagonal();
  const Eigen::HouseholderQR<Eigen::MatrixXcd> qr(K);
  const Eigen::VectorXcd theta = qr.solve(Y);
  const double residual = (Y - K * theta).squaredNorm();
  const double noise = residual / static_cast<double>(rows - 2 * terms);
  const Eigen::MatrixXcd R = qr.matrixQR().topRows(2 * terms).triangularView<Eigen::Upper>();
  const Eigen::MatrixXcd inverse_R =
      R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXcd::Identity(2 * terms, 2 * terms));
  LocalFit fit;
  fit.response = theta(0) / norms(0);
  fit.variance = noise * inverse_R.row(0).squaredNorm() / (norms(0) * norms(0));
  const double power = Y.squaredNorm();
  fit.coherence = power > 0 ? std::clamp(1 - noise * static_cast<double>(rows) / power, 0.0, 1.0) : 0.0;
  return fit;
}

FrequencyResponse at_lines(const RecordTransform& record, const LocalPolynomialSettings& settings,
                           const std::vector<std::size_t>& lines) {
  const std::size_t count = 2 * settings.half_width + 1;
  const auto unknowns = static_cast<std::size_t>(2 * (settings.degree + 1));
  if (count <= unknowns || record.U.size() < count + 1) {
    throw InputError(fmt::format("the record has {} spectral lines; the local polynomial method asks for {} of them",
                                 record.U.size(), count + 1));
  }
  FrequencyResponse out;
  for (const std::size_t line : lines) {
    // At the ends of the band the window of lines stays inside and the fit becomes one-sided. Line 0 is the mean: left
    // out.
    const std::size_t first = std::clamp<std::size_t>(line > settings.half_width ? line - settings.half_width : 1, 1,
                                                      record.U.size() - count);
    const LocalFit fit = fit_around(record, line, first, count, settings.degree);
    out.frequency_Hz.push_back(static_cast<double>(line) * record.line_Hz);
    out.response.push_back(fit.response);
    out.coherence.push_back(fit.coherence);
    out.variance.push_back(fit.variance);
  }
  return out;
}

std::size_t nearest_line(const RecordTransform& record, double frequency_Hz) {
  const auto line = static_cast<std::size_t>(std::max(1.0, std::round(frequency_Hz / record.line_Hz)));
  return std::min(line, record.U.size() - 1);
}

}  // namespace

FrequencyResponse local_polynomial_response(std::span<const double> u, std::span<const double> y, double sample_time_s,
                                            const LocalPolynomialSettings& settings) {
  const auto record = transform_record(u, y, sample_time_s, settings.highest_Hz, settings.half_width);
  const auto first = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(settings.lowest_Hz / record.line_Hz)));
  const auto last = static_cast<std::size_t>(std::floor(settings.highest_Hz / record.line_Hz));
  std::vector<std::size_t> lines;
  if (settings.points == 0) {
    for (std::size_t line = first; line <= std::min(last, record.U.size() - 1); ++line) lines.push_back(line);
  } else {
    const double span = settings.highest_Hz - settings.lowest_Hz;
    for (std::size_t p = 0; p < settings.points; ++p) {
      const double share =
          settings.points > 1 ? static_cast<double>(p) / static_cast<double>(settings.points - 1) : 0.0;
      const std::size_t line = nearest_line(record, settings.lowest_Hz + share * span);
      if (lines.empty() || line > lines.back()) lines.push_back(line);
    }
  }
  return at_lines(record, settings, lines);
}

FrequencyResponse local_polynomial_response(std::span<const double> u, std::span<const double> y, double sample_time_s,
                                            const LocalPolynomialSettings& settings,
                                            std::span<const double> frequencies_Hz) {
  double highest = settings.highest_Hz;
  for (const double f : frequencies_Hz) highest = std::max(highest, f);
  const auto record = transform_record(u, y, sample_time_s, highest, settings.half_width);
  std::vector<std::size_t> lines;
  for (const double f : frequencies_Hz) lines.push_back(nearest_line(record, f));
  return at_lines(record, settings, lines);
}

}  // namespace handloop::identify
