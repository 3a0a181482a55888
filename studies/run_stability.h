#pragma once

#include <string>

#include "device/record.h"

namespace handloop::studies {

/// Judges from the samples of a run whether the loop was stable, in constant memory. A run is unstable where
/// - a fault ended it,
/// - in its second half the envelope had to clip the force in more than 1 % of the samples (a limit cycle at the
/// limit),
/// - in its second half the tip left and met the wall more than 10 times a second (chatter; 40 where the hand shakes),
/// - the tip's speed still grew: its rms in the last quarter over 1.5 times that of the second, and over 5 mm/s.
class StabilityJudge {
 public:
  StabilityJudge(std::uint64_t steps, double sample_time_s, bool hand_shakes);
  void add(const device::StepRecord& record);
  /// "" where stable, else the reason.
  std::string verdict() const;

 private:
  std::uint64_t steps_;
  double sample_time_s_;
  double chatter_limit_Hz_;
  std::uint64_t count_ = 0;
  std::uint64_t late_ = 0, clipped_ = 0, contacts_ = 0;
  bool in_contact_ = false;
  double second_quarter_ = 0.0, last_quarter_ = 0.0;  ///< sums of squared speed
  std::uint64_t second_count_ = 0, last_count_ = 0;
  device::Fault fault_ = device::Fault::none;
};

}  // namespace handloop::studies
