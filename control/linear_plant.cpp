#include "control/linear_plant.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "control/transfer_loop.h"
#include "models/errors.h"

namespace handloop::control {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// A linear system under construction: x' = A x + (inputs), grown one block at a time. Every signal is a row over the
/// states.
class Builder {
 public:
  explicit Builder(Eigen::Index states) : A_(MatrixXd::Zero(states, states)) {}

  MatrixXd& A() { return A_; }
  Eigen::Index size() const { return A_.rows(); }

  /// Adds states w' = a w + b u and returns the row of y = c w + d u, where u is a row over the states.
  RowVectorXd add(const MatrixXd& a, const VectorXd& b, const RowVectorXd& c, double d, const RowVectorXd& u) {
    const Eigen::Index n = size(), m = a.rows();
    A_.conservativeResizeLike(MatrixXd::Zero(n + m, n + m));
    A_.bottomRightCorner(m, m) = a;
    A_.bottomLeftCorner(m, u.size()) = b * u;
    RowVectorXd y = RowVectorXd::Zero(n + m);
    y.head(u.size()) = d * u;
    y.tail(m) += c;
    return y;
  }

 private:
  MatrixXd A_;
};

std::vector<double> trimmed(std::vector<double> c) {
  const auto first = std::find_if(c.begin(), c.end(), [](double x) { return x != 0; });
  c.erase(c.begin(), first);
  return c;
}

/// numerator/denominator = quotient + remainder/denominator, the remainder shorter. Highest power first; quotient
/// lowest first.
struct Division {
  std::vector<double> quotient;
  std::vector<double> remainder;    ///< of as many coefficients as the denominator has roots, denominator monic
  std::vector<double> denominator;  ///< monic
};

Division divide(const std::vector<double>& numerator, const std::vector<double>& denominator) {
  Division d;
  d.denominator = trimmed(denominator);
  if (d.denominator.empty()) throw InputError("an effect's linear form has a zero denominator");
  std::vector<double> rest = trimmed(numerator);
  const double lead = d.denominator.front();
  for (double& c : d.denominator) c /= lead;
  for (double& c : rest) c /= lead;
  const std::size_t n = d.denominator.size() - 1;
  while (rest.size() > n) {
    const double q = rest.front();
    const std::size_t power = rest.size() - 1 - n;
    if (d.quotient.size() <= power) d.quotient.resize(power + 1, 0.0);
    d.quotient[power] = q;
    for (std::size_t i = 0; i <= n; ++i) rest[i] -= q * d.denominator[i];
    rest.erase(rest.begin());
  }
  d.remainder.assign(n - rest.size(), 0.0);
  d.remainder.insert(d.remainder.end(), rest.begin(), rest.end());
  return d;
}

/// Controllable form of remainder/denominator, its states scaled in time so that none dwarfs another.
struct Realisation {
  MatrixXd a;
  VectorXd b;
  RowVectorXd c;
};

Realisation realise(const Division& d) {
  const auto n = static_cast<Eigen::Index>(d.denominator.size()) - 1;
  Realisation r{MatrixXd::Zero(n, n), VectorXd::Zero(n), RowVectorXd::Zero(n)};
  double rate = 1;
  for (std::size_t i = 1; i < d.denominator.size(); ++i) {
    rate = std::max(rate, std::pow(std::abs(d.denominator[i]), 1.0 / static_cast<double>(i)));
  }
  // state i is the input filtered by s^i rate^(n-i)/denominator
  for (Eigen::Index i = 0; i + 1 < n; ++i) r.a(i, i + 1) = rate;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(n - i);  // coefficient of s^i
    r.a(n - 1, i) = -d.denominator[k] * std::pow(rate, static_cast<double>(i - n + 1));
    r.c(i) = d.remainder[k - 1] * std::pow(rate, static_cast<double>(i - n));
  }
  if (n > 0) r.b(n - 1) = rate;
  return r;
}

