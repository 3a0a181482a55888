#include "models/seven_bar_arm.h"

namespace handloop::models {

NeuralArm neural_arm(SevenBarHand hand) {
  NeuralArm arm;
  switch (hand) {
    case SevenBarHand::printed:
      break;
    case SevenBarHand::tight:
      // G_p fitted so that H follows H_0 (relative least squares, 0.1 to 100 rad/s) with a fifth of the force fed back.
      arm.mass_kg = 4.1267;
      arm.damping_Ns_per_m = 33.2224;
      arm.stiffness_N_per_m = 202.828;
      arm.feedback_gain_rad_per_s = 0.4;
      break;
    case SevenBarHand::loose:
      // Relaxed muscles and feedback of three times the force: 25 N/m at rest instead of 169.
      arm.damping_Ns_per_m = 20.0;
      arm.stiffness_N_per_m = 100.0;
      arm.feedback_gain_rad_per_s = 6.0;
      break;
  }
  return arm;
}

std::string_view hand_name(SevenBarHand hand) {
  switch (hand) {
    case SevenBarHand::tight:
      return "tight";
    case SevenBarHand::loose:
      return "loose";
    default:
      return "printed";
  }
}

}  // namespace handloop::models
