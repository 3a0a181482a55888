#include "control/sampled_plant.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace handloop::control {
namespace {

/// s^2 + u s + v.
template <class Real>
struct Quadratic {
  Real u{};
  Real v{};
};

/// r1 s + r0.
template <class Real>
struct Linear {
  Real r1{};
  Real r0{};
};

/// Two quadratics and how far they are from having a common root: |resultant| over the size of its terms.
template <class Real>
struct Split {
  Quadratic<Real> first, second;
  Real separation{};
};

/// Resultant of the two, and the same with absolute values, to judge cancellation by.
template <class Real>
Real separation(const Quadratic<Real>& p, const Quadratic<Real>& q) {
  using std::abs;
  const Real du = q.u - p.u, dv = q.v - p.v;
  const Real resultant = dv * dv - du * dv * p.u + du * du * p.v;
  const Real sv = p.v + q.v, su = abs(p.u) + abs(q.u);
  const Real size = sv * sv + su * sv * abs(p.u) + su * su * p.v;
  return size > 0 ? abs(resultant) / size : Real(0);
}

/// Solves n = (first) q + (second) p for two linear polynomials, n cubic (lowest power first): the partial fractions of
/// n/(p q) are first/p and second/q.
template <class Real>
std::array<Linear<Real>, 2> partial_fractions(const std::array<Real, 4>& n, const Quadratic<Real>& p,
                                              const Quadratic<Real>& q) {
  const auto over = [&n](const Quadratic<Real>& own, const Quadratic<Real>& other) {
    // n modulo own, times the inverse of other modulo own
    const Real r2 = n[2] - n[3] * own.u;
    const Real m1 = n[1] - n[3] * own.v - r2 * own.u;
    const Real m0 = n[0] - r2 * own.v;
    const Real a = other.u - own.u, b = other.v - own.v;
    const Real resultant = b * b - a * b * own.u + a * a * own.v;
    const Real i1 = -a, i0 = b - a * own.u;
    const Real s2 = m1 * i1;
    return Linear<Real>{(m1 * i0 + m0 * i1 - s2 * own.u) / resultant, (m0 * i0 - s2 * own.v) / resultant};
  };
  return {over(p, q), over(q, p)};
}

/// Largest real root of y^3 + c2 y^2 + c1 y + c0, by Newton's method from above, which is monotonic there.
template <class Real>
Real largest_root(Real c2, Real c1, Real c0) {
  using std::abs, std::sqrt, std::cbrt, std::max;
  Real y = -c2 / 3 + max({abs(c2), sqrt(abs(c1)), cbrt(abs(c0))});
  const auto value = [&](Real x) { return ((x + c2) * x + c1) * x + c0; };
  while (value(y) < 0) y = 2 * abs(y) + std::numeric_limits<Real>::min();
  for (int i = 0; i < 100; ++i) {
    const Real slope = (3 * y + 2 * c2) * y + c1;
    if (!(slope > 0)) break;
    const Real next = y - value(y) / slope;
    if (!(next < y)) break;
    y = next;
  }
  return y;
}

/// Splits s^4 + c3 s^3 + c2 s^2 + c1 s + c0 (no negative coefficient) into two real quadratics by the resolvent cubic,
/// then sharpens the product to rounding by Newton's method.
template <class Real>
Split<Real> split_quartic(const std::array<Real, 4>& c) {
  using std::abs, std::sqrt, std::max;
  const Real y =
      largest_root<Real>(-c[2], c[3] * c[1] - 4 * c[0], -(c[3] * c[3] * c[0] - 4 * c[2] * c[0] + c[1] * c[1]));
  const Real u_gap2 = c[3] * c[3] / 4 - c[2] + y, v_gap2 = y * y / 4 - c[0];
  Real u_gap = sqrt(max(u_gap2, Real(0))), v_gap = sqrt(max(v_gap2, Real(0)));
  const Real cross = c[3] * y / 2 - c[1];  // = 2 u_gap v_gap
  // the better known of the two gaps gives the other
  if (u_gap2 > 1e-3 * (c[3] * c[3] / 4 + c[2] + abs(y)) && u_gap > 0)
    v_gap = cross / (2 * u_gap);
  else if (v_gap > 0)
    u_gap = cross / (2 * v_gap);
  Quadratic<Real> p{c[3] / 2 + u_gap, y / 2 + v_gap}, q{c[3] / 2 - u_gap, y / 2 - v_gap};
  // the smaller constants follow from products, free of cancellation
  if (p.v < q.v) std::swap(p, q);
  if (p.v > 0) q.v = c[0] / p.v;
  const auto residual = [&c](const Quadratic<Real>& a, const Quadratic<Real>& b) {
    return std::array<Real, 4>{c[0] - a.v * b.v, c[1] - a.u * b.v - a.v * b.u, c[2] - a.v - b.v - a.u * b.u,
                               c[3] - a.u - b.u};
  };
  const auto size = [&c](const std::array<Real, 4>& r) {
    Real worst = 0;
    for (std::size_t i = 0; i < 4; ++i) worst = max(worst, abs(r[i]) / (c[i] + std::numeric_limits<Real>::min()));
    return worst;
  };
  auto r = residual(p, q);
  Real error = size(r);
  for (int i = 0; i < 20 && error > 0; ++i) {
    const auto step = partial_fractions(r, p, q);
    const Quadratic<Real> p2{p.u + step[0].r1, p.v + step[0].r0}, q2{q.u + step[1].r1, q.v + step[1].r0};
    const auto r2 = residual(p2, q2);
    const Real error2 = size(r2);
    if (!(error2 < error)) break;
    p = p2, q = q2, r = r2, error = error2;
  }
  return {p, q, separation(p, q)};
}

template <class Real>
bool has_real_roots(const Quadratic<Real>& q) {
  return q.u * q.u / 4 >= q.v;
}

template <class Real>
std::array<Real, 2> real_roots(const Quadratic<Real>& q) {
  const Real gap = std::sqrt(std::max(q.u * q.u / 4 - q.v, Real(0)));
  const Real big = -(q.u / 2 + gap);
  return {big, big != 0 ? q.v / big : Real(0)};
}

/// Where all four roots are real, pairs them so that nearly equal ones share a section.
template <class Real>
Split<Real> best_pairing(const Split<Real>& split) {
  if (split.separation > 1e-2 || !has_real_roots(split.first) || !has_real_roots(split.second)) return split;
  const auto [a, b] = real_roots(split.first);
  const auto [c, d] = real_roots(split.second);
  const auto pair = [](Real s, Real t) { return Quadratic<Real>{-(s + t), s * t}; };
  Split<Real> best = split;
  for (const auto& [p, q] : {std::pair{pair(a, c), pair(b, d)}, std::pair{pair(a, d), pair(b, c)}}) {
    const Real s = separation(p, q);
    if (s > best.separation) best = {p, q, s};
  }
  return best;
}

/// Response of 1/(s^2 + u s + v) at T: to an impulse, h, and to a step, w.
template <class Real>
struct Response {
  Real impulse{};
  Real step{};
};

template <class Real>
Response<Real> responses(const Quadratic<Real>& q, Real T) {
  using std::abs, std::sqrt, std::exp, std::expm1, std::sin, std::cos, std::sinh, std::cosh;
  const Real uT = q.u * T, vT2 = q.v * T * T;
  if (abs(uT) < 1 && vT2 < 1) {
    // sums of complete homogeneous polynomials of the poles: h_k = -u T h_{k-1} - v T^2 h_{k-2}
    Real before = 0, h = 1, factorial = 1, impulse = 0, step = 0;
    for (int k = 0; k < 40; ++k) {
      factorial *= Real(k + 1);
      const Real term = h / factorial;
      impulse += term, step += term / Real(k + 2);
      if (abs(h) + abs(before) < std::numeric_limits<Real>::epsilon() / 8 * factorial) break;
      const Real next = -uT * h - vT2 * before;
      before = h, h = next;
    }
    return {impulse * T, step * T * T};
  }
  const Real c = -q.u / 2, D = c * c - q.v;
  if (D < 0) {
    const Real w = sqrt(-D), decay = exp(c * T), s = sin(w * T) / w;
    return {decay * s, (1 - decay * (cos(w * T) - c * s)) / q.v};
  }
  const Real g = sqrt(D);
  if (g * T < Real(0.5)) {
    const Real decay = exp(c * T), s = g > 0 ? sinh(g * T) / g : T;
    return {decay * s, (1 - decay * (cosh(g * T) - c * s)) / q.v};
  }
  const auto [fast, slow] = real_roots(q);
  const Real growth_slow = slow != 0 ? expm1(slow * T) / slow : T;
  const Real growth_fast = expm1(fast * T) / fast;
  return {exp(slow * T) * -expm1(-2 * g * T) / (2 * g), (growth_slow - growth_fast) / (2 * g)};
}

template <class Real>
struct SampledSection {
  Real a1{}, a0{}, b1{}, b0{};
};

/// (r1 s + r0)/(s^2 + u s + v) behind a zero-order hold. Every sum below is free of cancellation for slow poles.
template <class Real>
SampledSection<Real> sample_section(const Quadratic<Real>& q, const Linear<Real>& n, Real T) {
  const auto [h, w] = responses(q, T);
  const Real a0_over_v = h * h + w * (q.u * h + q.v * w);
  return {q.u * h + 2 * q.v * w, q.v * a0_over_v, n.r1 * h + n.r0 * w, n.r0 * a0_over_v};
}

template <class Real>
std::array<std::complex<double>, 2> poles_of(const Quadratic<Real>& q) {
  if (has_real_roots(q)) {
    const auto [a, b] = real_roots(q);
    return {std::complex<double>(static_cast<double>(a)), std::complex<double>(static_cast<double>(b))};
  }
  const std::complex<double> p(static_cast<double>(-q.u / 2), static_cast<double>(std::sqrt(q.v - q.u * q.u / 4)));
  return {p, std::conj(p)};
}

template <class Real>
SampledPlant sample_held_tip(const models::ArmParameters& arm, double tip_mass, double tip_damping, double sample_time,
                             Real& separation_found) {
  const Real m = tip_mass, b = tip_damping, T = sample_time;
  const Real M = arm.mass_kg, k1 = arm.k1_N_per_m, k2 = arm.k2_N_per_m, b1 = arm.b1_Ns_per_m, b2 = arm.b2_Ns_per_m;
  const Real lead = m * M;
  // time is measured in units in which the product of the poles is about one
  std::array<Real, 4> c{k1 * k2 / lead, (b * (k1 + k2) + b1 * k2 + k1 * b2) / lead,
                        (m * (k1 + k2) + M * k1 + b * (b1 + b2) + b1 * b2) / lead,
                        (m * (b1 + b2) + M * (b + b1)) / lead};
  const Real unit = std::sqrt(c[2]);
  c = {c[0] / (unit * unit * unit * unit), c[1] / (unit * unit * unit), c[2] / (unit * unit), c[3] / unit};
  const Split<Real> split = best_pairing(split_quartic(c));
  separation_found = split.separation;
  const std::array<Real, 4> n{(k1 + k2) / (lead * unit * unit), (b1 + b2) / (lead * unit), M / lead, Real(0)};
  const auto fractions = partial_fractions(n, split.first, split.second);
  const auto s = sample_section(split.first, fractions[0], T * unit);
  const auto t = sample_section(split.second, fractions[1], T * unit);
  SampledPlant sampled;
  sampled.section_count = 2;
  sampled.sample_time_s = sample_time;
  const auto to_double = [](Real x) { return static_cast<double>(x); };
  sampled.sections = {DeltaSection{to_double(s.a1), to_double(s.a0)}, DeltaSection{to_double(t.a1), to_double(t.a0)}};
  const Real scale = 1 / (unit * unit);  // of P: the fractions were formed with s in units of `unit`
  sampled.numerator = {to_double(scale * (s.b0 * t.a0 + t.b0 * s.a0)),
                       to_double(scale * (s.b0 * t.a1 + s.b1 * t.a0 + t.b0 * s.a1 + t.b1 * s.a0)),
                       to_double(scale * (s.b0 + s.b1 * t.a1 + t.b0 + t.b1 * s.a1)), to_double(scale * (s.b1 + t.b1))};
  const auto p = poles_of(split.first), q = poles_of(split.second);
  const double rate = to_double(unit);
  sampled.poles = {rate * p[0], rate * p[1], rate * q[0], rate * q[1]};
  return sampled;
}

SampledPlant sample_free_tip(double m, double b, double T) {
  const auto s = sample_section<double>({b / m, 0.0}, {0.0, 1 / m}, T);
  SampledPlant sampled;
  sampled.section_count = 1;
  sampled.sample_time_s = T;
  sampled.sections[0] = {s.a1, s.a0};
  sampled.numerator = {s.b0, s.b1, 0, 0};
  sampled.poles = {0.0, -b / m};
  return sampled;
}

}  // namespace

