#include "identify/unbiased_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identify/band_response.h"

namespace handloop::identify {

using Complex = std::complex<double>;

namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr std::array<Hold, 3> kHolds{Hold::continuous, Hold::zero_order, Hold::first_order};

/// A fitted delay is believed where freeing it lowers chi squared by this much (five standard errors) in units of the
/// misfit, and it is more than this share of a sample.
constexpr double kDelaySignificance = 25.0;
constexpr double kDelayShare = 0.1;
constexpr double kHoldSignificance = 9.0;
constexpr std::size_t kCandidates = 3;
constexpr double kNormal95 = 1.959963984540054;

double freedom(const FrequencyResponse& response) {
  return std::max(1.0, 2.0 * static_cast<double>(response.size()) - 5.0);
}

/// The variance is that of a complex number; each of its two parts has half.
double chi_squared(const ArmFit& fit) {
  return 2 * fit.cost;
}

/// A force that passed through a device's inertia is neither band-limited nor made of straight lines, but between the
/// two. The distance between both answers is what is not known of it, and is added to the intervals as a standard
/// error.
void admit_hold_uncertainty(ArmFit& fit, const models::ArmParameters& smooth, const models::ArmParameters& straight,
                            const ArmBounds& bounds) {
  const auto a = models::to_array(smooth), b = models::to_array(straight), value = models::to_array(fit.arm);
  const auto lower = models::to_array(bounds.lower), upper = models::to_array(bounds.upper);
  for (std::size_t i = 0; i < 5; ++i) {
    fit.standard_error[i] = std::hypot(fit.standard_error[i], a[i] - b[i]);
    fit.low95[i] = std::max(lower[i], value[i] - kNormal95 * fit.standard_error[i]);
    fit.high95[i] = std::min(upper[i], value[i] + kNormal95 * fit.standard_error[i]);
  }
}

}  // namespace

