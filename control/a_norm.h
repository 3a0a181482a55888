#pragma once

#include "control/transfer_matrix.h"

/// The A-norm of Kazerooni and Her's (15): the gain of a linear system from peaks to peaks, which is the area under the
/// absolute value of its impulse response (Desoer and Vidyasagar 1975).
namespace handloop::control {

struct ANorm {
  double value = 0.0;        ///< integral of |g(t)| from 0 to infinity; infinite where a pole is not in the left half
  double error_bound = 0.0;  ///< of the value: what the tail and crossings nobody looked for could add
};

/// Of a rational transfer function with fewer zeros than poles. g(t) is a sum of exponentials; it is searched for
/// changes of sign on a grid that follows its fastest living mode and integrated between them in closed form, so the
/// value is exact to rounding but for the tail, which is bounded. Milliseconds. Throws InputError where the function is
/// not strictly proper.
ANorm a_norm(const TransferFunction& function);

}  // namespace handloop::control
