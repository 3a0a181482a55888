#include "control/stability_boundary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "control/circle_polynomials.h"
#include "control/scan.h"

namespace handloop::control {
namespace {

constexpr double kPi = std::numbers::pi;
using Complex = std::complex<double>;

/// K + B q = r at a point of the circle.
struct Line {
  Complex q, r;
};

class Partition {
 public:
  Partition(const SampledPlant& plant, const LoopTiming& timing)
      : plant_(plant), T_(timing.sample_time_s), delay_(timing.delay_samples) {
    one_minus_a_ = -std::expm1(-2 * kPi * timing.cutoff_Hz * T_);
  }

  Line line(Complex delta) const {
    const Complex z = 1.0 + delta;
    Complex r = -1.0 / plant_(delta);
    for (int i = 0; i < delay_; ++i) r *= z;
    return {one_minus_a_ / T_ * delta / (delta + one_minus_a_), r};
  }
  Line line_at(double theta) const { return line(LoopFunction::delta_at(theta).std()); }

  /// Stiffness at which a pole lies at angle theta for this damping, and how far from real it would have to be.
  Complex stiffness(double theta, double damping) const {
    const auto [q, r] = line_at(theta);
    return r - damping * q;
  }

  /// The curve: the one pair of gains that puts a pole pair at +-theta.
  BoundaryPiece::Point at(double theta) const {
    const auto [q, r] = line_at(theta);
    const double damping = r.imag() / q.imag();
    return {r.real() - damping * q.real(), damping, theta / T_};
  }

  double sample_time() const { return T_; }

 private:
  const SampledPlant& plant_;
  double T_, one_minus_a_;
  int delay_;
};

struct Candidate {
  double stiffness, frequency;
};

/// Every K at which some pole meets the unit circle.
std::vector<Candidate> crossings(const SampledPlant& plant, const LoopTiming& timing, double damping) {
  const Partition partition(plant, timing);
  std::vector<Candidate> found;
  const auto add = [&](double theta) {
    const double K = partition.stiffness(theta, damping).real();
    if (std::isfinite(K)) found.push_back({K, theta / timing.sample_time_s});
  };
  for (const Complex end : {Complex(0), Complex(-2)}) {
    const auto [q, r] = partition.line(end);
    const double K = (r - damping * q).real();
    if (std::isfinite(K))
      found.push_back({K, end == 0.0 ? 0.0 : kPi / timing.sample_time_s});
    else if (end == 0.0)
      found.push_back({0.0, 0.0});  // an integrating plant: K = 0 leaves its pole at 1
  }
  const auto imaginary = [&](double theta) { return partition.stiffness(theta, damping).imag(); };
  if (timing.delay_samples <= kMaxPolynomialDelay) {
    // the crossings of L/K at which it is real: den z^d + B.. n over n (delta + 1 - a)
    const LoopFunction loop(plant, timing, {0.0, damping});
    const StiffnessCrossings polynomial(loop);
    const auto roots = roots_in(polynomial.phase, 4.0);
    for (int i = 0; i < roots.count; ++i) {
      double theta = 2 * std::asin(std::min(1.0, std::sqrt(roots.x[static_cast<std::size_t>(i)]) / 2));
      double a = theta * (1 - 1e-7), fa = imaginary(a), fb = imaginary(theta);
      for (int k = 0; k < 8 && fb != 0 && fa != fb; ++k) {  // secant, to rounding
        const double next = theta - fb * (theta - a) / (fb - fa);
        if (!(std::abs(next - theta) < 1e-4 * theta)) break;
        a = theta, fa = fb, theta = next, fb = imaginary(theta);
      }
      add(theta);
    }
  } else {
    FrequencyGrid grid(1e-6, kPi);
    grid.add_logarithmic(400);
    grid.add_even(400 * (1 + timing.delay_samples));
    detail::roots_on_grid(grid.sorted(), imaginary, add);
  }
  std::sort(found.begin(), found.end(),
            [](const Candidate& a, const Candidate& b) { return a.stiffness < b.stiffness; });
  return found;
}

}  // namespace

StableStiffness stable_stiffness(const SampledPlant& plant, const LoopTiming& timing, double damping, double lowest,
                                 double highest) {
  const ClosedLoopVerdict verdict(plant, timing);
  StableStiffness result;
  struct End {
    double K, frequency;
  };
  std::vector<End> ends{{lowest, 0.0}};
  for (const auto& c : crossings(plant, timing, damping)) {
    if (c.stiffness > lowest && c.stiffness < highest) ends.push_back({c.stiffness, c.frequency});
  }
  ends.push_back({highest, 0.0});
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double low = ends[i].K, high = ends[i + 1].K;
    if (!(high > low)) continue;
    const double inside = std::isinf(high) ? 2 * std::abs(low) + 1e3 : 0.5 * (low + high);
    if (!verdict.stable({inside, damping})) continue;
    auto& list = result.intervals;
    const auto last = static_cast<std::size_t>(result.count);
    if (last > 0 && list[last - 1].high == low) {  // a pole touched the circle and went back
      list[last - 1].high = high, list[last - 1].high_at_rad_per_s = ends[i + 1].frequency;
    } else if (last < list.size()) {
      list[last] = {low, high, ends[i].frequency, ends[i + 1].frequency};
      ++result.count;
    }
  }
  return result;
}

