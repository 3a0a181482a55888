#include "device/fault.h"

#include <array>

namespace handloop::device {
namespace {

using enum FaultResponse;

constexpr std::array<FaultInfo, 25> kFaults{{
    {Fault::none, "none", "no fault", "", ramp_to_zero},
    {Fault::not_finite, "not_finite", "a position, force or command was not a finite number", "", zero_at_once},
    {Fault::no_reading, "no_reading", "no fresh sample for longer than the watchdog allows", "samples", ramp_to_zero},
    {Fault::encoder_jump, "encoder_jump", "the tip moved further in one sample than it can", "m", zero_at_once},
    {Fault::encoder_stuck, "encoder_stuck", "the sensed force changed while an encoder it must move did not", "N",
     ramp_to_zero},
    {Fault::encoder_disagrees, "encoder_disagrees",
     "the forces move a joint and its counter does not follow (0: it stopped, below: it counts backwards)", "",
     ramp_to_zero},
    {Fault::velocity, "velocity", "the tip moved faster than the limit", "m/s", ramp_to_zero},
    {Fault::acceleration, "acceleration", "the tip accelerated more than the limit", "m/s^2", ramp_to_zero},
    {Fault::workspace, "workspace", "the tip left the workspace", "m", ramp_to_zero},
    {Fault::energy, "energy", "the wall gave the hand more energy than it had received (passivity observer)", "J",
     ramp_to_zero},
    {Fault::sensor_saturated, "sensor_saturated", "an analog input stayed at the end of its range", "samples",
     ramp_to_zero},
    {Fault::sensor_dead, "sensor_dead", "an analog input stayed at one code although the tip moved", "samples",
     ramp_to_zero},
    {Fault::force_mismatch, "force_mismatch", "the sensed force is not the one the motors were asked for", "N",
     ramp_to_zero},
    {Fault::read_exception, "read_exception", "reading the device threw an exception", "", zero_at_once},
    {Fault::write_exception, "write_exception", "writing to the device threw an exception", "", zero_at_once},
    {Fault::write_failed, "write_failed", "the device did not take commands", "samples", zero_at_once},
    {Fault::controller_exception, "controller_exception", "the controller threw an exception", "", zero_at_once},
    {Fault::loop_stalled, "loop_stalled", "the loop was held up for longer than the watchdog allows", "samples",
     ramp_to_zero},
    {Fault::log_failed, "log_failed", "the log could not be written", "", ramp_to_zero},
    {Fault::external, "external", "stopped from outside", "", ramp_to_zero},
    {Fault::joint_position, "joint_position", "a joint left its permitted range", "rad", zero_at_once},
    {Fault::joint_velocity, "joint_velocity", "a joint turned faster than permitted", "rad/s", zero_at_once},
    {Fault::joint_acceleration, "joint_acceleration", "a joint accelerated more than permitted", "rad/s^2",
     zero_at_once},
    {Fault::contact_force, "contact_force", "the force at the hand or the environment is larger than permitted", "N",
     zero_at_once},
    {Fault::model_mismatch, "model_mismatch", "the joints do not move as torques and contact forces say they must",
     "Nm", zero_at_once},
}};

}  // namespace

std::span<const FaultInfo> fault_catalogue() {
  return kFaults;
}

const FaultInfo& fault_info(Fault fault) {
  return kFaults[static_cast<std::size_t>(fault)];
}

std::string_view fault_name(Fault fault) {
  return fault_info(fault).name;
}

}  // namespace handloop::device
