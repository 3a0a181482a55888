#pragma once

#include <string>

#include "ui/views/bench.h"

namespace handloop::ui {

/// Which device the loop runs on, arming real ones, and the evidence of a fault.
class DeviceView {
 public:
  void show(Bench& bench);

 private:
  void choice(Bench& bench);
  void arming(Bench& bench);
  void figures(const Bench& bench);
  void evidence(Bench& bench);

  int kind_ = 0;
  std::string udp_ = "127.0.0.1:5555", comedi_ = "scenes/phantom_rig.toml", replay_;
  std::string evidence_file_ = "fault.csv";
};

}  // namespace handloop::ui
