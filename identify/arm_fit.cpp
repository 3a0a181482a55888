#include "identify/arm_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identify/bounded_least_squares.h"
#include "models/errors.h"

namespace handloop::identify {

using Complex = std::complex<double>;
using models::ArmParameters;

namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kNormal95 = 1.959963984540054;

constexpr std::size_t kStarts = 6;

/// A delay is searched within this many samples either way.
constexpr double kDelaySamples = 4.0;

std::vector<double> frequency_weights(const FrequencyResponse& measured, FitWeight weight) {
  std::vector<double> w(measured.size(), 1.0);
  for (std::size_t n = 0; n < w.size(); ++n) {
    if (weight == FitWeight::coherence && n < measured.coherence.size()) w[n] = measured.coherence[n];
    if (weight == FitWeight::inverse_variance) w[n] = measured.variance[n] > 0 ? 1 / measured.variance[n] : 0.0;
    if (!std::isfinite(measured.response[n].real()) || !std::isfinite(measured.response[n].imag())) w[n] = 0;
  }
  return w;
}

double cost_of(const FrequencyResponse& measured, const std::vector<double>& weight, const ArmParameters& arm) {
  double cost = 0;
  for (std::size_t n = 0; n < measured.size(); ++n) {
    cost += weight[n] *
            std::norm(measured.response[n] - models::compliance(arm, Complex(0, kTwoPi * measured.frequency_Hz[n])));
  }
  return cost;
}

Eigen::Matrix<double, 5, 1> vector_of(const ArmParameters& arm) {
  const auto a = models::to_array(arm);
  return Eigen::Map<const Eigen::Matrix<double, 5, 1>>(a.data());
}

ArmParameters arm_of(const Eigen::VectorXd& v) {
  return models::arm_from_array({v(0), v(1), v(2), v(3), v(4)});
}

/// The weighted problem of eq. (2): five parameters, and the delay in samples as the sixth where it is fitted.
struct FitProblem {
  const FrequencyResponse& measured;
  const std::vector<double>& weight;
  const ArmFitSettings& settings;

  Eigen::Index parameters() const { return settings.fit_delay ? 6 : 5; }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(2 * measured.size()); }

  /// Residuals scale sqrt(W) (H_measured - H_arm), real and imaginary parts in turn, and their derivatives.
  void evaluate(const Eigen::VectorXd& p, double scale, Eigen::Ref<Eigen::VectorXd> residuals,
                Eigen::Ref<Jacobian>* jacobian) const {
    const SampledArm model(arm_of(p), settings.hold, settings.sample_time_s);
    std::array<Complex, 5> derivative;
    for (std::size_t n = 0; n < measured.size(); ++n) {
      const double w = kTwoPi * measured.frequency_Hz[n], root = scale * std::sqrt(weight[n]);
      const auto row = static_cast<Eigen::Index>(2 * n);
      const Complex late = settings.fit_delay ? std::polar(1.0, -w * settings.sample_time_s * p(5)) : Complex(1.0);
      const Complex H = late * (jacobian ? model.gradient(w, derivative) : model(w));
      const Complex difference = root * (measured.response[n] - H);
      residuals(row) = difference.real();
      residuals(row + 1) = difference.imag();
      if (jacobian == nullptr) continue;
      for (Eigen::Index i = 0; i < parameters(); ++i) {
        const Complex by =
            i < 5 ? late * derivative[static_cast<std::size_t>(i)] : Complex(0, -w * settings.sample_time_s) * H;
        (*jacobian)(row, i) = -root * by.real();
        (*jacobian)(row + 1, i) = -root * by.imag();
      }
    }
  }

  Eigen::VectorXd bound(const ArmParameters& arm, double delay_samples) const {
    Eigen::VectorXd v(parameters());
    v.head(5) = vector_of(arm);
    if (settings.fit_delay) v(5) = delay_samples;
    return v;
  }
  Eigen::VectorXd lower() const { return bound(settings.bounds.lower, -kDelaySamples); }
  Eigen::VectorXd upper() const { return bound(settings.bounds.upper, kDelaySamples); }
};

struct Optimum {
  ArmParameters arm;
  double cost = std::numeric_limits<double>::infinity();
  double delay_samples = 0.0;
};

