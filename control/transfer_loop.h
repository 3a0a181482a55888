#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "control/margins.h"

namespace handloop::control {

/// Any loop transfer function given by its coefficients, highest power first; negative feedback.
/// Continuous in s where there is no sample time (then `delay_s` of dead time may follow), discrete in z where there
/// is.
struct TransferLoop {
  std::vector<double> numerator;
  std::vector<double> denominator;
  std::optional<double> sample_time_s;
  double delay_s = 0.0;  ///< continuous loops only

  std::complex<double> operator()(double frequency_rad_per_s) const;
};

/// Throws InputError: no coefficients, not finite, zero denominator, sample time not above zero, or a discrete loop
/// with more zeros than poles (its output would need samples of the future).
void require_valid(const TransferLoop& loop);

/// Roots of a polynomial, highest power first, polished in long double. Leading zeros are dropped.
std::vector<std::complex<double>> polynomial_roots(const std::vector<double>& coefficients);

struct TransferMargins {
  Margins margins;                          ///< rho: largest modulus of a closed-loop pole, also where continuous
  std::vector<std::complex<double>> poles;  ///< of the closed loop, dead time left out
  double abscissa = Margins::kNone;         ///< continuous: largest real part of a pole without dead time, rad/s
};

/// Poles and margins. Closed-loop poles are the roots of numerator + denominator, so that a hidden unstable mode that
/// numerator and denominator share counts; a loop whose 1 + L vanishes at infinite frequency is not well posed and
/// counts as unstable. Dead time: the loop without it is judged by its poles, and every crossing of the axis as the
/// delay grows is counted (Cooke and van den Driessche 1986), which is exact. A loop with |L| >= 1 at infinite
/// frequency has no delay margin (0). Throws InputError as require_valid.
TransferMargins evaluate(const TransferLoop& loop);

}  // namespace handloop::control
