#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "control/a_norm.h"
#include "control/transfer_loop.h"
#include "control/transfer_matrix.h"
#include "models/seven_bar.h"

/// Force control of Kazerooni and Her: both contact forces are fed back into the position command,
///     p_des = K (alpha f_h + f_e),   p = G p_des + S_h f_h + S_e f_e,   f_h = u_h - H p,   f_e = f_ext - E p. (1)-(3)
/// x and y are the axes of models/seven_bar.h; frequencies in rad/s; S in m/N, H and E in N/m.
namespace handloop::control {

/// What the primary stabilising controller leaves of a force: S_h and S_e of (1). Zero unless set.
struct Sensitivity {
  virtual ~Sensitivity() = default;
  virtual Eigen::Matrix2cd to_hand(double) const { return Eigen::Matrix2cd::Zero(); }
  virtual Eigen::Matrix2cd to_environment(double) const { return Eigen::Matrix2cd::Zero(); }
  /// What the controller is told of a contact force over what acts: the sensor's own lag.
  virtual std::complex<double> sensing(double) const { return 1.0; }
  /// p/p_des over G: what delays and the inner loop make of (17).
  virtual Eigen::Matrix2cd tracking(double) const { return Eigen::Matrix2cd::Identity(); }
};

struct ForceControl {
  models::PrimaryLoop primary;  ///< G, the same in x and y
  TransferFunction K;           ///< m/N, the same in x and y
  TransferMatrix alpha;
  models::HandImpedance hand;                                    ///< H_0, the same in x and y
  Eigen::Matrix2d environment_kg = Eigen::Matrix2d::Identity();  ///< E_0 = this s^2
  /// The part of it that the computed torque carries as its own: S_e acts on the rest.
  Eigen::Matrix2d modelled_kg = Eigen::Matrix2d::Zero();
};

/// G as a ratio of polynomials.
TransferFunction primary_transfer(const models::PrimaryLoop& primary);

// --- performance ---

struct PerformancePoint {
  double frequency_rad_per_s = 0.0;
  double error = 0.0;  ///< sigma_max[(G K alpha + S_h)^-1 (G K + S_e) - R] of (8)
  double have = 0.0;   ///< sigma_max(G K) of (9), m/N
  double want = 0.0;   ///< sigma_max(S_e - S_h R) sigma_max(R)/epsilon of (9), m/N
};
struct Performance {
  std::vector<PerformancePoint> points;
  double worst_error = 0.0, worst_at_rad_per_s = 0.0;
  bool met_8 = false;  ///< error < epsilon everywhere
  bool met_9 = false;  ///< have > want everywhere
};
/// (8) and (9) for R = alpha^-1 over [0, band], `points` frequencies from band/1000 on. As printed, (9) takes the
/// largest singular value of G K; where G K differs between axes only the smallest makes (9) imply (8). They are the
/// same here.
Performance performance(const ForceControl& c, const Sensitivity& s, double band_rad_per_s, double epsilon,
                        std::size_t points = 200);

// --- stability ---

/// G_c of (11) = [I + G K (alpha H_0 + E_0)]^-1 G K, S_h = S_e = 0, as rational functions.
TransferMatrix closed_compliance(const ForceControl& c);

struct SmallGain {
  std::array<std::array<ANorm, 2>, 2> entries;
  double gain_m_per_N = 0.0;       ///< lambda_Gc: the largest sum of A-norms along a row (gain between peaks)
  double error_bound = 0.0;        ///< of it, m/N
  double permitted_N_per_m = 0.0;  ///< the nonlinear gain lambda_Delta that (15) still allows: 1/lambda_Gc
};
SmallGain small_gain(const ForceControl& c);

/// Gain of a nonlinear Delta, N/m, that a cubic spring k_3 p^3 of the hand adds through alpha while |p| <= reach.
double cubic_gain_N_per_m(const ForceControl& c, double cubic_N_per_m3, double reach_m);

/// The loop G K (alpha H_0 + E_0) along one axis (0: x, 1: y) where alpha and E_0 are diagonal.
TransferLoop axis_loop(const ForceControl& c, std::size_t axis);

/// Largest factor of alpha, both axes at once, that keeps the loop stable with the S_h, S_e and G given: the least
/// real positive lambda for which I + G K E_0 + S_e (E_0 - its modelled part) + (lambda G K alpha + S_h) H_0 is
/// singular at some frequency, on a grid refined by bisection. Nothing where no factor up to `most` does. Presumes that
/// small factors are stable.
struct Limit {
  double factor = 0.0, frequency_rad_per_s = 0.0;
};
std::optional<Limit> amplification_limit(const ForceControl& c, const Sensitivity& s, double most = 100.0);
/// The same along one axis alone, as the value of alpha there; the other axis stays out of it.
std::optional<Limit> axis_limit(const ForceControl& c, const Sensitivity& s, std::size_t axis, double most = 1000.0);

}  // namespace handloop::control