/// `scale` makes the residuals of order one.
Optimum optimise(const FitProblem& problem, const ArmParameters& start, double start_delay_samples, double scale,
                 const LeastSquaresSettings& search = {}) {
  // Parameters are searched in units of their start, so that a step means the same in each.
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(problem.parameters());
  unit.head(5) = vector_of(start).cwiseMax(1e-3 * vector_of({0.2, 400, 100, 2, 5}));
  const ResidualFunction function = [&](const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> r,
                                        Eigen::Ref<Jacobian>* J) {
    problem.evaluate(x.cwiseProduct(unit), scale, r, J);
    if (J) *J = *J * unit.asDiagonal();
    return r.allFinite();
  };
  const auto result = minimise(function, problem.rows(), problem.bound(start, start_delay_samples).cwiseQuotient(unit),
                               problem.lower().cwiseQuotient(unit), problem.upper().cwiseQuotient(unit), search);
  const Eigen::VectorXd p = result.x.cwiseProduct(unit);
  return {arm_of(p), result.sum_of_squares / (scale * scale), problem.settings.fit_delay ? p(5) : 0.0};
}

/// Covariance of the parameters: (J'J)^-1 J' S J (J'J)^-1 with S the covariance of the weighted residuals, neighbouring
/// bins correlated; parameters at a bound are held there.
void attach_intervals(ArmFit& fit, const FitProblem& problem) {
  const auto& [measured, weight, settings] = problem;
  const auto bins = measured.size();
  const Eigen::Index rows = problem.rows();
  const Eigen::VectorXd p = problem.bound(fit.arm, fit.delay_s / settings.sample_time_s);
  Eigen::VectorXd residuals(rows);
  Jacobian J(rows, problem.parameters());
  Eigen::Ref<Jacobian> J_ref(J);
  problem.evaluate(p, 1.0, residuals, &J_ref);

  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const bool at_bound = i < 5 && (p(i) <= lower(i) * 1.001 || p(i) >= upper(i) * 0.999);
    if (i < 5) fit.at_bound[static_cast<std::size_t>(i)] = at_bound;
    if (!at_bound) free.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(free.size());
  if (count == 0) return;
  Eigen::MatrixXd A(rows, count);
  for (Eigen::Index i = 0; i < count; ++i) A.col(i) = J.col(free[static_cast<std::size_t>(i)]);
  const Eigen::VectorXd column = A.colwise().norm().transpose().cwiseMax(1e-300);
  A = A * column.cwiseInverse().asDiagonal();

  // Variance of each weighted bin (real and imaginary part alike), and how far the misfit exceeds it.
  std::vector<double> variance(bins, 0.0);
  double expected = 0;
  for (std::size_t n = 0; n < bins; ++n) {
    if (n < measured.variance.size() && std::isfinite(measured.variance[n]))
      variance[n] = weight[n] * measured.variance[n] / 2;
    expected += 2 * variance[n];
  }
  const double freedom = static_cast<double>(rows - count) / static_cast<double>(rows);
  const double misfit = residuals.squaredNorm() / freedom;
  if (expected <= 0) {
    for (auto& v : variance) v = misfit / static_cast<double>(rows);
  } else if (misfit > expected) {
    for (auto& v : variance) v *= misfit / expected;
  }

  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t n = 0; n < bins; ++n) {
    for (std::size_t m = 0; m < settings.error_correlation.size() && n + m < bins; ++m) {
      const double c = settings.error_correlation[m] * std::sqrt(variance[n] * variance[n + m]);
      for (int part = 0; part < 2; ++part) {
        const auto a = A.row(static_cast<Eigen::Index>(2 * n) + part),
                   b = A.row(static_cast<Eigen::Index>(2 * (n + m)) + part);
        const Eigen::MatrixXd outer = c * a.transpose() * b;
        middle += m == 0 ? outer : Eigen::MatrixXd(outer + outer.transpose());
      }
    }
  }
  const Eigen::MatrixXd inverse = (A.transpose() * A).completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd covariance = inverse * middle * inverse;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto a = static_cast<std::size_t>(free[static_cast<std::size_t>(i)]);
    const double error = std::sqrt(std::max(0.0, covariance(i, i))) / column(i);
    if (a == 5) {
      fit.delay_error_s = error * settings.sample_time_s;
      continue;
    }
    fit.standard_error[a] = error;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto b = static_cast<std::size_t>(free[static_cast<std::size_t>(k)]);
      const double scale = std::sqrt(covariance(i, i) * covariance(k, k));
      if (b < 5) fit.correlation[a][b] = scale > 0 ? covariance(i, k) / scale : 0.0;
    }
  }
  for (std::size_t i = 0; i < 5; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    fit.low95[i] = std::max(lower(row), p(row) - kNormal95 * fit.standard_error[i]);
    fit.high95[i] = std::min(upper(row), p(row) + kNormal95 * fit.standard_error[i]);
  }
}

}  // namespace

