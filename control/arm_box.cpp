#include "control/arm_box.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/margins.h"
#include "control/polynomial.h"
#include "control/unstructured.h"

namespace handloop::control {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
enum Parameter : std::size_t { kMass, kK1, kK2, kB1, kB2 };

double rho(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains,
           const models::ArmParameters& arm) {
  LoopPlant plant = device;
  plant.arm = arm;
  return closed_loop_poles(sample_plant(plant, timing.sample_time_s), timing, gains).rho();
}

struct Rectangle {
  double left, right, low, high;

  double distance(Complex c) const {
    const double dx = std::max({left - c.real(), c.real() - right, 0.0}),
                 dy = std::max({low - c.imag(), c.imag() - high, 0.0});
    return std::hypot(dx, dy);
  }
  /// Distance of the farthest corner.
  double reach(Complex c) const {
    return std::hypot(std::max(std::abs(left - c.real()), std::abs(right - c.real())),
                      std::max(std::abs(low - c.imag()), std::abs(high - c.imag())));
  }
};

/// The proof over one stretch of frequencies.
class Exclusion {
 public:
  Exclusion(Complex D, double D_radius, const Rectangle& C) : D_(D), e_(D_radius), C_(C) {}

  /// No a of the rectangle is taken into C.
  bool holds(const Rectangle& A, int depth, std::size_t& discs) const {
    ++discs;
    const Complex a(0.5 * (A.left + A.right), 0.5 * (A.low + A.high));
    const double r = 0.5 * std::hypot(A.right - A.left, A.high - A.low);
    const Complex u = a + D_;
    const double size = std::abs(u);
    if (size > r + e_) {
      // 1/u takes the disc about u to one about u*/(|u|^2 - r^2); D itself is known to e
      const double scale = 1 / (size * size - r * r);
      const Complex image = -D_ + D_ * D_ * std::conj(u) * scale;
      const double spread = std::norm(D_) * r * scale, reach = std::abs(a) + r, near = size - r - e_;
      if (C_.distance(image) > spread + e_ * reach * reach / (near * near)) return true;
    }
    // |c + D| = |D|^2/|a + D|, large where a is near -D: C may lie wholly inside
    const double inner = std::max(0.0, std::abs(D_) - e_);
    if (C_.reach(-D_) + e_ < inner * inner / (size + r + e_)) return true;
    if (depth == 0) return false;
    const bool wide = A.right - A.left > A.high - A.low;
    Rectangle first = A, second = A;
    if (wide)
      first.right = second.left = 0.5 * (A.left + A.right);
    else
      first.high = second.low = 0.5 * (A.low + A.high);
    return holds(first, depth - 1, discs) && holds(second, depth - 1, discs);
  }

 private:
  Complex D_;
  double e_;
  Rectangle C_;
};

class Proof {
 public:
  Proof(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains, const ArmBox& box)
      : device_(device), timing_(timing), gains_(gains), box_(box) {}

  BoxCertificate run() {
    BoxCertificate result;
    const double T = timing_.sample_time_s, nyquist = kPi / T;
    if (!(rho(device_, timing_, gains_, box_.centre()) < 1)) return result;
    // stretches short against the frequency, then cut where they must be
    double low = 0, high = 1e-3 * nyquist;
    while (low < nyquist) {
      if (!stretch(low, std::min(high, nyquist), 14, result)) return result;
      low = high, high *= 1.05;
    }
    result.certified = true;
    return result;
  }

