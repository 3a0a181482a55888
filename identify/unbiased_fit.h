#pragma once

#include <array>
#include <optional>
#include <span>

#include "identify/arm_fit.h"

/// The unbiased method: what `--method unbiased` does beside the paper's.
///
/// The whole record is transformed once behind a gentle taper, so nothing leaks; its lines are gathered in bands of 0.5
/// Hz. In each band a quadratic in frequency takes out the response, whatever it is, and leaves the noise: its variance
/// needs no model. A first fit then flattens the response (lines are divided by the fitted model), the bands are
/// averaged without curvature, and the final fit weighs each band by its variance. The force's hold between samples is
/// part of the model.
namespace handloop::identify {

struct UnbiasedSettings {
  double lowest_Hz = 0.35;  ///< the lowest band's centre is 0.6 Hz
  double highest_Hz = 30.0;
  double band_Hz = 0.5;      ///< wider where a short record has fewer than twelve lines in it
  double taper = 0.1;        ///< share of the record under the cosine at each end
  std::optional<Hold> hold;  ///< none: the recording decides, see UnbiasedFit::hold_misfit
  /// A delay that the hold does not explain is fitted where it is significant and above a tenth of a sample. Off:
  /// never.
  bool allow_delay = true;
  ArmBounds bounds;
};

struct UnbiasedFit {
  ArmFit fit;                           ///< `cost` is the weighted misfit (chi squared)
  FrequencyResponse response;           ///< bands, hold and delay as recorded
  FrequencyResponse continuous;         ///< the same with the hold and delay taken out: what eq. (1) describes
  double misfit = 0.0;                  ///< chi squared per degree of freedom: 1 where the model leaves noise alone
  std::array<double, 3> hold_misfit{};  ///< chi squared of the best fit under each Hold, without a delay
  bool hold_is_clear = false;  ///< the next best hold fits worse by more than chance (chi squared by 9 or more)
};

/// Throws InputError where the record is too short (fewer than eight bands of twelve lines), constant, or not finite.
UnbiasedFit fit_arm_unbiased(std::span<const double> force_N, std::span<const double> position_m, double sample_time_s,
                             const UnbiasedSettings& settings = {});

}  // namespace handloop::identify