std::vector<ArmParameters> arm_starts(const FrequencyResponse& measured, const std::vector<double>& weight,
                                      const ArmBounds& bounds, std::size_t count) {
  // Where the mass no longer moves the grasp alone is left: |1/H| of the upper half is about |k1 + j w b1| there.
  double logarithm = 0, middle = 0;
  std::size_t used = 0;
  for (std::size_t n = measured.size() / 2; n < measured.size(); ++n) {
    if (!(weight[n] > 0) || !(std::abs(measured.response[n]) > 0)) continue;
    logarithm += std::log(std::abs(measured.response[n]));
    middle += kTwoPi * measured.frequency_Hz[n];
    ++used;
  }
  if (used == 0) return {};
  const double impedance = std::exp(-logarithm / static_cast<double>(used));
  middle /= static_cast<double>(used);

  struct Start {
    ArmParameters arm;
    double cost;
    bool possible;  // the linear fit came out positive
  };
  std::vector<Start> found;
  for (const double share : {0.6, 0.8, 1.0, 1.3, 2.0, 4.0}) {
    for (const double angle_deg : {1.0, 10.0, 25.0, 40.0, 55.0, 68.0, 80.0, 87.0}) {
      const double angle = angle_deg * std::numbers::pi / 180;
      ArmParameters arm;
      arm.k1_N_per_m = impedance * share * std::cos(angle);
      arm.b1_Ns_per_m = impedance * share * std::sin(angle) / middle;
      // 1/(H - grasp) = k2 - M w^2 + j w b2, weighted by |H - grasp|^2 so that errors of H count alike.
      double s0 = 0, s2 = 0, s4 = 0, re = 0, re2 = 0, im = 0, im2 = 0;
      for (std::size_t n = 0; n < measured.size(); ++n) {
        const double w = kTwoPi * measured.frequency_Hz[n];
        const Complex rest = measured.response[n] - 1.0 / Complex(arm.k1_N_per_m, w * arm.b1_Ns_per_m);
        const double size = std::norm(rest);
        if (weight[n] <= 0 || size <= 0) continue;
        const Complex inverse = 1.0 / rest;
        const double c = weight[n] * size * size;
        s0 += c;
        s2 += c * w * w;
        s4 += c * w * w * w * w;
        re += c * inverse.real();
        re2 += c * inverse.real() * w * w;
        im += c * inverse.imag() * w;
        im2 += c * w * w;
      }
      const double determinant = s0 * s4 - s2 * s2;
      if (!(determinant > 0) || !(im2 > 0)) continue;
      arm.k2_N_per_m = (re * s4 - re2 * s2) / determinant;
      arm.mass_kg = (re * s2 - re2 * s0) / determinant;
      arm.b2_Ns_per_m = im / im2;
      auto v = models::to_array(arm);
      const auto low = models::to_array(bounds.lower), high = models::to_array(bounds.upper);
      constexpr std::array<double, 5> kLeast{0.005, 1.0, 1.0, 0.01, 0.1};  // what is not positive starts small instead
      bool possible = true;
      for (std::size_t i = 0; i < 5; ++i) {
        possible = possible && v[i] > kLeast[i];
        v[i] = std::clamp(std::max(v[i], kLeast[i]), low[i], high[i]);
      }
      arm = models::arm_from_array(v);
      found.push_back({arm, cost_of(measured, weight, arm), possible});
    }
  }
  // The cost has two basins, one with hardly any mass. Starts with an honest mass come first, or the massless basin,
  // which is the wider, may be all that is tried.
  std::sort(found.begin(), found.end(),
            [](const Start& a, const Start& b) { return a.possible != b.possible ? a.possible : a.cost < b.cost; });
  std::vector<ArmParameters> starts;
  std::array<std::size_t, 2> taken{};
  for (const auto& f : found) {
    // A start beside a better one ends where that ends: keep those that differ.
    const bool near = std::any_of(starts.begin(), starts.end(), [&](const ArmParameters& other) {
      return std::abs(std::log(other.k1_N_per_m / f.arm.k1_N_per_m)) < 0.15 &&
             std::abs(std::log(other.b1_Ns_per_m / f.arm.b1_Ns_per_m)) < 1.0;
    });
    auto& of_kind = taken[f.possible ? 0 : 1];
    if (near || (f.possible && of_kind >= (count + 1) / 2)) continue;
    starts.push_back(f.arm);
    ++of_kind;
    if (starts.size() == count) break;
  }
  return starts;
}