 private:
  bool stretch(double w1, double w2, int depth, BoxCertificate& result) {
    const double T = timing_.sample_time_s, w = 0.5 * (w1 + w2);
    const auto& lo = box_.low;
    const auto& hi = box_.high;
    const double K = std::abs(gains_.stiffness_N_per_m), B = std::abs(gains_.damping_Ns_per_m);
    const Complex D = faced_stiffness(device_, timing_, gains_, w);
    // |dC/dw| <= B, |C| <= K + B w, hold and delay turn by at most T (d + 1) a rad/s
    const double slope = 2 * device_.tip_mass_kg * w2 + device_.tip_damping_Ns_per_m +
                         (K + B * w2) * T * (timing_.delay_samples + 1) + B;
    const double images = (K + B * w2) * image_bound(w2);
    const double radius =
        images < 0.5 ? 0.5 * slope * (w2 - w1) + (K + B * w2) * images / (1 - images) : Margins::kInfinity;
    if (std::isfinite(radius)) {
      const Rectangle A{lo[kK1], hi[kK1], w1 * lo[kB1], w2 * hi[kB1]};
      const Rectangle C{lo[kK2] - w2 * w2 * hi[kMass], hi[kK2] - w1 * w1 * lo[kMass], w1 * lo[kB2], w2 * hi[kB2]};
      if (Exclusion(D, radius, C).holds(A, depth < 8 ? 14 : 8, result.discs)) return true;
    }
    if (depth == 0 || result.discs > 4'000'000) {
      result.failed_at_rad_per_s = w;
      return false;
    }
    return stretch(w1, w, depth - 1, result) && stretch(w, w2, depth - 1, result);
  }

  /// Bound over the box on the plant's images: sum over k != 0 of |hold P| at w + k 2 pi/T.
  double image_bound(double w) const {
    const double T = timing_.sample_time_s, ws = 2 * kPi / T, m = device_.tip_mass_kg;
    const double lift = 2 * std::sin(std::min(0.5 * w * T, 0.5 * kPi));  // |1 - e^{-jwT}|
    double sum = 0;
    for (int k = 1; k <= 20; ++k) {
      for (const double v : {k * ws - w, k * ws + w}) {
        const double a = std::hypot(box_.high[kK1], v * box_.high[kB1]);
        const double held =
            a * (1 + a / (v * (box_.low[kB1] + box_.low[kB2])));  // |ac/(a + c)| <= |a| (1 + |a|/|a + c|)
        const double least = m * v * v - held;
        if (!(least > 0)) return Margins::kInfinity;
        sum += lift / (v * T) / least;
        if (k == 20) sum += lift / (T * least) * v * v * k / (2 * v * v * v);  // the rest falls as 1/k^3 at least
      }
    }
    return sum;
  }

  const LoopPlant& device_;
  const LoopTiming& timing_;
  const WallGains& gains_;
  const ArmBox& box_;
};

/// Pushes an arm within the box towards instability, one parameter at a time; returns the largest pole modulus reached.
double worsen(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains, const ArmBox& box,
              models::ArmParameters& arm) {
  auto values = models::to_array(arm);
  double worst = rho(device, timing, gains, arm);
  for (double step = 0.5; step > 0.02; step *= 0.5) {
    for (bool moved = true; moved;) {
      moved = false;
      for (std::size_t i = 0; i < 5; ++i) {
        for (const double sign : {1.0, -1.0}) {
          auto trial = values;
          trial[i] = std::clamp(values[i] + sign * step * (box.high[i] - box.low[i]), box.low[i], box.high[i]);
          const double r = rho(device, timing, gains, models::arm_from_array(trial));
          if (r > worst + 1e-13) worst = r, values = trial, moved = true;
        }
      }
    }
  }
  arm = models::arm_from_array(values);
  return worst;
}

}  // namespace

models::ArmParameters ArmBox::centre() const {
  std::array<double, 5> c{};
  for (std::size_t i = 0; i < 5; ++i) c[i] = 0.5 * (low[i] + high[i]);
  return models::arm_from_array(c);
}

ArmBox ArmBox::scaled(double factor) const {
  ArmBox box;
  for (std::size_t i = 0; i < 5; ++i) {
    const double middle = 0.5 * (low[i] + high[i]), half = 0.5 * (high[i] - low[i]) * factor;
    box.low[i] = std::max(middle - half, i <= kK1 ? 1e-6 * middle : 0.0);
    box.high[i] = middle + half;
  }
  return box;
}

models::ArmParameters ArmBox::vertex(unsigned number) const {
  std::array<double, 5> v{};
  for (std::size_t i = 0; i < 5; ++i) v[i] = (number >> i & 1U) != 0 ? high[i] : low[i];
  return models::arm_from_array(v);
}

