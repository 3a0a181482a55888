#include "models/effects/tabulated.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "models/effects/entry.h"

namespace handloop::models {
namespace {

using Grid = TabulatedGrid;

/// Interval of the knots that holds the share, and where in it.
template <std::size_t N>
std::pair<std::size_t, double> locate(const std::array<double, N>& knots, double share) {
  const double clamped = std::clamp(share, knots.front(), knots.back());
  std::size_t lower = 0;
  while (lower + 2 < N && clamped >= knots[lower + 1]) ++lower;
  return {lower, (clamped - knots[lower]) / (knots[lower + 1] - knots[lower])};
}

const std::vector<std::string>& force_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (std::size_t i = 0; i < Grid::kDisplacements; ++i) {
      for (std::size_t j = 0; j < Grid::kVelocities; ++j) {
        list.push_back("force_" + std::to_string(i) + "_" + std::to_string(j) + "_N");
      }
    }
    return list;
  }();
  return names;
}

const EffectInfo& tabulated_info() {
  static const EffectInfo entry = [] {
    EffectInfo e{
        .name = "tabulated",
        .title = "Tabulated rest (unexplained)",
        .equation =
            "F = table(x, v), bilinear between 11 displacements and 11 velocities; force_<i>_<j>_N at displacement i, "
            "velocity j",
        .source = "what no catalogued effect explains; measured, not understood",
        .fingerprint = "dependence on displacement and velocity that no name fits",
        .experiment = "repeat at half the force and at a second posture",
        .places = {Place::arm, Place::joint, Place::grasp},
        .parameters =
            {{"centre_m", "m", -10.0, 10.0, 0.0, "displacement in the middle of the table", {Role::choice}},
             {"displacement_range_m",
              "m",
              1e-9,
              100.0,
              0.01,
              "from the middle to the first and last row",
              {Role::choice}},
             {"velocity_range_m_per_s", "m/s", 1e-9, 1e3, 0.1, "of the first and last column", {Role::choice}}},
    };
    for (const auto& name : force_names())
      e.parameters.push_back({name, "N", -1e6, 1e6, 0.0, "force at one knot", {Role::choice}});
    return e;
  }();
  return entry;
}

class Tabulated final : public Effect {
 public:
  Tabulated(Place place, std::span<const double> values) : Effect(tabulated_info(), place, values) {}
  double force_N(const PortMotion& motion, const PortBase&, std::span<const double>) const override {
    return law(motion.x_m, motion.v_m_per_s);
  }
  LinearElement linearise(const OperatingPoint& point, const PortBase&) const override {
    // E[F x]/sigma_x^2 and E[F v]/sigma_v^2 for independent Gaussian x and v
    constexpr int kHalf = 40;
    double along_x = 0, along_v = 0, weights = 0;
    for (int i = -kHalf; i <= kHalf; ++i) {
      for (int j = -kHalf; j <= kHalf; ++j) {
        const double x = 4.0 * i / kHalf, v = 4.0 * j / kHalf, weight = std::exp(-0.5 * (x * x + v * v));
        const double force = law(point.x_mean_m + x * point.x_rms_m, v * point.v_rms_m_per_s);
        along_x += weight * force * x;
        along_v += weight * force * v;
        weights += weight;
      }
    }
    return {.stiffness_N_per_m = along_x / weights / point.x_rms_m,
            .damping_Ns_per_m = along_v / weights / point.v_rms_m_per_s};
  }

 private:
  double law(double x, double v) const {
    double force = 0;
    for (const auto& corner : Grid::corners((x - value(0)) / value(1), v / value(2))) {
      force += corner.weight * value(Grid::kFirstForce + corner.index);
    }
    return force;
  }
};

}  // namespace

std::array<TabulatedGrid::Corner, 4> TabulatedGrid::corners(double displacement_share, double velocity_share) {
  const auto [i, a] = locate(kDisplacementKnots, displacement_share);
  const auto [j, b] = locate(kVelocityKnots, velocity_share);
  const std::size_t at = i * kVelocities + j;
  return {
      {{at, (1 - a) * (1 - b)}, {at + 1, (1 - a) * b}, {at + kVelocities, a * (1 - b)}, {at + kVelocities + 1, a * b}}};
}

EffectType tabulated_effect() {
  return effect_entry<Tabulated>(tabulated_info());
}

}  // namespace handloop::models
