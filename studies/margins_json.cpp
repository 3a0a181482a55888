#include "studies/margins_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace handloop::studies {

using nlohmann::ordered_json;

ordered_json to_json(const control::Margins& m) {
  ordered_json j;
  j["stable"] = m.stable;
  j["rho"] = json_number(m.rho);
  const auto margin = [&](const char* key, double value, double at) {
    j[key] = json_number(value);
    j[std::string("w_") + key] = json_number(at);
  };
  margin("gm_up", m.gain_up, m.gain_up_at_rad_per_s);
  margin("gm_down", m.gain_down, m.gain_down_at_rad_per_s);
  margin("pm_deg", m.phase_deg, m.phase_at_rad_per_s);
  margin("dm_s", m.delay_s, m.delay_at_rad_per_s);
  margin("sm", m.modulus, m.modulus_at_rad_per_s);
  margin("disk_alpha", m.disk_alpha, m.disk_at_rad_per_s);
  if (m.stable) {
    const auto disk = control::disk_guarantee(m.disk_alpha);
    j["disk_gain"] = {json_number(disk.gain_low), json_number(disk.gain_high)};
    j["disk_phase_deg"] = json_number(disk.phase_deg);
  } else {
    j["disk_gain"] = nullptr;
    j["disk_phase_deg"] = nullptr;
  }
  return j;
}

ordered_json to_json(const control::TransferMargins& result) {
  ordered_json j = to_json(result.margins);
  if (!std::isnan(result.abscissa)) j["abscissa_rad_per_s"] = json_number(result.abscissa);
  j["poles"] = ordered_json::array();
  for (const auto& p : result.poles) j["poles"].push_back({json_number(p.real()), json_number(p.imag())});
  return j;
}

}  // namespace handloop::studies