ArmBox published_box(models::Axis axis, BoxSet set) {
  ArmBox box;
  for (std::size_t i = 0; i < 5; ++i) {
    const auto& s = models::parameter_statistics(axis, i);
    box.low[i] = set == BoxSet::extremes ? s.minimum : set == BoxSet::percent95 ? s.ci95_minimum : s.ci67_minimum;
    box.high[i] = set == BoxSet::extremes ? s.maximum : set == BoxSet::percent95 ? s.ci95_maximum : s.ci67_maximum;
  }
  return box;
}

BoxCertificate certify(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains, const ArmBox& box) {
  return Proof(device, timing, gains, box).run();
}

StructuredMu structured_mu(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains,
                           const ArmBox& box) {
  constexpr double kLargest = 64;
  StructuredMu mu;
  mu.centre_stable = rho(device, timing, gains, box.centre()) < 1;
  if (!mu.centre_stable) {
    mu.upper = mu.lower = Margins::kInfinity;
    mu.destabilising_arm = box.centre();
    return mu;
  }
  // an arm that destabilises: corners first, each by bisection along its ray, then the inside of a smaller box
  double found = kLargest;
  const auto unstable_on_ray = [&](const models::ArmParameters& arm) { return rho(device, timing, gains, arm) >= 1; };
  for (unsigned v = 0; v < 32; ++v) {
    if (!unstable_on_ray(box.scaled(found).vertex(v)) && !(found == kLargest)) continue;
    double low = 0, high = found;
    if (!unstable_on_ray(box.scaled(found).vertex(v))) {  // the ray may leave the unstable set again: look along it
      double inside = 0;
      for (double f = 0.25; f < found; f *= 1.3) {
        if (unstable_on_ray(box.scaled(f).vertex(v))) {
          inside = f;
          break;
        }
      }
      if (inside == 0) continue;
      high = inside;
    }
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (unstable_on_ray(box.scaled(middle).vertex(v)) ? high : low) = middle;
    }
    if (high <= found) found = high, mu.destabilising_arm = box.scaled(high).vertex(v);
  }
  for (int round = 0; round < 8; ++round) {
    const double smaller = 0.985 * found;
    const ArmBox inner = box.scaled(smaller);
    bool improved = false;
    for (unsigned v = 0; v < 32 && !improved; ++v) {
      auto arm = v == 0 && mu.destabilising_arm ? *mu.destabilising_arm : inner.vertex(v);
      auto values = models::to_array(arm);
      for (std::size_t i = 0; i < 5; ++i) values[i] = std::clamp(values[i], inner.low[i], inner.high[i]);
      arm = models::arm_from_array(values);
      if (worsen(device, timing, gains, inner, arm) >= 1) found = smaller, mu.destabilising_arm = arm, improved = true;
    }
    if (!improved) break;
  }
  mu.lower = mu.destabilising_arm ? 1 / found : 0.0;
  if (mu.destabilising_arm) {
    LoopPlant plant = device;
    plant.arm = mu.destabilising_arm;
    const auto poles = closed_loop_poles(sample_plant(plant, timing.sample_time_s), timing, gains);
    double largest = 0;
    for (int i = 0; i < poles.count; ++i) {
      const auto z = poles.z[static_cast<std::size_t>(i)];
      if (std::abs(z) > largest)
        largest = std::abs(z), mu.destabilising_frequency_rad_per_s = std::abs(std::arg(z)) / timing.sample_time_s;
    }
  }
  // the proof: the largest stretch that goes through
  double good = 0, bad = found;
  for (int i = 0; i < 14 && bad - good > 1e-3 * bad; ++i) {
    const double middle = i == 0 ? 0.98 * bad : 0.5 * (good + bad);
    (certify(device, timing, gains, box.scaled(middle)).certified ? good : bad) = middle;
  }
  mu.upper = good > 0 ? 1 / good : Margins::kInfinity;
  return mu;
}

