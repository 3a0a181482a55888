#include "identify/envelope.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "identify/bounded_least_squares.h"

namespace handloop::identify {

using models::UncertaintyModel;

namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
const double kDecibel = 10 / std::log(10.0);  // of a squared magnitude

/// A new pair is tried at several places for a few rounds; the best few go on to the end.
constexpr int kFirstRounds = 3, kAllRounds = 12;
constexpr std::size_t kFinalists = 2;

/// Unknowns: log gain (of a model whose pairs are s^2/w^2 + 2 d s/w + 1, so that it is |V(0)|), then for each pole pair
/// and each zero pair the logarithm of its frequency and its damping ratio.
struct Shape {
  Eigen::VectorXd x;

  Eigen::Index pairs() const { return (x.size() - 1) / 4; }
  Eigen::Index pole(Eigen::Index i) const { return 1 + 4 * i; }
  Eigen::Index zero(Eigen::Index i) const { return 3 + 4 * i; }
};

/// 10 log10 |1 - r^2 + 2 j d r|^2, r = w/wn, and its derivatives by log wn and d.
double pair_dB(double w, double log_wn, double d, double& by_log_wn, double& by_d) {
  const double r = w * std::exp(-log_wn), r2 = r * r, a = 1 - r2, size = a * a + 4 * d * d * r2;
  by_log_wn = kDecibel * (4 * a * r2 - 8 * d * d * r2) / size;
  by_d = kDecibel * 8 * d * r2 / size;
  return kDecibel * std::log(size);
}

double magnitude_dB(const Shape& shape, double w, double* gradient) {
  double total = 2 * kDecibel * shape.x(0);
  if (gradient) gradient[0] = 2 * kDecibel;
  for (Eigen::Index i = 0; i < shape.pairs(); ++i) {
    double by_log = 0, by_d = 0;
    for (const auto& [at, sign] : {std::pair{shape.pole(i), -1.0}, std::pair{shape.zero(i), 1.0}}) {
      total += sign * pair_dB(w, shape.x(at), shape.x(at + 1), by_log, by_d);
      if (gradient == nullptr) continue;
      gradient[at] = sign * by_log;
      gradient[at + 1] = sign * by_d;
    }
  }
  return total;
}

UncertaintyModel model_of(const Shape& shape) {
  UncertaintyModel model;
  double log_gain = shape.x(0);
  auto root = [](double log_wn, double d) {
    return std::exp(log_wn) * std::complex<double>(-d, std::sqrt(std::max(0.0, 1 - d * d)));
  };
  for (Eigen::Index i = 0; i < shape.pairs(); ++i) {
    model.poles.push_back(root(shape.x(shape.pole(i)), shape.x(shape.pole(i) + 1)));
    model.zeros.push_back(root(shape.x(shape.zero(i)), shape.x(shape.zero(i) + 1)));
    log_gain += 2 * (shape.x(shape.pole(i)) - shape.x(shape.zero(i)));  // monic factors
  }
  model.gain = std::exp(log_gain);
  return model;
}

/// Ratio of neighbouring frequencies that a pair of the least damping, as wide as a tenth of its frequency, cannot hide
/// between.
constexpr double kClosest = 1.08;

/// What the envelope must clear: the data and the straight lines between them.
struct Target {
  std::vector<double> w, dB;
};

Target dense_target(std::span<const double> frequency_Hz, std::span<const double> dB, int least_between) {
  Target t;
  for (std::size_t n = 0; n < frequency_Hz.size(); ++n) {
    t.w.push_back(kTwoPi * frequency_Hz[n]);
    t.dB.push_back(dB[n]);
    if (n + 1 == frequency_Hz.size()) break;
    const double octave = frequency_Hz[n] > 0 ? std::log(frequency_Hz[n + 1] / frequency_Hz[n]) : 0.0;
    const int between = std::max(least_between, 2 * static_cast<int>(std::ceil(octave / (2 * std::log(kClosest)))));
    for (int k = 1; k < between; ++k) {
      const double share = static_cast<double>(k) / between;
      t.w.push_back(kTwoPi * (frequency_Hz[n] + share * (frequency_Hz[n + 1] - frequency_Hz[n])));
      t.dB.push_back(dB[n] + share * (dB[n + 1] - dB[n]));
    }
  }
  return t;
}

Eigen::VectorXd excess_of(const Shape& shape, const Target& target) {
  Eigen::VectorXd e(static_cast<Eigen::Index>(target.w.size()));
  for (Eigen::Index n = 0; n < e.size(); ++n) {
    const auto i = static_cast<std::size_t>(n);
    e(n) = magnitude_dB(shape, target.w[i], nullptr) - target.dB[i];
  }
  return e;
}

/// Raises the gain until nothing is below; returns the mean excess.
double lift(Shape& shape, const Target& target) {
  const Eigen::VectorXd e = excess_of(shape, target);
  const double up = -e.minCoeff() + 1e-9;
  shape.x(0) += up / (2 * kDecibel);
  return e.mean() + up;
}

Shape improve(Shape shape, const Target& target, const EnvelopeSettings& settings, int rounds) {
  const auto points = static_cast<Eigen::Index>(target.w.size());
  Eigen::VectorXd lower(shape.x.size()), upper(shape.x.size());
  lower(0) = -20;
  upper(0) = 20;
  for (Eigen::Index i = 1; i < shape.x.size(); i += 2) {
    lower(i) = std::log(target.w.front() / 10);
    upper(i) = std::log(target.w.back() * 10);
    lower(i + 1) = settings.least_damping;
    upper(i + 1) = 1.0;
  }
  Eigen::VectorXd multiplier = Eigen::VectorXd::Zero(points), weight = Eigen::VectorXd::Ones(points);
  Shape best = shape;
  double least = lift(best, target);
  double penalty = 10;
  LeastSquaresSettings search;
  search.max_iterations = 15;
  search.function_tolerance = 1e-5;
  for (int round = 0; round < rounds; ++round) {
    const ResidualFunction function = [&](const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> r,
                                          Eigen::Ref<Jacobian>* J) {
      const Shape at{x};
      Eigen::VectorXd gradient(x.size());
      const double root_penalty = std::sqrt(penalty);
      for (Eigen::Index n = 0; n < points; ++n) {
        const auto i = static_cast<std::size_t>(n);
        const double e = magnitude_dB(at, target.w[i], J ? gradient.data() : nullptr) - target.dB[i];
        const double root_weight = std::sqrt(weight(n)), violated = multiplier(n) / penalty - e;
        r(n) = root_weight * e;
        r(points + n) = violated > 0 ? root_penalty * violated : 0.0;
        if (J == nullptr) continue;
        J->row(n) = root_weight * gradient.transpose();
        if (violated > 0)
          J->row(points + n) = -root_penalty * gradient.transpose();
        else
          J->row(points + n).setZero();
      }
      return r.allFinite();
    };
    shape.x = minimise(function, 2 * points, shape.x, lower, upper, search).x;
    Shape lifted = shape;
    const double mean = lift(lifted, target);
    if (mean < least) {
      least = mean;
      best = lifted;
    }
    const Eigen::VectorXd e = excess_of(shape, target);
    for (Eigen::Index n = 0; n < points; ++n) {
      multiplier(n) = std::max(0.0, multiplier(n) - penalty * e(n));
      weight(n) = 1 / std::max(0.1, std::abs(e(n)));  // sum of e^2/|e|: towards the mean of the excess
    }
    penalty = std::min(penalty * 1.6, 2000.0);
  }
  return best;
}

/// One pair of poles and zeros more, both at the same place: the same |V|, free to part.
Shape with_pair(const Shape& shape, double w, double damping) {
  Shape more;
  more.x.resize(shape.x.size() + 4);
  more.x.head(shape.x.size()) = shape.x;
  more.x.tail(4) << std::log(w), damping, std::log(w), damping;
  // A pole and a zero that coincide have no preference which way to part: nudge them.
  more.x(more.x.size() - 3) *= 0.9;
  return more;
}

}  // namespace

