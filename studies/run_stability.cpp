#include "studies/run_stability.h"

#include <fmt/format.h>

#include <cmath>

namespace handloop::studies {
namespace {

constexpr double kClippedShare = 0.01;
constexpr double kChatter_Hz = 10.0;
constexpr double kChatterShaken_Hz = 40.0;
constexpr double kGrowth = 1.5;
constexpr double kSpeed_m_per_s = 5e-3;

}  // namespace

StabilityJudge::StabilityJudge(std::uint64_t steps, double sample_time_s, bool hand_shakes)
    : steps_(steps), sample_time_s_(sample_time_s), chatter_limit_Hz_(hand_shakes ? kChatterShaken_Hz : kChatter_Hz) {}

void StabilityJudge::add(const device::StepRecord& record) {
  if (fault_ == device::Fault::none) fault_ = record.fault;
  const std::uint64_t k = count_++;
  const double speed2 = record.velocity_m_per_s.squaredNorm();
  if (4 * k >= steps_ && 2 * k < steps_) {
    second_quarter_ += speed2;
    ++second_count_;
  }
  if (4 * k >= 3 * steps_) {
    last_quarter_ += speed2;
    ++last_count_;
  }
  if (2 * k >= steps_) {
    ++late_;
    clipped_ += record.clipped;
    contacts_ += record.in_contact && !in_contact_;
  }
  in_contact_ = record.in_contact;
}

std::string StabilityJudge::verdict() const {
  if (fault_ != device::Fault::none) return fmt::format("a fault ended it ({})", device::fault_name(fault_));
  if (late_ == 0) return "";
  const double clipped = static_cast<double>(clipped_) / static_cast<double>(late_);
  if (clipped > kClippedShare) {
    return fmt::format("the force was at its limit in {:.0f} % of the second half", 100.0 * clipped);
  }
  const double chatter_Hz = static_cast<double>(contacts_) / (static_cast<double>(late_) * sample_time_s_);
  if (chatter_Hz > chatter_limit_Hz_) return fmt::format("the tip met the wall {:.0f} times a second", chatter_Hz);
  if (second_count_ > 0 && last_count_ > 0) {
    const double before = std::sqrt(second_quarter_ / static_cast<double>(second_count_));
    const double after = std::sqrt(last_quarter_ / static_cast<double>(last_count_));
    if (after > kSpeed_m_per_s && after > kGrowth * before) {
      return fmt::format("the tip's speed was still growing ({:.3g} to {:.3g} m/s rms)", before, after);
    }
  }
  return "";
}

}  // namespace handloop::studies
