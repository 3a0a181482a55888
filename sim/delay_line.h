#pragma once

#include <cstddef>
#include <vector>

namespace handloop::sim {

/// Position and velocity of the past, remembered at every step, for effects that feel them late.
class DelayLine {
 public:
  struct Motion {
    double x_m = 0.0;
    double v_m_per_s = 0.0;
  };

  DelayLine() = default;
  /// Remembers at least delay_s at one entry each step_s. Allocates; nothing else here does.
  DelayLine(double delay_s, double step_s);

  void reset();
  /// Motion at a step's beginning; times must rise by step_s.
  void push(double t_s, const Motion& motion);
  /// Motion delay_s before t_s, by cubic interpolation of position and its derivative; before the first entry the place
  /// was at rest where it began. Within the present step (a delay shorter than it) the motion `now` at t_s bounds the
  /// cubic.
  Motion at_delay(double t_s, const Motion& now) const;

  double delay_s() const { return delay_s_; }

 private:
  const Motion& entry(std::size_t steps_ago) const;

  double delay_s_ = 0.0;
  double step_s_ = 1.0;
  double newest_t_s_ = 0.0;
  std::size_t newest_ = 0;
  std::size_t count_ = 0;
  std::vector<Motion> ring_;
};

}  // namespace handloop::sim