double critical_stiffness(const SampledPlant& plant, const LoopTiming& timing, double damping) {
  const StableStiffness stable = stable_stiffness(plant, timing, damping);
  return stable.count > 0 && stable.intervals[0].low == 0 ? stable.intervals[0].high : 0.0;
}

std::vector<BoundaryPiece> trace_boundary(const SampledPlant& plant, const LoopTiming& timing,
                                          const GainWindow& window) {
  const Partition partition(plant, timing);
  const ClosedLoopVerdict verdict(plant, timing);
  using Point = BoundaryPiece::Point;
  const double width = window.stiffness_high - window.stiffness_low, height = window.damping_high - window.damping_low;
  const double edge = 1e-9;
  const auto inside = [&](const Point& p) {
    return p.stiffness_N_per_m >= window.stiffness_low - edge * width &&
           p.stiffness_N_per_m <= window.stiffness_high + edge * width &&
           p.damping_Ns_per_m >= window.damping_low - edge * height &&
           p.damping_Ns_per_m <= window.damping_high + edge * height;
  };
  // a point parts stable from unstable where a nudge to either side of the curve decides it
  const auto parts = [&](const Point& p, double dK, double dB) {
    const double length = std::hypot(dK / width, dB / height);
    if (!(length > 0)) return false;
    const double nK = -dB / height / length * width * 1e-5, nB = dK / width / length * height * 1e-5;
    return verdict.stable({p.stiffness_N_per_m + nK, p.damping_Ns_per_m + nB}) !=
           verdict.stable({p.stiffness_N_per_m - nK, p.damping_Ns_per_m - nB});
  };
  std::vector<BoundaryPiece> pieces;
  /// Follows a curve over a parameter, cutting it where it leaves the window or stops parting.
  const auto follow = [&](double from, double to, int steps, bool logarithmic,
                          const std::function<Point(double)>& curve) {
    const auto good = [&](double t) {
      const Point p = curve(t);
      if (!std::isfinite(p.stiffness_N_per_m) || !std::isfinite(p.damping_Ns_per_m) || !inside(p)) return false;
      const double h = 1e-6 * std::max(std::abs(t), 1e-9);
      const Point a = curve(t - h), b = curve(t + h);
      return parts(p, b.stiffness_N_per_m - a.stiffness_N_per_m, b.damping_Ns_per_m - a.damping_Ns_per_m);
    };
    const auto cut = [&](double in, double out) {
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (in + out);
        (good(middle) ? in : out) = middle;
      }
      return in;
    };
    BoundaryPiece piece;
    const auto close = [&] {
      if (piece.points.size() > 1) pieces.push_back(std::move(piece));
      piece = {};
    };
    const std::function<void(double, const Point&, double, const Point&, int)> refine =
        [&](double s, const Point& p, double t, const Point& q, int depth) {
          const double gap = std::hypot((p.stiffness_N_per_m - q.stiffness_N_per_m) / width,
                                        (p.damping_Ns_per_m - q.damping_Ns_per_m) / height);
          if (gap > 0.002 && depth < 24) {
            const double middle = 0.5 * (s + t);
            const Point m = curve(middle);
            refine(s, p, middle, m, depth + 1);
            refine(middle, m, t, q, depth + 1);
          } else {
            piece.points.push_back(q);
          }
        };
    double last = from;
    bool last_good = good(from);
    if (last_good) piece.points.push_back(curve(from));
    for (int i = 1; i <= steps; ++i) {
      const double x = static_cast<double>(i) / steps;
      const double t = logarithmic ? from * std::pow(to / from, x) : from + (to - from) * x;
      const bool is_good = good(t);
      if (last_good && is_good) {
        refine(last, curve(last), t, curve(t), 0);
      } else if (last_good) {
        const double end = cut(last, t);
        refine(last, curve(last), end, curve(end), 0);
        close();
      } else if (is_good) {
        const double begin = cut(t, last);
        piece.points.push_back(curve(begin));
        refine(begin, curve(begin), t, curve(t), 0);
      }
      last = t, last_good = is_good;
    }
    close();
  };
  // where a pair of poles crosses; at theta near 0 and pi the curve runs into the lines of real poles
  follow(1e-6, 0.3, 1500, true, [&](double theta) { return partition.at(theta); });
  follow(0.3, kPi * (1 - 1e-7), 1500, false, [&](double theta) { return partition.at(theta); });
  // where a real pole crosses at z = 1 (a stiffness that the hand's own no longer balances) and at z = -1 (every other
  // sample)
  for (const Complex end : {Complex(0), Complex(-2)}) {
    const auto [q, r] = partition.line(end);
    const double frequency = end == 0.0 ? 0.0 : kPi / timing.sample_time_s;
    const double K0 = std::isfinite(r.real()) ? r.real() : 0.0;
    follow(window.damping_low, window.damping_high, 400, false, [&](double damping) {
      return Point{K0 - damping * q.real(), damping, frequency};
    });
  }
  return pieces;
}

}  // namespace handloop::control
