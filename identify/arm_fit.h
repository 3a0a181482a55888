#pragma once

#include <array>
#include <complex>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "identify/sampled_arm.h"
#include "identify/spectra.h"
#include "models/arm.h"

/// Fits of the five-parameter arm, eq. (1), to measured frequency responses by eq. (2) of the arm paper.
namespace handloop::identify {

/// Range the search stays in, wide enough for every arm of the literature (Table V).
struct ArmBounds {
  models::ArmParameters lower{1e-6, 1.0, 1e-2, 1e-6, 1e-6};
  models::ArmParameters upper{100.0, 1e5, 1e5, 1e3, 1e3};
};

/// Result of a fit. Arrays are in the order of models::kArmParameterNames.
struct ArmFit {
  models::ArmParameters arm;
  double cost = 0.0;  ///< eq. (2) at the optimum, (m/N)^2
  std::array<double, 5> standard_error{};
  std::array<double, 5> low95{}, high95{};  ///< linearised 95 % interval, cut at the bounds of the search
  std::array<bool, 5> at_bound{};
  std::array<std::array<double, 5>, 5> correlation{};
  Hold hold = Hold::continuous;
  double delay_s = 0.0;  ///< of the position behind the force, where one was fitted
  double delay_error_s = 0.0;
  std::vector<std::string> warnings;  ///< one line each: what this recording does not determine
};

/// Which weight eq. (2) gives a frequency: the coherence (Sets 1 and 3 of the paper), the same to all (Set 2), or the
/// inverse of the response's variance (the most precise where the variance is known).
enum class FitWeight { coherence, none, inverse_variance };

struct ArmFitSettings {
  FitWeight weight = FitWeight::coherence;
  ArmBounds bounds;
  Hold hold = Hold::continuous;  ///< `continuous` is what the paper assumes
  double sample_time_s = 0.001;  ///< of the hold
  bool fit_delay = false;        ///< a delay of the position behind the force is found along, within +-4 samples
  /// Correlation of the errors of the response at points 0, 1, 2 apart. Default: bins of half-overlapped Hamming
  /// segments, whose error E(conj(U) noise)/E|U|^2 correlates like the square of the squared window's spectrum (1,
  /// -0.6250, 0.1331).
  std::array<double, 3> error_correlation{1.0, 0.3906, 0.0177};
};

/// Minimises sum over n of W(n) |H_measured(n) - H_arm(n)|^2 within bounds, from several starts that are found from the
/// response itself; the best local optimum is returned (a tie goes to
/// the stiffer grasp). Intervals follow from the variance of the response where it is
/// given (correlation of neighbouring half-overlapped bins counted), widened where the misfit is larger than that
/// variance explains; else from the misfit alone. Throws InputError where fewer than five usable frequencies are given.
ArmFit fit_arm(const FrequencyResponse& measured, const ArmFitSettings& settings = {});

/// The same from one given start, for a refit near a known optimum.
ArmFit refit_arm(const FrequencyResponse& measured, const ArmFitSettings& settings, const models::ArmParameters& start,
                 double start_delay_s = 0.0);

/// The best of the fits from several given starts. Starts that meet after a few steps go on as one, and only the answer
/// gets intervals and warnings: far cheaper than as many refits.
ArmFit refit_arm(const FrequencyResponse& measured, const ArmFitSettings& settings,
                 std::span<const models::ArmParameters> starts);

/// The fits that fit_arm() would choose its answer from, unfinished and best first: for another cost to choose among.
std::vector<models::ArmParameters> arm_candidates(const FrequencyResponse& measured, const ArmFitSettings& settings,
                                                  std::size_t count);

/// Starting values from a response: for a grid of grasps (k1, b1) what is left of the response is an arm, whose inverse
/// is linear in M, b2, k2; the best `count` of them, best first.
std::vector<models::ArmParameters> arm_starts(const FrequencyResponse& measured, const std::vector<double>& weight,
                                              const ArmBounds& bounds, std::size_t count);

/// One line for each parameter that a fit does not determine: at a bound of the search, an interval wider than the
/// value, two parameters that only act together.
std::vector<std::string> identifiability_warnings(const ArmFit& fit);

}  // namespace handloop::identify