/// Adds a delay of tau as a chain of all-pass sections, poles from Pade's (n, n) approximant.
RowVectorXd add_delay(Builder& builder, RowVectorXd signal, double tau) {
  if (tau <= 0) return signal;
  const int n = std::clamp(static_cast<int>(std::ceil(300 * tau)) + 4, 4, 24);
  std::vector<double> denominator(static_cast<std::size_t>(n) + 1);  // in s tau, highest power first
  double c = 1;
  for (int k = 0; k <= n; ++k) {
    denominator[static_cast<std::size_t>(n - k)] = c;
    c *= static_cast<double>(n - k) / ((2.0 * n - k) * (k + 1));
  }
  for (const auto& root : polynomial_roots(denominator)) {
    const std::complex<double> p = root / tau;
    if (p.imag() == 0) {  // (r - s)/(r + s) = -1 + 2 r/(s + r)
      const double r = -p.real();
      signal = builder.add(MatrixXd::Constant(1, 1, -r), VectorXd::Constant(1, r), RowVectorXd::Constant(1, 2.0), -1.0,
                           signal);
    } else if (p.imag() > 0) {  // (s^2 - u s + v)/(s^2 + u s + v) = 1 - 2 u s/(...)
      const double u = -2 * p.real(), w = std::abs(p);
      MatrixXd a(2, 2);
      a << 0, w, -w, -u;
      signal = builder.add(a, Eigen::Vector2d(0, 1), Eigen::RowVector2d(0, -2 * u), 1.0, signal);
    }
  }
  return signal;
}

/// A rational operation on a signal that needs no derivative.
RowVectorXd add_transfer(Builder& builder, const RowVectorXd& signal, const models::LinearElement& element,
                         std::string_view name) {
  const Division d = divide(element.numerator, element.denominator);
  if (d.quotient.size() > 1)
    throw InputError(std::string(name) + ": differentiates its signal, which has no margins behind a hold");
  const double direct = d.quotient.empty() ? 0.0 : d.quotient[0];
  if (d.denominator.size() == 1) return direct * signal;
  const Realisation r = realise(d);
  return builder.add(r.a, r.b, r.c, direct, signal);
}

}  // namespace

std::complex<double> LinearPlant::operator()(std::complex<double> s) const {
  const Eigen::MatrixXcd shifted = s * Eigen::MatrixXcd::Identity(A.rows(), A.rows()) - A.cast<std::complex<double>>();
  const Eigen::VectorXcd x = shifted.partialPivLu().solve(B.cast<std::complex<double>>());
  return (C.cast<std::complex<double>>() * x).value() * std::exp(-s * delay_s);
}

