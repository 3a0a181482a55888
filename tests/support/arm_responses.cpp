#include "tests/support/arm_responses.h"

#include <complex>
#include <numbers>

#include "models/arm.h"
#include "tests/support/arm_recording.h"

namespace handloop::test {

std::vector<identify::FrequencyResponse> arms_as_responses(int axis, std::size_t count, std::uint64_t seed) {
  std::vector<identify::FrequencyResponse> responses;
  for (const auto& arm : random_arms(axis, count, seed)) {
    identify::FrequencyResponse r;
    for (int n = 1; n <= 57; ++n) {
      const std::complex<double> s(0, 2 * std::numbers::pi * n / 1.914);
      r.frequency_Hz.push_back(n / 1.914);
      r.response.push_back(models::compliance(models::arm_from_array(arm), s));
      r.coherence.push_back(0.9);
      r.variance.push_back(1e-10);
    }
    responses.push_back(std::move(r));
  }
  return responses;
}

}  // namespace handloop::test
