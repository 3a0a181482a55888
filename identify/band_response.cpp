#include "identify/band_response.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "identify/fourier.h"
#include "models/errors.h"

namespace handloop::identify {

using Complex = std::complex<double>;

namespace {

constexpr std::size_t kLeastLines = 12;  // in a band: three unknowns and enough left to know the noise
constexpr std::size_t kLeastBands = 8;

/// Noise is never taken for less than this share of the output's power: rounding alone leaves as much.
constexpr double kNoiseFloor = 1e-14;

void require_signal(std::span<const double> signal, const char* name) {
  double low = signal.empty() ? 0 : signal[0], high = low;
  for (std::size_t n = 0; n < signal.size(); ++n) {
    if (!std::isfinite(signal[n])) throw InputError(fmt::format("{} has no finite value at sample {}", name, n + 1));
    low = std::min(low, signal[n]);
    high = std::max(high, signal[n]);
  }
  if (!(high > low))
    throw InputError(fmt::format("{} is constant ({:.6g}); nothing can be identified from it", name, low));
}

}  // namespace

TaperedRecord::TaperedRecord(std::span<const double> u, std::span<const double> y, double sample_time_s,
                             double lowest_Hz, double highest_Hz, double band_Hz, double taper) {
  if (u.size() != y.size()) {
    throw InputError(
        fmt::format("force has {} samples and position {}; both need the same number", u.size(), y.size()));
  }
  require_signal(u, "the force");
  require_signal(y, "the position");
  const std::size_t length = smooth_length(u.size());
  const double count = static_cast<double>(length);
  line_Hz_ = 1 / (count * sample_time_s);
  highest_Hz = std::min(highest_Hz, 0.45 / sample_time_s);
  band_Hz = std::max(band_Hz, static_cast<double>(kLeastLines) * line_Hz_);
  const auto bands = static_cast<std::size_t>(std::max(0.0, std::floor((highest_Hz - lowest_Hz) / band_Hz + 1e-9)));
  if (bands < kLeastBands) {
    throw InputError(
        fmt::format("a recording of {:.3g} s is too short: it resolves {} bands of {:.3g} Hz below {:.3g} Hz, "
                    "{} are needed (about {:.2g} s)",
                    static_cast<double>(u.size()) * sample_time_s, bands, band_Hz, highest_Hz, kLeastBands,
                    static_cast<double>(kLeastLines * kLeastBands) / (highest_Hz - lowest_Hz)));
  }

  std::vector<double> tu(length), ty(length);
  const double mean_u = std::accumulate(u.begin(), u.end(), 0.0) / static_cast<double>(u.size());
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / static_cast<double>(y.size());
  const auto edge = static_cast<std::size_t>(taper * count);
  double second = 0, fourth = 0;
  for (std::size_t n = 0; n < length; ++n) {
    const std::size_t from_end = std::min(n, length - 1 - n);
    double w = 1;
    if (from_end < edge) {
      w = 0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(from_end) + 0.5) / static_cast<double>(edge));
    }
    tu[n] = w * (u[n] - mean_u);
    ty[n] = w * (y[n] - mean_y);
    second += w * w;
    fourth += w * w * w * w;
  }
  correlation_ = count * fourth / (second * second);

  const auto lines =
      static_cast<std::size_t>(std::ceil((lowest_Hz + static_cast<double>(bands) * band_Hz) / line_Hz_)) + 1;
  U_.resize(std::min(lines, length / 2 + 1));
  Y_.resize(U_.size());
  PairTransform{length, U_.size()}(tu, ty, U_, Y_);

  for (std::size_t b = 0; b < bands; ++b) {
    const double from = lowest_Hz + static_cast<double>(b) * band_Hz;
    Band band{};
    band.first = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(from / line_Hz_ - 1e-9)));
    band.last = std::min(static_cast<std::size_t>(std::ceil((from + band_Hz) / line_Hz_ - 1e-9)), U_.size()) - 1;
    band.centre_Hz = from + 0.5 * band_Hz;
    fit_quadratic(band);
    bands_.push_back(band);
  }
}

void TaperedRecord::fit_quadratic(Band& band) const {
  Eigen::Matrix3cd normal = Eigen::Matrix3cd::Zero();
  Eigen::Vector3cd right = Eigen::Vector3cd::Zero();
  const double half = 0.5 * static_cast<double>(band.last - band.first + 1) * line_Hz_;
  auto row = [&](std::size_t k) {
    const double r = (static_cast<double>(k) * line_Hz_ - band.centre_Hz) / half;
    return Eigen::Vector3cd(U_[k], r * U_[k], r * r * U_[k]);
  };
  double power = 0;
  for (std::size_t k = band.first; k <= band.last; ++k) {
    const Eigen::Vector3cd a = row(k);
    normal += a.conjugate() * a.transpose();
    right += a.conjugate() * Y_[k];
    power += std::norm(Y_[k]);
  }
  const Eigen::Matrix3cd inverse = normal.inverse();
  const Eigen::Vector3cd theta = inverse * right;
  double residual = 0;
  for (std::size_t k = band.first; k <= band.last; ++k)
    residual += std::norm(Y_[k] - (row(k).transpose() * theta).value());
  const double count = static_cast<double>(band.last - band.first + 1);
  band.noise = std::max(residual / (count - 3), kNoiseFloor * power / count);
  band.response = theta(0);
  band.variance = correlation_ * band.noise * inverse(0, 0).real();
}

FrequencyResponse TaperedRecord::quadratic() const {
  FrequencyResponse out;
  for (const auto& band : bands_) {
    double power = 0;
    for (std::size_t k = band.first; k <= band.last; ++k) power += std::norm(Y_[k]);
    out.frequency_Hz.push_back(band.centre_Hz);
    out.response.push_back(band.response);
    out.variance.push_back(band.variance);
    const double count = static_cast<double>(band.last - band.first + 1);
    out.coherence.push_back(power > 0 ? std::clamp(1 - band.noise * count / power, 0.0, 1.0) : 0.0);
  }
  return out;
}

FrequencyResponse TaperedRecord::flattened(const std::function<Complex(double)>& model) const {
  FrequencyResponse out = quadratic();
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    const Band& band = bands_[b];
    Complex cross = 0;
    double power = 0, input = 0;
    for (std::size_t k = band.first; k <= band.last; ++k) {
      const Complex predicted = model(2 * std::numbers::pi * static_cast<double>(k) * line_Hz_) * U_[k];
      cross += std::conj(predicted) * Y_[k];
      power += std::norm(predicted);
      input += std::norm(U_[k]);
    }
    if (!(power > 0) || !(input > 0)) continue;
    const Complex centre = model(2 * std::numbers::pi * band.centre_Hz);
    out.response[b] = centre * cross / power;
    out.variance[b] = std::norm(centre) * correlation_ * band.noise / power;
  }
  return out;
}

}  // namespace handloop::identify
