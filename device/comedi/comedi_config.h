#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "device/device.h"

namespace handloop::device::comedi {

/// How boards are wired to a device; docs/hardware.md describes the file key by key.
struct ComediConfig {
  struct Encoders {
    std::string board = "/dev/comedi0";  ///< NI PCI-6602: each counter is a subdevice
    std::vector<int> subdevices{2, 3, 4};
    int counts_per_rev = 4096;  ///< edges in quadrature X4
    std::array<int, kMaxMotors> signs{1, 1, 1};
    bool index_pulse = false;  ///< Z resets the count
    int filter = 5;            ///< NI_GPCT_FILTER_*: 5 is twice timebase 1 (100 ns), 0 off
  } encoders;

  struct Motors {
    std::string board = "/dev/comedi2";  ///< MCC PCI-DDA08/12: one AO subdevice of 8 channels
    int subdevice = 0;
    std::vector<int> channels{0, 1, 2};
    double range_V = 10.0;  ///< bipolar
    std::array<int, kMaxMotors> signs{1, -1, -1};
    double amplifier_A_per_V = 0.3;
    double current_limit_A = 3.0;
    double torque_Nm_per_A = 0.0234;
    std::array<double, kMaxMotors> transmission_ratio{13.3, 11.2, 11.2};
  } motors;

  struct Force {
    bool present = true;
    std::string board = "/dev/comedi1";  ///< NI PCI-6031E: AI subdevice of 64 channels
    int subdevice = 0;
    std::vector<int> channels{0, 1, 2, 3};  ///< force x, y, z, then grip; or the gauges, then grip
    double range_V = 10.0;                  ///< bipolar
    bool differential = true;
    std::vector<double> N_per_V{1.7, 1.7, 1.7, 1.7};  ///< for each channel, sign included
    std::vector<std::vector<double>> gauge_N_per_V;   ///< three rows; empty where the channels are the axes
  } force;

  double watchdog_s = 0.02;  ///< of no command, after which the guardian zeroes the DACs
};

/// Reads the wiring. Throws InputError naming file, line and key: unknown keys, wrong kinds or lengths, values that
/// cannot be.
ComediConfig read_comedi_config(const std::filesystem::path& path);
ComediConfig parse_comedi_config(std::string_view text, const std::string& name);

/// Scales that follow from the wiring; the converters' bits come from the boards.
DeviceDescription describe(const ComediConfig& config, const std::array<double, 3>& pose_rad, double sample_time_s,
                           unsigned dac_maxdata, unsigned adc_maxdata);

}  // namespace handloop::device::comedi