LinearPlant linear_plant(const models::AxisModel& model, const models::AxisOperatingPoint& point, double tip_mass_kg,
                         double tip_damping_Ns_per_m) {
  using models::Place;
  const bool two = model.base == models::BaseModel::arm5;
  const Eigen::Index n = two ? 2 : 1;
  MatrixXd mass = MatrixXd::Zero(n, n), damping = mass, stiffness = mass;
  const auto port = [&](Place place) {
    VectorXd p = VectorXd::Zero(n);
    if (place == Place::joint || !two)
      p(0) = 1;
    else if (place == Place::grasp)
      p(0) = 1, p(1) = -1;
    else
      p(1) = 1;
    return p;
  };
  const auto put = [&](const VectorXd& p, double k, double b, double m) {
    stiffness += k * p * p.transpose(), damping += b * p * p.transpose(), mass += m * p * p.transpose();
  };
  put(port(Place::joint), 0, tip_damping_Ns_per_m, tip_mass_kg);
  if (two) {
    put(port(Place::grasp), model.arm.k1_N_per_m, model.arm.b1_Ns_per_m, 0);
    put(port(Place::arm), model.arm.k2_N_per_m, model.arm.b2_Ns_per_m, model.arm.mass_kg);
  } else {
    put(port(Place::arm), model.msd.k_N_per_m, model.msd.b_Ns_per_m, model.msd.mass_kg);
  }
  // states: displacements, then velocities; forces of effects with memory join as rows over the states
  struct PortForce {
    VectorXd port;
    models::LinearElement element;
    std::string_view name;
  };
  std::vector<PortForce> with_memory;
  std::vector<std::pair<models::LinearElement, std::string_view>> actuator, sensor;
  double delay = 0;
  for (const auto& effect : model.effects) {
    const Place place = effect->place();
    models::LinearElement e = effect->linearise(point.at(place), model.port_base(place));
    if (place == Place::grasp) {  // inertia at the grasp moves with the grip
      put(port(Place::joint), 0, 0, e.mass_kg);
      e.mass_kg = 0;
      if (!two) continue;  // an msd plant has no grasp
    }
    const std::string_view name = effect->info().name;
    if (place == Place::actuator || place == Place::sensor) {
      delay += e.delay_s;
      if (!e.numerator.empty()) (place == Place::actuator ? actuator : sensor).emplace_back(e, name);
      continue;
    }
    const VectorXd p = port(place);
    put(p, e.stiffness_N_per_m, e.damping_Ns_per_m, e.mass_kg);
    if (e.numerator.empty()) continue;
    const Division d = divide(e.numerator, e.denominator);
    if (e.delay_s > 0 ? d.quotient.size() > 2 : d.quotient.size() > 3) {
      throw InputError(std::string(name) + ": its linear form has more zeros than a mass allows");
    }
    if (e.delay_s == 0) {
      put(p, d.quotient.size() > 0 ? d.quotient[0] : 0, d.quotient.size() > 1 ? d.quotient[1] : 0,
          d.quotient.size() > 2 ? d.quotient[2] : 0);
    }
    with_memory.push_back({p, e, name});
  }
  const Eigen::PartialPivLU<MatrixXd> inertia(mass);
  Builder builder(2 * n);
  builder.A().topRightCorner(n, n).setIdentity();
  builder.A().bottomLeftCorner(n, n) = -inertia.solve(stiffness);
  builder.A().bottomRightCorner(n, n) = -inertia.solve(damping);
  for (const auto& force : with_memory) {
    RowVectorXd displacement = RowVectorXd::Zero(2 * n), velocity = displacement;
    displacement.head(n) = force.port.transpose();
    velocity.segment(n, n) = force.port.transpose();
    const Division d = divide(force.element.numerator, force.element.denominator);
    RowVectorXd signal = RowVectorXd::Zero(builder.size());
    if (d.denominator.size() > 1) {
      const Realisation r = realise(d);
      signal = builder.add(r.a, r.b, r.c, 0.0, displacement);
    }
    if (force.element.delay_s > 0) {
      if (d.quotient.size() > 0) signal.head(2 * n) += d.quotient[0] * displacement;
      if (d.quotient.size() > 1) signal.head(2 * n) += d.quotient[1] * velocity;
      signal = add_delay(builder, signal, force.element.delay_s);
    }
    builder.A().block(n, 0, n, signal.size()) -= inertia.solve(force.port) * signal;
  }
  RowVectorXd position = RowVectorXd::Zero(2 * n);
  position(0) = 1;
  for (const auto& [element, name] : sensor) position = add_transfer(builder, position, element, name);
  // the actuator's chain: its last signal is the force on the tip, its first the input
  LinearPlant plant;
  plant.delay_s = delay;
  const Eigen::Index states = builder.size();
  VectorXd push = VectorXd::Zero(states);
  VectorXd unit = VectorXd::Zero(n);
  unit(0) = 1;
  push.segment(n, n) = inertia.solve(unit);
  MatrixXd A = builder.A();
  VectorXd B = push;
  for (const auto& [element, name] : actuator) {  // in front of what there is: u -> element -> B
    const Division d = divide(element.numerator, element.denominator);
    if (d.quotient.size() > 1)
      throw InputError(std::string(name) + ": differentiates its signal, which has no margins behind a hold");
    const double direct = d.quotient.empty() ? 0.0 : d.quotient[0];
    const Realisation r = realise(d);
    const Eigen::Index m = r.a.rows(), old = A.rows();
    MatrixXd grown = MatrixXd::Zero(old + m, old + m);
    grown.topLeftCorner(old, old) = A;
    grown.bottomRightCorner(m, m) = r.a;
    grown.topRightCorner(old, m) = B * r.c;
    VectorXd input(old + m);
    input << direct * B, r.b;
    A = grown, B = input;
  }
  plant.C = RowVectorXd::Zero(A.rows());
  plant.C.head(position.size()) = position;
  plant.A = A, plant.B = B;
  return plant;
}

}  // namespace handloop::control