SampledPlant sample_plant(const LoopPlant& plant, double sample_time_s) noexcept {
  if (!plant.arm) return sample_free_tip(plant.tip_mass_kg, plant.tip_damping_Ns_per_m, sample_time_s);
  double separation = 0;
  const auto sampled =
      sample_held_tip(*plant.arm, plant.tip_mass_kg, plant.tip_damping_Ns_per_m, sample_time_s, separation);
  if (separation > 1e-4) return sampled;
  // modes that nearly coincide cancel each other's digits: once more with longer ones
  long double long_separation = 0;
  double mass = plant.tip_mass_kg;
  for (int i = 0;; ++i) {
    const auto longer = sample_held_tip(*plant.arm, mass, plant.tip_damping_Ns_per_m, sample_time_s, long_separation);
    if (long_separation > 1e-9L || i == 3) return longer;
    mass *= 1 + 1e-9;  // coinciding to the last digit: move apart by less than any margin shows
  }
}

std::complex<double> SampledPlant::operator()(std::complex<double> delta) const {
  std::complex<double> value = ((numerator[3] * delta + numerator[2]) * delta + numerator[1]) * delta + numerator[0];
  for (int i = 0; i < section_count; ++i) {
    value /= (delta + sections[static_cast<std::size_t>(i)].a1) * delta + sections[static_cast<std::size_t>(i)].a0;
  }
  return value;
}

}  // namespace handloop::control