Envelope compare_envelope(const UncertaintyModel& model, std::span<const double> frequency_Hz,
                          std::span<const double> dB) {
  Envelope out;
  out.model = model;
  out.least_excess_dB = std::numeric_limits<double>::infinity();
  out.largest_excess_dB = -out.least_excess_dB;
  for (std::size_t n = 0; n < frequency_Hz.size(); ++n) {
    const double e = 20 * std::log10(std::abs(model({0, kTwoPi * frequency_Hz[n]}))) - dB[n];
    out.mean_excess_dB += e / static_cast<double>(frequency_Hz.size());
    out.least_excess_dB = std::min(out.least_excess_dB, e);
    out.largest_excess_dB = std::max(out.largest_excess_dB, e);
  }
  return out;
}

Envelope lifted_envelope(const UncertaintyModel& model, std::span<const double> frequency_Hz,
                         std::span<const double> dB) {
  UncertaintyModel lifted = model;
  lifted.gain *= std::pow(10.0, -compare_envelope(model, frequency_Hz, dB).least_excess_dB / 20) * (1 + 1e-10);
  return compare_envelope(lifted, frequency_Hz, dB);
}

Envelope fit_envelope(std::span<const double> frequency_Hz, std::span<const double> dB,
                      const EnvelopeSettings& settings) {
  if (frequency_Hz.size() < 2 || frequency_Hz.size() != dB.size()) {
    throw std::invalid_argument("an envelope needs two frequencies or more, with a magnitude each");
  }
  const Target target = dense_target(frequency_Hz, dB, std::max(1, settings.points_between));
  Shape flat;
  flat.x = Eigen::VectorXd::Zero(1);
  double least = lift(flat, target);
  Shape best = flat;
  Shape current = flat;
  for (int pairs = 1; pairs <= settings.most_pairs; ++pairs) {
    // New pairs where the excess is largest, and spread over the band: the best of them is kept.
    const Eigen::VectorXd excess = excess_of(current, target);
    Eigen::Index worst = 0;
    excess.maxCoeff(&worst);
    std::vector<double> places{target.w[static_cast<std::size_t>(worst)]};
    const double octaves = std::log(target.w.back() / target.w.front());
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) places.push_back(target.w.front() * std::exp(share * octaves));
    struct Candidate {
      Shape shape;
      double mean;
    };
    std::vector<Candidate> candidates;
    for (const double place : places) {
      for (const double damping : {0.2, 0.7}) {
        Shape shape = improve(with_pair(current, place, damping), target, settings, kFirstRounds);
        const double mean = lift(shape, target);
        candidates.push_back({shape, mean});
      }
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.mean < b.mean; });
    double round_least = std::numeric_limits<double>::infinity();
    Shape round_best;
    for (std::size_t c = 0; c < kFinalists; ++c) {
      Shape shape = improve(candidates[c].shape, target, settings, kAllRounds);
      const double mean = lift(shape, target);
      if (mean < round_least) {
        round_least = mean;
        round_best = shape;
      }
    }
    current = round_best;
    if (round_least < least) {
      least = round_least;
      best = round_best;
    }
  }
  return compare_envelope(model_of(best), frequency_Hz, dB);
}

}  // namespace handloop::identify
