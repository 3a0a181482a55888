#include "control/force_control.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <functional>

namespace handloop::control {
namespace {

using Eigen::Matrix2cd;
using Complex = std::complex<double>;

constexpr double kLowest_rad_per_s = 0.05;
constexpr double kHighest_rad_per_s = 3000.0;
constexpr int kGrid = 6000;

double largest_singular(const Matrix2cd& m) {
  return m.jacobiSvd().singularValues()[0];
}

Complex G_K(const ForceControl& c, double w) {
  return c.primary(Complex(0, w)) * c.K(Complex(0, w));
}

using Polynomial = std::vector<double>;

/// alpha's entries over one denominator: N_ik = numerator, d = product of the different denominators.
struct CommonAlpha {
  std::array<std::array<Polynomial, 2>, 2> numerator;
  Polynomial denominator{1.0};
};

CommonAlpha common(const TransferMatrix& alpha) {
  std::vector<Polynomial> different;
  const auto known = [&](const Polynomial& d) {
    return std::find(different.begin(), different.end(), d) != different.end();
  };
  for (const auto& row : alpha.entries) {
    for (const auto& entry : row) {
      const auto d = trimmed(entry.denominator);
      if (!known(d)) different.push_back(d);
    }
  }
  CommonAlpha result;
  for (const auto& d : different) result.denominator = multiply(result.denominator, d);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const auto own = trimmed(alpha.entries[i][k].denominator);
      result.numerator[i][k] = trimmed(alpha.entries[i][k].numerator);
      for (const auto& d : different) {
        if (d != own) result.numerator[i][k] = multiply(result.numerator[i][k], d);
      }
    }
  }
  return result;
}

Polynomial hand_polynomial(const ForceControl& c) {
  return {c.hand.mass_kg, c.hand.damping_Ns_per_m, c.hand.stiffness_N_per_m};
}

Polynomial scaled(Polynomial p, double factor) {
  for (auto& coefficient : p) coefficient *= factor;
  return p;
}

Polynomial loop_numerator(const ForceControl& c, const Polynomial& alpha_numerator, const Polynomial& alpha_denominator,
                          double environment_kg) {
  return add(multiply(alpha_numerator, hand_polynomial(c)), multiply(alpha_denominator, {environment_kg, 0.0, 0.0}));
}

/// The smallest real positive root lambda(w) over frequencies: `candidates(w)` gives complex values that pass through
/// the positive real axis where the loop is at its limit.
std::optional<Limit> first_crossing(const std::function<Complex(double)>& candidate, double most) {
  std::optional<Limit> best;
  const double ratio = std::pow(kHighest_rad_per_s / kLowest_rad_per_s, 1.0 / kGrid);
  double w = kLowest_rad_per_s;
  Complex before = candidate(w);
  for (int i = 0; i < kGrid; ++i) {
    const double next = w * ratio;
    const Complex here = candidate(next);
    // A jump past a pole of the candidate also changes the sign; there it is huge.
    if (before.imag() * here.imag() <= 0 && before.real() > 0 && here.real() > 0) {
      double low = w, high = next;
      const double sign = before.imag();
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (candidate(middle).imag() * sign > 0 ? low : high) = middle;
      }
      const double factor = candidate(low).real();
      if (factor <= most && (!best || factor < best->factor)) best = Limit{factor, low};
    }
    before = here;
    w = next;
  }
  return best;
}

}  // namespace

TransferFunction primary_transfer(const models::PrimaryLoop& g) {
  return {{g.n1, g.n0}, {g.d3, 1.0, g.d1, g.d0}};
}

Performance performance(const ForceControl& c, const Sensitivity& s, double band, double epsilon, std::size_t points) {
  Performance result;
  result.met_8 = result.met_9 = true;
  for (std::size_t i = 0; i < points; ++i) {
    const double w = band * std::pow(1e-3, 1.0 - static_cast<double>(i) / static_cast<double>(points - 1));
    const Matrix2cd alpha = c.alpha(Complex(0, w));
    const Matrix2cd R = alpha.inverse();
    const Matrix2cd gk = G_K(c, w) * s.sensing(w) * s.tracking(w);
    const Matrix2cd Sh = s.to_hand(w), Se = s.to_environment(w);
    PerformancePoint point;
    point.frequency_rad_per_s = w;
    point.error = largest_singular((gk * alpha + Sh).inverse() * (gk + Se) - R);
    point.have = largest_singular(gk);
    point.want = largest_singular(Se - Sh * R) * largest_singular(R) / epsilon;
    if (point.error > result.worst_error) {
      result.worst_error = point.error;
      result.worst_at_rad_per_s = w;
    }
    result.met_8 = result.met_8 && point.error < epsilon;
    result.met_9 = result.met_9 && point.have > point.want;
    result.points.push_back(point);
  }
  return result;
}

