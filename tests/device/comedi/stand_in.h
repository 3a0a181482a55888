#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

/// A libcomedi of our own, linked in the place of the real one: three boards with the subdevices, channels, ranges and
/// refusals of the drivers ni_660x, ni_pcimio (pci-6031e) and cb_pcidda (pci-dda08/12). Registers lie in shared memory,
/// so that what a forked process writes is seen.
///   /dev/comedi0  NI PCI-6602: 0 unused, 1 DIO of 40, 2 to 9 counters of 3 channels, 32 bits; set_other_source fails
///   /dev/comedi1  NI PCI-6031E: 0 AI of 64 channels, 16 bits, 14 ranges; 1 AO of 2 channels
///   /dev/comedi2  MCC PCI-DDA08/12: 0 AO of 8 channels, 12 bits, 6 ranges; 1 and 2 DIO of 24
namespace handloop::comedi_stand_in {

struct Registers {
  std::array<std::atomic<std::uint32_t>, 10> counters;  ///< by subdevice of board 0
  std::array<std::atomic<std::uint32_t>, 10> modes;     ///< of the counters
  std::array<std::atomic<bool>, 10> armed;
  std::array<std::atomic<std::uint32_t>, 64> adc;
  std::array<std::atomic<std::uint32_t>, 64> adc_specs;  ///< channel, range and reference last read with
  std::array<std::atomic<std::uint32_t>, 8> dac;
  std::array<std::atomic<std::uint32_t>, 8> dac_specs;
  std::atomic<std::uint64_t> writes;
  // Failures to come.
  std::atomic<bool> no_board[3];
  std::atomic<bool> counter_read_fails, adc_read_fails, dac_write_fails, arm_fails, reset_fails;
  std::atomic<int> dac_writes_failing;  ///< so many next single writes fail
  std::atomic<bool> partial_list;       ///< instruction lists stop after one
  std::atomic<bool> counters_missing;   ///< board 0 is one without counters
};

Registers& registers();
/// As after power-up: counters at 0, DACs wherever they were left, no failures.
void power_up();

}  // namespace handloop::comedi_stand_in