std::vector<std::string> identifiability_warnings(const ArmFit& fit) {
  std::vector<std::string> warnings;
  const auto value = models::to_array(fit.arm);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto name = models::kArmParameterNames[i];
    if (fit.at_bound[i]) {
      warnings.push_back(
          fmt::format("{} ended at a bound of the search ({:.3g}): not determined by this recording", name, value[i]));
    } else if (kNormal95 * fit.standard_error[i] > 0.5 * value[i]) {
      warnings.push_back(fmt::format("{} = {:.3g} is poorly determined: 95 % interval {:.3g} to {:.3g}", name, value[i],
                                     fit.low95[i], fit.high95[i]));
    }
  }
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t k = i + 1; k < 5; ++k) {
      if (std::abs(fit.correlation[i][k]) > 0.99) {
        warnings.push_back(fmt::format("{} and {} only act together (correlation {:.3f})",
                                       models::kArmParameterNames[i], models::kArmParameterNames[k],
                                       fit.correlation[i][k]));
      }
    }
  }
  return warnings;
}

namespace {

ArmFit finish(const FitProblem& problem, const Optimum& best) {
  ArmFit fit;
  fit.arm = best.arm;
  fit.cost = best.cost;
  fit.hold = problem.settings.hold;
  fit.delay_s = best.delay_samples * problem.settings.sample_time_s;
  attach_intervals(fit, problem);
  fit.warnings = identifiability_warnings(fit);
  return fit;
}

/// What makes the residuals of order one: the inverse of the weighted size of the response.
double residual_scale(const FrequencyResponse& measured, const std::vector<double>& weight) {
  double power = 0;
  for (std::size_t n = 0; n < measured.size(); ++n) {
    if (weight[n] > 0) power += weight[n] * std::norm(measured.response[n]);
  }
  return power > 0 ? 1 / std::sqrt(power) : 1.0;
}

}  // namespace