bool mapping_theorem_certifies(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains,
                               const ArmBox& box) {
  if (!(rho(device, timing, gains, box.centre()) < 1)) return false;
  const double nyquist = kPi / timing.sample_time_s;
  constexpr int kPoints = 1500;
  for (int i = 0; i <= kPoints; ++i) {
    const double w = nyquist * std::pow(10.0, -4.0 * (1 - static_cast<double>(i) / kPoints));
    const Complex s(0, w), D = faced_stiffness(device, timing, gains, w);
    std::array<double, 32> angle{};
    for (unsigned v = 0; v < 32; ++v) {
      const auto arm = box.vertex(v);
      const Complex a = arm.k1_N_per_m + s * arm.b1_Ns_per_m,
                    c = (arm.mass_kg * s + arm.b2_Ns_per_m) * s + arm.k2_N_per_m;
      angle[v] = std::arg(a * c + D * (a + c));
    }
    // zero lies outside the hull where all values fit in an open half-plane
    std::sort(angle.begin(), angle.end());
    double gap = angle.front() + 2 * kPi - angle.back();
    for (std::size_t k = 1; k < angle.size(); ++k) gap = std::max(gap, angle[k] - angle[k - 1]);
    if (!(gap > kPi)) return false;
  }
  return true;
}

bool kharitonov_certifies(const LoopPlant& device, const LoopTiming& timing, const WallGains& gains,
                          const ArmBox& box) {
  using Poly = Polynomial<10>;
  const auto poly = [](std::initializer_list<double> lowest_first) {
    Poly p;
    for (const double c : lowest_first) p.c[static_cast<std::size_t>(p.degree++)] = c;
    --p.degree;
    return p;
  };
  const double tau = timing.sample_time_s * (0.5 + timing.delay_samples);
  const double lag = std::isinf(timing.cutoff_Hz) ? 0.0 : 1 / (2 * kPi * timing.cutoff_Hz);
  const Poly late = poly({1, tau / 2}), early = poly({1, -tau / 2}), filter = poly({1, lag});
  const Poly denominator = late * filter;
  const Poly wall = poly({gains.stiffness_N_per_m, gains.stiffness_N_per_m * lag + gains.damping_Ns_per_m});
  const Poly faced = poly({0, device.tip_damping_Ns_per_m, device.tip_mass_kg}) * denominator + early * wall;
  std::array<double, 7> low{}, high{};
  for (unsigned v = 0; v < 32; ++v) {
    const auto arm = box.vertex(v);
    const Poly a = poly({arm.k1_N_per_m, arm.b1_Ns_per_m}), c = poly({arm.k2_N_per_m, arm.b2_Ns_per_m, arm.mass_kg});
    const Poly p = denominator * a * c + faced * (a + c);
    for (std::size_t i = 0; i < 7; ++i) {
      low[i] = v == 0 ? p.c[i] : std::min(low[i], p.c[i]);
      high[i] = v == 0 ? p.c[i] : std::max(high[i], p.c[i]);
    }
  }
  int degree = 6;
  while (degree > 0 && high[static_cast<std::size_t>(degree)] == 0) --degree;
  // the four: signs of the coefficients go low low high high, and its turns
  for (const unsigned pattern : {0b1100U, 0b0011U, 0b0110U, 0b1001U}) {
    std::array<double, 7> c{};
    for (std::size_t i = 0; i <= static_cast<std::size_t>(degree); ++i)
      c[i] = (pattern >> (i % 4) & 1U) != 0 ? high[i] : low[i];
    for (int i = 0; i <= degree; ++i) {
      if (!(c[static_cast<std::size_t>(i)] > 0)) return false;
    }
    for (int top = degree; top >= 2; --top) {
      const double ratio = c[static_cast<std::size_t>(top)] / c[static_cast<std::size_t>(top - 1)];
      for (int i = top - 2; i >= 1; i -= 2)
        c[static_cast<std::size_t>(i)] -= ratio * c[static_cast<std::size_t>(i - 1)];
      if (!(c[static_cast<std::size_t>(top - 2)] > 0)) return false;
    }
  }
  return true;
}

}  // namespace handloop::control
