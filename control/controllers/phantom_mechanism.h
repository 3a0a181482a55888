#pragma once

#include <memory>

#include "control/controllers/mechanism.h"
#include "models/phantom.h"
#include "models/scenario.h"

namespace handloop::control {

/// The Phantom as its controller knows it: lengths as built, masses of the nominal set whatever the plant really has,
/// the stylus at the tip (balanced on joint 2 where the maker's counterweight is fitted).
class PhantomMechanism final : public Mechanism {
 public:
  PhantomMechanism(const models::PhantomParameters& lengths, const models::PhantomParameters& masses,
                   bool counterbalanced);
  MechanismState at(const Eigen::Vector3d& joint_rad) const noexcept override;
  /// Gravity in the worst pose and 10 %.
  Eigen::Vector3d feedforward_bound_Nm() const noexcept override { return bound_; }
  JointRange joint_range() const noexcept override;

 private:
  models::PhantomParameters lengths_, masses_;
  bool counterbalanced_;
  Eigen::Vector3d bound_;
};

/// The mechanism of a scenario's device. Throws InputError for a device that has none.
std::unique_ptr<Mechanism> make_mechanism(const models::DeviceSettings& device);

}  // namespace handloop::control
