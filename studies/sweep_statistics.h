#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

namespace handloop::studies {

/// One arm at one point. Margins are NaN where unstable, and where the time domain judged (it knows no margins).
struct Evaluation {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double stable = 0.0;  ///< 1 or 0
  double rho = kNone;   ///< largest closed-loop pole modulus; time domain: growth of the motion per sample
  double gm_up = kNone;
  double gm_down = kNone;
  double pm_deg = kNone;  ///< signed
  double dm_s = kNone;
  double sm = kNone;
  double disk_alpha = kNone;
};

/// Margins of which the population's low end is reported: smallest, 5 % point and median over the arms, unstable arms
/// counted below every stable one. The phase margin without its sign.
inline constexpr std::array<std::string_view, 5> kSweepMargins{"gm_up", "pm_deg", "dm_s", "sm", "disk_alpha"};
inline constexpr std::array<std::string_view, 3> kSweepQuantiles{"min", "p05", "p50"};

struct MarginQuantiles {
  double min = Evaluation::kNone;  ///< NaN: that arm is unstable
  double p05 = Evaluation::kNone;
  double p50 = Evaluation::kNone;
  double at(std::size_t quantile) const { return quantile == 0 ? min : quantile == 1 ? p05 : p50; }
};

/// All arms at one point.
struct PointStatistics {
  std::uint64_t arms = 0;
  std::uint64_t stable = 0;
  double rho_p95 = Evaluation::kNone;  ///< 95 % of the arms have a smaller one
  std::array<MarginQuantiles, kSweepMargins.size()> margins{};

  double p_stable() const { return arms ? static_cast<double>(stable) / static_cast<double>(arms) : 0.0; }
};

/// Quantile p of n values is the smallest that at least a share p does not exceed. `scratch` must hold as many doubles.
PointStatistics summarise(std::span<const Evaluation> arms, std::span<double> scratch);

}  // namespace handloop::studies