UnbiasedFit fit_arm_unbiased(std::span<const double> force_N, std::span<const double> position_m, double sample_time_s,
                             const UnbiasedSettings& settings) {
  const TaperedRecord record(force_N, position_m, sample_time_s, settings.lowest_Hz, settings.highest_Hz,
                             settings.band_Hz, settings.taper);
  ArmFitSettings fit_settings;
  fit_settings.weight = FitWeight::inverse_variance;
  fit_settings.bounds = settings.bounds;
  fit_settings.sample_time_s = sample_time_s;
  fit_settings.error_correlation = {1, 0, 0};

  // First fit: eq. (1) with a free delay stands near every hold; it only has to flatten the response.
  // The weights of the variance differ by orders of magnitude and make narrow valleys; coherence leads into the right
  // one, or to a few to choose among.
  const FrequencyResponse bands = record.quadratic();
  ArmFitSettings first_settings = fit_settings;
  first_settings.weight = FitWeight::coherence;
  fit_settings.fit_delay = true;
  const std::vector<models::ArmParameters> starts = arm_candidates(bands, first_settings, kCandidates);
  const ArmFit rough = refit_arm(bands, fit_settings, starts);
  UnbiasedFit out;
  out.response = record.flattened(
      [&](double w) { return std::polar(1.0, -w * rough.delay_s) * models::compliance(rough.arm, Complex(0, w)); });

  std::array<ArmFit, 3> fits;
  std::size_t best = 0;
  fit_settings.fit_delay = false;
  for (std::size_t h = 0; h < kHolds.size(); ++h) {
    if (settings.hold && *settings.hold != kHolds[h]) {
      out.hold_misfit[h] = std::numeric_limits<double>::infinity();
      continue;
    }
    fit_settings.hold = kHolds[h];
    // With a free delay grasp and arm can change places unnoticed; without one they cannot. So every candidate starts
    // here.
    fits[h] = refit_arm(out.response, fit_settings, starts);
    out.hold_misfit[h] = chi_squared(fits[h]);
    if (out.hold_misfit[h] < out.hold_misfit[best] || settings.hold) best = h;
  }
  // Where hardly any mass tells grasp from arm, two holds can explain the data alike with the two exchanged. The grasp
  // of a stylus is the stiffer in every arm of Tables I to III: that settles a tie, and nothing but a tie.
  const auto grasp_is_stiffer = [&](std::size_t h) { return fits[h].arm.k1_N_per_m > fits[h].arm.k2_N_per_m; };
  for (std::size_t h = 0; h < kHolds.size() && !grasp_is_stiffer(best); ++h) {
    const double unit = std::max(1.0, out.hold_misfit[best] / freedom(out.response));
    if (grasp_is_stiffer(h) && out.hold_misfit[h] - out.hold_misfit[best] < kHoldSignificance * unit) best = h;
  }
  out.fit = fits[best];
  out.hold_is_clear = true;
  for (std::size_t h = 0; h < kHolds.size(); ++h) {
    const double unit = std::max(1.0, out.hold_misfit[best] / freedom(out.response));
    if (h != best && out.hold_misfit[h] - out.hold_misfit[best] < kHoldSignificance * unit) out.hold_is_clear = false;
  }
  if (!settings.hold && best != static_cast<std::size_t>(Hold::zero_order)) {
    admit_hold_uncertainty(out.fit, fits[static_cast<std::size_t>(Hold::continuous)].arm,
                           fits[static_cast<std::size_t>(Hold::first_order)].arm, settings.bounds);
  }
  const bool leaves_noise = chi_squared(out.fit) < freedom(out.response) + 3 * std::sqrt(2 * freedom(out.response));
  if (settings.allow_delay && !leaves_noise) {
    // A hold is half a sample late itself, so a true delay may make the wrong hold look best: each is tried with one.
    fit_settings.fit_delay = true;
    std::vector<ArmFit> delayed;
    for (const Hold hold : kHolds) {
      if (settings.hold && *settings.hold != hold) continue;
      fit_settings.hold = hold;
      delayed.push_back(refit_arm(out.response, fit_settings, out.fit.arm));
      delayed.push_back(refit_arm(out.response, fit_settings, rough.arm, rough.delay_s));
    }
    double least = std::numeric_limits<double>::infinity();
    for (const auto& candidate : delayed) least = std::min(least, chi_squared(candidate));
    const double unit = std::max(1.0, least / freedom(out.response));
    // Of those that explain the data alike, the one with the least delay.
    const ArmFit* chosen = nullptr;
    for (const auto& candidate : delayed) {
      if (chi_squared(candidate) > least + kHoldSignificance * unit) continue;
      if (chosen == nullptr || std::abs(candidate.delay_s) < std::abs(chosen->delay_s)) chosen = &candidate;
    }
    if (chi_squared(out.fit) - chi_squared(*chosen) > kDelaySignificance * unit &&
        std::abs(chosen->delay_s) > kDelayShare * sample_time_s) {
      out.fit = *chosen;
      out.fit.warnings.push_back(
          fmt::format("the position lags the force by {:.3g} ms (+- {:.2g}), which was fitted along",
                      1e3 * chosen->delay_s, 1e3 * kNormal95 * chosen->delay_error_s));
    }
  }
  out.misfit = chi_squared(out.fit) / freedom(out.response);

  out.continuous = out.response;
  const SampledArm sampled(out.fit.arm, out.fit.hold, sample_time_s);
  for (std::size_t b = 0; b < out.response.size(); ++b) {
    const double w = kTwoPi * out.response.frequency_Hz[b];
    const Complex held = std::polar(1.0, -w * out.fit.delay_s) * sampled(w);
    const Complex ratio = models::compliance(out.fit.arm, Complex(0, w)) / held;
    out.continuous.response[b] *= ratio;
    out.continuous.variance[b] *= std::norm(ratio);
  }
  return out;
}

}  // namespace handloop::identify