namespace {

/// Where hardly any mass tells grasp from arm, both ways round can explain a response alike. The grasp of a stylus is
/// the stiffer in every arm of Tables I to III: that settles a tie, costs this near each other, and nothing but a tie.
constexpr double kTie = 1.05;
bool stiffer_grasp(const ArmParameters& arm) {
  return arm.k1_N_per_m > arm.k2_N_per_m;
}

/// As many steps as tell which starts lead to the same place.
constexpr LeastSquaresSettings kFewSteps{7, 1e-4, 1e-6};

/// Enough steps to come near the end from a start that is near already; what then still costs this many times as much
/// as the best is in a worse basin.
constexpr LeastSquaresSettings kMoreSteps{16, 1e-6, 1e-7};
constexpr double kHopeless = 2.0;
/// Relative distance of every parameter below which two runners have met.
constexpr double kMet = 1e-2;

bool better(const Optimum& a, const Optimum& b) {
  return a.cost < b.cost;
}

/// A few steps from each start, the two basins exchanged included; those that got furthest, best first, alike ones
/// once.
std::vector<Optimum> race(const FitProblem& problem, double scale) {
  const auto usable = std::count_if(problem.weight.begin(), problem.weight.end(), [](double w) { return w > 0; });
  if (usable < 5) {
    throw InputError(
        fmt::format("only {} of {} frequencies carry a response; a fit of five parameters asks for five or more",
                    usable, problem.measured.size()));
  }
  const auto starts = arm_starts(problem.measured, problem.weight, problem.settings.bounds, kStarts);
  if (starts.empty()) throw InputError("the response is not that of an arm: no start could be found from it");
  std::vector<Optimum> runners;
  for (const auto& start : starts) runners.push_back(optimise(problem, start, 0.0, scale, kFewSteps));
  // With little mass grasp and arm are two dampers with springs, and may have found each other's place.
  const ArmParameters leader = std::min_element(runners.begin(), runners.end(), better)->arm;
  const ArmParameters exchanged{leader.mass_kg, leader.k2_N_per_m, leader.k1_N_per_m, leader.b2_Ns_per_m,
                                leader.b1_Ns_per_m};
  runners.push_back(optimise(problem, exchanged, 0.0, scale, kFewSteps));
  std::sort(runners.begin(), runners.end(), better);
  std::vector<Optimum> out;
  for (const auto& r : runners) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const Optimum& o) {
      return std::abs(o.arm.k1_N_per_m / r.arm.k1_N_per_m - 1) < 0.02 &&
             std::abs(o.arm.b2_Ns_per_m / r.arm.b2_Ns_per_m - 1) < 0.02;
    });
    if (!known) out.push_back(r);
  }
  return out;
}

}  // namespace

ArmFit fit_arm(const FrequencyResponse& measured, const ArmFitSettings& settings) {
  const auto weight = frequency_weights(measured, settings.weight);
  const FitProblem problem{measured, weight, settings};
  const double scale = residual_scale(measured, weight);
  constexpr std::size_t kFinalists = 3;
  const auto leaders = race(problem, scale);
  std::vector<Optimum> finals;
  for (std::size_t i = 0; i < std::min(kFinalists, leaders.size()); ++i) {
    finals.push_back(optimise(problem, leaders[i].arm, leaders[i].delay_samples, scale));
  }
  Optimum best = *std::min_element(finals.begin(), finals.end(), better);
  const double tie = kTie * best.cost;
  for (const auto& other : finals) {
    if (stiffer_grasp(other.arm) && !stiffer_grasp(best.arm) && other.cost < tie) best = other;
  }
  return finish(problem, best);
}

std::vector<ArmParameters> arm_candidates(const FrequencyResponse& measured, const ArmFitSettings& settings,
                                          std::size_t count) {
  const auto weight = frequency_weights(measured, settings.weight);
  std::vector<ArmParameters> out;
  for (const auto& leader : race(FitProblem{measured, weight, settings}, residual_scale(measured, weight))) {
    if (out.size() < count) out.push_back(leader.arm);
  }
  return out;
}

ArmFit refit_arm(const FrequencyResponse& measured, const ArmFitSettings& settings, const ArmParameters& start,
                 double start_delay_s) {
  const auto weight = frequency_weights(measured, settings.weight);
  const FitProblem problem{measured, weight, settings};
  return finish(problem,
                optimise(problem, start, start_delay_s / settings.sample_time_s, residual_scale(measured, weight)));
}

ArmFit refit_arm(const FrequencyResponse& measured, const ArmFitSettings& settings,
                 std::span<const ArmParameters> starts) {
  const auto weight = frequency_weights(measured, settings.weight);
  const FitProblem problem{measured, weight, settings};
  const double scale = residual_scale(measured, weight);
  std::vector<Optimum> runners;
  for (const auto& start : starts) runners.push_back(optimise(problem, start, 0.0, scale, kMoreSteps));
  std::sort(runners.begin(), runners.end(), better);
  std::vector<Optimum> finals;
  for (const auto& r : runners) {
    const auto v = vector_of(r.arm);
    const bool known = std::any_of(finals.begin(), finals.end(), [&](const Optimum& other) {
      return (v - vector_of(other.arm)).cwiseQuotient(v).cwiseAbs().maxCoeff() < kMet;
    });
    if (!known && r.cost <= kHopeless * runners.front().cost)
      finals.push_back(optimise(problem, r.arm, r.delay_samples, scale));
  }
  return finish(problem, *std::min_element(finals.begin(), finals.end(), better));
}

}  // namespace handloop::identify