TransferMatrix closed_compliance(const ForceControl& c) {
  const auto gk = primary_transfer(c.primary) * c.K;
  const Polynomial &n = gk.numerator, &d = gk.denominator;
  TransferMatrix result;
  if (c.alpha.diagonal() && c.environment_kg(0, 1) == 0.0 && c.environment_kg(1, 0) == 0.0) {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& alpha = c.alpha.entries[i][i];
      const auto axis = static_cast<Eigen::Index>(i);
      const auto mass = c.environment_kg(axis, axis);
      result.entries[i][i] = {trimmed(multiply(n, alpha.denominator)),
                              trimmed(add(multiply(d, alpha.denominator),
                                          multiply(n, loop_numerator(c, alpha.numerator, alpha.denominator, mass))))};
    }
    return result;
  }
  // G_c = g (I + g Z)^-1 with g = n/d and Z = N/a: the polynomial matrix P = d a I + n N has G_c = n a adj(P)/det(P).
  const auto alpha = common(c.alpha);
  std::array<std::array<Polynomial, 2>, 2> P;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double mass = c.environment_kg(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      P[i][k] = multiply(n, loop_numerator(c, alpha.numerator[i][k], alpha.denominator, mass));
      if (i == k) P[i][k] = add(P[i][k], multiply(d, alpha.denominator));
    }
  }
  const auto determinant = trimmed(add(multiply(P[0][0], P[1][1]), scaled(multiply(P[0][1], P[1][0]), -1.0)));
  const auto front = multiply(n, alpha.denominator);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const auto adjoint = i == k ? P[1 - i][1 - i] : scaled(P[i][k], -1.0);
      result.entries[i][k] = {trimmed(multiply(front, adjoint)), determinant};
    }
  }
  return result;
}

SmallGain small_gain(const ForceControl& c) {
  const auto compliance = closed_compliance(c);
  SmallGain result;
  for (std::size_t i = 0; i < 2; ++i) {
    double sum = 0.0, bound = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      result.entries[i][k] = a_norm(compliance.entries[i][k]);
      sum += result.entries[i][k].value;
      bound += result.entries[i][k].error_bound;
    }
    if (sum > result.gain_m_per_N) {
      result.gain_m_per_N = sum;
      result.error_bound = bound;
    }
  }
  result.permitted_N_per_m = 1.0 / result.gain_m_per_N;
  return result;
}

double cubic_gain_N_per_m(const ForceControl& c, double cubic_N_per_m3, double reach_m) {
  // Peaks to peaks: the largest row sum of the A-norms of alpha; a constant entry's is its absolute value.
  double largest = 0.0;
  for (const auto& row : c.alpha.entries) {
    double sum = 0.0;
    for (const auto& entry : row) {
      const auto n = trimmed(entry.numerator), d = trimmed(entry.denominator);
      if (n.size() < d.size()) {
        sum += a_norm(entry).value;
        continue;
      }
      // A direct path beside a strictly proper rest.
      const double direct = n[0] / d[0];
      const auto rest = trimmed(add(n, scaled(d, -direct)));
      sum += std::abs(direct) + (rest.size() < d.size() ? a_norm({rest, d}).value : 0.0);
    }
    largest = std::max(largest, sum);
  }
  return largest * cubic_N_per_m3 * reach_m * reach_m;
}

TransferLoop axis_loop(const ForceControl& c, std::size_t axis) {
  const auto gk = primary_transfer(c.primary) * c.K;
  const auto& alpha = c.alpha.entries[axis][axis];
  const auto i = static_cast<Eigen::Index>(axis);
  TransferLoop loop;
  loop.numerator =
      trimmed(multiply(gk.numerator, loop_numerator(c, alpha.numerator, alpha.denominator, c.environment_kg(i, i))));
  loop.denominator = trimmed(multiply(gk.denominator, alpha.denominator));
  return loop;
}

std::optional<Limit> amplification_limit(const ForceControl& c, const Sensitivity& s, double most) {
  // I + A + lambda B singular: lambda = -1/eigenvalue of (I + A)^-1 B, two branches.
  std::optional<Limit> best;
  for (int branch = 0; branch < 2; ++branch) {
    const auto limit = first_crossing(
        [&](double w) -> Complex {
          const Complex jw(0, w), H = c.hand(jw);
          const Matrix2cd gk = G_K(c, w) * s.sensing(w) * s.tracking(w);
          const Matrix2cd E = c.environment_kg.cast<Complex>() * jw * jw;
          const Matrix2cd unmodelled = (c.environment_kg - c.modelled_kg).cast<Complex>() * jw * jw;
          const Matrix2cd rest = Matrix2cd::Identity() + gk * E + s.to_environment(w) * unmodelled + s.to_hand(w) * H;
          const Matrix2cd M = rest.inverse() * gk * c.alpha(jw) * H;
          const Complex half = 0.5 * M.trace();
          const Complex root = std::sqrt(half * half - M.determinant());
          // The branch of the larger real part of -1/eigenvalue, so that neighbours belong together.
          const Complex first = -1.0 / (half + root), second = -1.0 / (half - root);
          return (first.real() > second.real()) == (branch == 0) ? first : second;
        },
        most);
    if (limit && (!best || limit->factor < best->factor)) best = limit;
  }
  return best;
}

std::optional<Limit> axis_limit(const ForceControl& c, const Sensitivity& s, std::size_t axis, double most) {
  const auto i = static_cast<Eigen::Index>(axis);
  return first_crossing(
      [&](double w) -> Complex {
        const Complex jw(0, w), H = c.hand(jw), E = c.environment_kg(i, i) * jw * jw;
        const Complex gk = G_K(c, w) * s.sensing(w) * s.tracking(w)(i, i);
        const Complex unmodelled = (c.environment_kg - c.modelled_kg)(i, i) * jw * jw;
        return -(1.0 + gk * E + s.to_environment(w)(i, i) * unmodelled + s.to_hand(w)(i, i) * H) / (gk * H);
      },
      most);
}

}  // namespace handloop::control
