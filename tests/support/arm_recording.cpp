#include "tests/support/arm_recording.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

namespace handloop::test {

namespace {

/// x' = A x + B f, f constant or ramping over a sample: x_next = Phi x + G0 f_now + G1 (f_next - f_now).
struct Stepper {
  Eigen::MatrixXd Phi;
  Eigen::VectorXd G0, G1;

  Stepper(const Eigen::MatrixXd& A, const Eigen::VectorXd& B, double T) {
    const auto n = A.rows();
    Eigen::MatrixXd big = Eigen::MatrixXd::Zero(n + 2, n + 2);  // the force and its slope are states too
    big.topLeftCorner(n, n) = A * T;
    big.block(0, n, n, 1) = B * T;
    big(n, n + 1) = 1;
    const Eigen::MatrixXd e = big.exp();
    Phi = e.topLeftCorner(n, n);
    G0 = e.block(0, n, n, 1);
    G1 = e.block(0, n + 1, n, 1);
  }
};

double quantised(double value, double step) {
  return step > 0 ? step * std::round(value / step) : value;
}

}  // namespace

std::vector<double> coloured_noise(std::size_t count, double sample_time_s, double cutoff_Hz, std::uint64_t seed) {
  constexpr int kOrder = 13;
  constexpr std::size_t kSettle = 2000;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(count + kSettle);
  for (auto& v : x) v = normal(random);
  const double w = 2 / sample_time_s * std::tan(std::numbers::pi * cutoff_Hz * sample_time_s);
  const double c = 2 / sample_time_s;
  // Pairs of poles at w exp(j (pi/2 + pi (2k+1)/26)) and the real one, each turned digital on its own.
  for (int k = 0; k < kOrder / 2; ++k) {
    const double damping = 2 * std::sin(std::numbers::pi * (2 * k + 1) / (2.0 * kOrder));
    const double a0 = c * c + damping * w * c + w * w;
    const double a1 = (2 * w * w - 2 * c * c) / a0, a2 = (c * c - damping * w * c + w * w) / a0, b = w * w / a0;
    double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
    for (auto& v : x) {
      const double y = b * (v + 2 * x1 + x2) - a1 * y1 - a2 * y2;
      x2 = x1;
      x1 = v;
      y2 = y1;
      y1 = y;
      v = y;
    }
  }
  double x1 = 0, y1 = 0;
  for (auto& v : x) {
    const double y = (w * (v + x1) - (w - c) * y1) / (w + c);
    x1 = v;
    y1 = y;
    v = y;
  }
  x.erase(x.begin(), x.begin() + kSettle);
  double power = 0;
  for (const double v : x) power += v * v;
  const double scale = 1 / std::sqrt(power / static_cast<double>(count));
  for (auto& v : x) v *= scale;
  return x;
}

ArmRecording record_arm(const RecordingPlan& plan) {
  const auto [M, k1, k2, b1, b2] = plan.arm;
  const auto count = static_cast<std::size_t>(std::lround(plan.duration_s / plan.sample_time_s));
  auto command = coloured_noise(count, plan.sample_time_s, 30.0, plan.seed);
  for (auto& f : command) f = std::clamp(f * plan.force_rms_N, -5.0, 5.0);

  ArmRecording out;
  out.force_N.resize(count);
  out.position_m.resize(count);
  out.true_position_m.resize(count);
  if (plan.drive == Drive::device) {
    // States: grip x, v, arm x2, v2. m v' = F_command - b v - F_grip, F_grip = k1 (x - x2) + b1 (v - v2).
    const double m = plan.device_mass_kg, b = plan.device_damping_Ns_per_m;
    Eigen::MatrixXd A(4, 4);
    A << 0, 1, 0, 0, -k1 / m, -(b1 + b) / m, k1 / m, b1 / m, 0, 0, 0, 1, k1 / M, b1 / M, -(k1 + k2) / M, -(b1 + b2) / M;
    const Stepper step(A, Eigen::Vector4d(0, 1 / m, 0, 0), plan.sample_time_s);
    Eigen::VectorXd x = Eigen::Vector4d::Zero();
    for (std::size_t n = 0; n < count; ++n) {
      out.force_N[n] = k1 * (x(0) - x(2)) + b1 * (x(1) - x(3));
      out.true_position_m[n] = x(0);
      x = step.Phi * x + step.G0 * command[n];
    }
  } else {
    // States: stretch of the grasp d = x - x2 (d' = (F - k1 d)/b1), x2, v2 with M v2' = F - k2 x2 - b2 v2.
    Eigen::MatrixXd A(3, 3);
    A << -k1 / b1, 0, 0, 0, 0, 1, 0, -k2 / M, -b2 / M;
    const Stepper step(A, Eigen::Vector3d(1 / b1, 0, 1 / M), plan.sample_time_s);
    Eigen::VectorXd x = Eigen::Vector3d::Zero();
    for (std::size_t n = 0; n < count; ++n) {
      out.force_N[n] = command[n];
      out.true_position_m[n] = x(0) + x(1);
      const double slope = plan.drive == Drive::ramped_force && n + 1 < count ? command[n + 1] - command[n] : 0.0;
      x = step.Phi * x + step.G0 * command[n] + step.G1 * slope;
    }
  }

  std::mt19937_64 random(plan.seed ^ 0x9e3779b97f4a7c15ull);
  std::normal_distribution<double> normal;
  double slow = 0, slower = 0;  // two poles at 0.25 Hz turn white noise into wander
  const double a = std::exp(-2 * std::numbers::pi * 0.25 * plan.sample_time_s);
  std::vector<double> wander(count);
  double power = 0;
  for (auto& v : wander) {
    slow = a * slow + normal(random);
    slower = a * slower + (1 - a) * slow;
    v = slower;
    power += v * v;
  }
  const double scale = plan.wander_rms_m / std::sqrt(power / static_cast<double>(count));
  for (std::size_t n = 0; n < count; ++n) {
    out.force_N[n] = quantised(out.force_N[n] + plan.force_noise_N * normal(random), plan.force_step_N);
    const double position = out.true_position_m[n] + scale * wander[n] + plan.position_noise_m * normal(random);
    out.position_m[n] = quantised(position, plan.position_step_m);
  }
  return out;
}

std::vector<std::array<double, 5>> random_arms(int axis, std::size_t count, std::uint64_t seed) {
  struct Range {
    double low, mean, high, deviation;
  };
  // Table III of the arm paper: minimum, mean, maximum, standard deviation of M, k1, k2, b1, b2.
  static const Range kTable[3][5] = {{{0.0340, 0.3240, 0.8016, 0.1464},
                                      {140.6, 459.4, 757.9, 144.5},
                                      {53.05, 104.8, 196.2, 27.59},
                                      {0.0020, 2.579, 7.095, 1.337},
                                      {3.148, 5.920, 10.34, 2.192}},
                                     {{0.2275, 0.4763, 0.9115, 0.1528},
                                      {292.3, 620.2, 926.5, 185.8},
                                      {88.66, 132.5, 199.7, 29.05},
                                      {3.830, 6.094, 9.898, 1.403},
                                      {4.020, 5.890, 9.721, 1.398}},
                                     {{0.0003, 0.2357, 0.4810, 0.1261},
                                      {590.3, 886.9, 1050, 105.4},
                                      {194.6, 365.8, 588.7, 105.8},
                                      {0.0002, 0.5241, 1.939, 0.4884},
                                      {10.66, 20.14, 28.88, 5.129}}};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<std::array<double, 5>> arms(count);
  for (auto& arm : arms) {
    for (std::size_t i = 0; i < 5; ++i) {
      const Range& r = kTable[axis][i];
      do arm[i] = r.mean + r.deviation * normal(random);
      while (arm[i] < r.low || arm[i] > r.high);
    }
  }
  return arms;
}

}  // namespace handloop::test
