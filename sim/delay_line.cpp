#include "sim/delay_line.h"

#include <algorithm>
#include <cmath>

namespace handloop::sim {
namespace {

/// Cubic Hermite interpolation over an interval of length h, u = 0 at its left end and 1 at its right.
DelayLine::Motion hermite(const DelayLine::Motion& left, const DelayLine::Motion& right, double h, double u) {
  const double u2 = u * u, u3 = u2 * u;
  const double x = (2 * u3 - 3 * u2 + 1) * left.x_m + (u3 - 2 * u2 + u) * h * left.v_m_per_s +
                   (3 * u2 - 2 * u3) * right.x_m + (u3 - u2) * h * right.v_m_per_s;
  const double v = (6 * u2 - 6 * u) / h * (left.x_m - right.x_m) + (3 * u2 - 4 * u + 1) * left.v_m_per_s +
                   (3 * u2 - 2 * u) * right.v_m_per_s;
  return {x, v};
}

}  // namespace

DelayLine::DelayLine(double delay_s, double step_s)
    : delay_s_(delay_s), step_s_(step_s), ring_(static_cast<std::size_t>(std::ceil(delay_s / step_s)) + 4) {}

void DelayLine::reset() {
  count_ = 0;
}

void DelayLine::push(double t_s, const Motion& motion) {
  newest_ = count_ == 0 ? 0 : (newest_ + 1) % ring_.size();
  ring_[newest_] = motion;
  newest_t_s_ = t_s;
  count_ = std::min(count_ + 1, ring_.size());
}

const DelayLine::Motion& DelayLine::entry(std::size_t steps_ago) const {
  return ring_[(newest_ + ring_.size() - steps_ago) % ring_.size()];
}

DelayLine::Motion DelayLine::at_delay(double t_s, const Motion& now) const {
  if (delay_s_ <= 0 || count_ == 0) return now;
  const double age = newest_t_s_ - (t_s - delay_s_);  // before the newest entry
  if (age < 0) {
    const double span = t_s - newest_t_s_;
    return hermite(entry(0), now, span, -age / span);
  }
  const double steps = age / step_s_;
  const auto younger = static_cast<std::size_t>(steps);
  if (younger + 1 >= count_) return {entry(count_ - 1).x_m, 0.0};
  return hermite(entry(younger + 1), entry(younger), step_s_, 1.0 - (steps - static_cast<double>(younger)));
}

}  // namespace handloop::sim
