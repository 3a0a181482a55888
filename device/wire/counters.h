#pragma once

#include <array>
#include <cstdint>

#include "device/wire/packet.h"

namespace handloop::device::wire {

/// What came over the wire and what became of it. Kept by both ends.
struct Counters {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;                         ///< datagrams of any kind
  std::array<std::uint64_t, kVerdicts> by_verdict{};  ///< of decode()
  std::uint64_t wrong_session = 0;                    ///< another session's, or a stranger's
  std::uint64_t doubled = 0;                          ///< a sample that was already had
  std::uint64_t reordered = 0;                        ///< older than one already had
  std::uint64_t ahead = 0;                            ///< of a sample that is yet to come: impossible
  std::uint64_t lost = 0;                             ///< samples that never came
  std::uint64_t sent_again = 0;                       ///< lock-step: no answer in time
  std::uint64_t silences = 0;                         ///< plant: DACs zeroed because the controller fell silent

  std::uint64_t refused() const {
    std::uint64_t sum = wrong_session + ahead;
    for (std::size_t i = 1; i < by_verdict.size(); ++i) sum += by_verdict[i];
    return sum;
  }
};

}  // namespace handloop::device::wire
