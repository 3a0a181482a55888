#pragma once

#include <cstdint>
#include <span>
#include <string_view>

/// Why a loop stopped pushing. A fault is latched: the first one stays until the loop is reset by hand.
namespace handloop::device {

enum class Fault : std::uint8_t {
  none,
  not_finite,
  no_reading,
  encoder_jump,
  encoder_stuck,
  encoder_disagrees,
  velocity,
  acceleration,
  workspace,
  energy,
  sensor_saturated,
  sensor_dead,
  force_mismatch,
  read_exception,
  write_exception,
  write_failed,
  controller_exception,
  loop_stalled,
  log_failed,
  external,
  joint_position,
  joint_velocity,
  joint_acceleration,
  contact_force,
  model_mismatch
};

/// How the force ends: at once, or by a linear ramp of the DAC codes where what is known may still be trusted for a
/// moment.
enum class FaultResponse : std::uint8_t { zero_at_once, ramp_to_zero };

struct FaultInfo {
  Fault fault;
  std::string_view name;     ///< as in log.csv and summary.json
  std::string_view meaning;  ///< one line for a person
  std::string_view unit;     ///< of value and limit in FaultEvent; "" where it has none
  FaultResponse response;
};

/// Every fault there is, in the order of the enumeration.
std::span<const FaultInfo> fault_catalogue();
const FaultInfo& fault_info(Fault fault);
std::string_view fault_name(Fault fault);

/// A fault with its numbers.
struct FaultEvent {
  Fault fault = Fault::none;
  std::uint64_t sample = 0;
  std::int64_t time_ns = 0;
  double value = 0.0;  ///< what was measured
  double limit = 0.0;  ///< what is allowed
};

/// A fault as a check finds it; the loop adds sample and time.
inline FaultEvent found(Fault fault, double value, double limit) noexcept {
  return {fault, 0, 0, value, limit};
}

}  // namespace handloop::device
