#pragma once

#include "control/loop_function.h"
#include "control/polynomial.h"

/// A loop on the unit circle as polynomials. There delta = z - 1 obeys delta^2 + y delta + y = 0 with
/// y = |delta|^2 = 4 sin^2(theta/2) in [0, 4], so that every polynomial in delta reduces to alpha(y) + beta(y) delta
/// and
///
///     |alpha + beta delta|^2       = alpha^2 - y alpha beta + y beta^2
///     Re (alpha + beta delta)(alpha' + beta' delta)*  = alpha alpha' + y beta beta' - y/2 (alpha beta' + beta alpha')
///     Im (...)(...)*               = (beta alpha' - alpha beta') sin(theta)
///
/// Crossings and peaks of the loop are roots of such polynomials: finitely many, none between the points of a grid.
namespace handloop::control {

/// Delays up to here are handled by polynomials; beyond, their degree costs more digits than a search.
inline constexpr int kMaxPolynomialDelay = 3;

inline constexpr std::size_t kCirclePolynomialCapacity = 18;
using CirclePolynomial = Polynomial<kCirclePolynomialCapacity>;

/// alpha(y) + beta(y) delta.
struct OnCircle {
  CirclePolynomial alpha, beta;

  OnCircle times_delta() const { return {-1.0 * beta.shifted(), alpha - beta.shifted()}; }
  OnCircle plus(double c) const {
    OnCircle sum = *this;
    sum.alpha.c[0] += c;
    return sum;
  }
  OnCircle times(double c) const { return {c * alpha, c * beta}; }
  friend OnCircle operator+(const OnCircle& a, const OnCircle& b) { return {a.alpha + b.alpha, a.beta + b.beta}; }
};

/// |L| = 1, Im L = 0, and stationary |1 + L| and |S - T| of one loop.
struct CirclePolynomials {
  CirclePolynomial gain;     ///< |num|^2 - |den|^2
  CirclePolynomial phase;    ///< Im(num den*) / sin(theta)
  CirclePolynomial modulus;  ///< derivative's numerator of |den + num|^2 / |den|^2
  CirclePolynomial disk;     ///< derivative's numerator of |den - num|^2 / |den + num|^2

  explicit CirclePolynomials(const LoopFunction& loop) {
    const auto& plant = loop.plant;
    // numerator of L: plant's cubic times wall's line; denominator: filter, sections, delay
    OnCircle num;
    for (std::size_t i = 4; i-- > 0;) num = num.times_delta().plus(plant.numerator[i]);
    num = num.times_delta().times(loop.wall_c1) + num.times(loop.wall_c0);
    OnCircle den;
    den.alpha.c[0] = loop.one_minus_a, den.beta.c[0] = 1;
    CirclePolynomial den2 = filter_square(loop.one_minus_a);
    for (int i = 0; i < plant.section_count; ++i) {
      const auto& s = plant.sections[static_cast<std::size_t>(i)];
      den = den.times_delta().times_delta() + den.times_delta().times(s.a1) + den.times(s.a0);
      den2 = den2 * section_square(s);
    }
    for (int i = 0; i < loop.delay; ++i) den = den.times_delta() + den;
    const int den_degree = 1 + 2 * plant.section_count, num_degree = 2 * plant.section_count;
    const int top = den_degree + loop.delay;

    CirclePolynomial num2 = num.alpha * num.alpha + num.beta * (num.beta - num.alpha).shifted();
    num2.truncate(num_degree);
    CirclePolynomial cross = num.alpha * den.alpha + num.beta * den.beta.shifted() +
                             -0.5 * (num.alpha * den.beta + num.beta * den.alpha).shifted();
    cross.truncate(top);
    phase = num.beta * den.alpha - num.alpha * den.beta;
    phase.truncate(top - 1);
    gain = num2 - den2;
    const CirclePolynomial sum2 = num2 + den2 + 2.0 * cross;
    modulus = sum2.derivative() * den2 - sum2 * den2.derivative();
    modulus.truncate(loop.delay == 0 ? 2 * den_degree - 2 : top + den_degree - 1);
    disk = cross.derivative() * sum2 - cross * sum2.derivative();
    disk.truncate(2 * top - 2);
  }

 private:
  /// |delta + c|^2.
  static CirclePolynomial filter_square(double c) {
    CirclePolynomial p;
    p.degree = 1, p.c[0] = c * c, p.c[1] = 1 - c;
    return p;
  }
  /// |delta^2 + a1 delta + a0|^2.
  static CirclePolynomial section_square(const DeltaSection& s) {
    CirclePolynomial p;
    p.degree = 2;
    p.c[0] = s.a0 * s.a0, p.c[1] = s.a1 * s.a1 - 2 * s.a0 - s.a0 * s.a1, p.c[2] = 1 - s.a1 + s.a0;
    return p;
  }
};

/// Where 1 + L = 0 can be met by a real stiffness, the damping being given: Im of (den + damping's part of num) over
/// stiffness's part of num, which is n (delta + 1 - a).
struct StiffnessCrossings {
  CirclePolynomial phase;

  /// The loop is given with its damping and no stiffness.
  explicit StiffnessCrossings(const LoopFunction& loop) {
    const auto& plant = loop.plant;
    OnCircle plant_num;
    for (std::size_t i = 4; i-- > 0;) plant_num = plant_num.times_delta().plus(plant.numerator[i]);
    const OnCircle per_stiffness = plant_num.times_delta() + plant_num.times(loop.one_minus_a);
    OnCircle rest;
    rest.alpha.c[0] = loop.one_minus_a, rest.beta.c[0] = 1;
    for (int i = 0; i < plant.section_count; ++i) {
      const auto& s = plant.sections[static_cast<std::size_t>(i)];
      rest = rest.times_delta().times_delta() + rest.times_delta().times(s.a1) + rest.times(s.a0);
    }
    for (int i = 0; i < loop.delay; ++i) rest = rest.times_delta() + rest;
    rest = rest + plant_num.times_delta().times(loop.wall_c1);
    phase = per_stiffness.beta * rest.alpha - per_stiffness.alpha * rest.beta;
    phase.truncate(2 * plant.section_count + loop.delay);
  }
};

}  // namespace handloop::control
