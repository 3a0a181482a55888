#include "ui/app/description.h"

#include <array>
#include <nlohmann/json.hpp>

#include "io/json.h"
#include "ui/state/verdict.h"

namespace handloop::ui {

std::string description_of(const Bench& bench, const Landmarks& landmarks) {
  using Json = nlohmann::ordered_json;
  constexpr std::array kViews{"tune", "arms", "subject", "data", "traces", "device"};
  const auto& scenario = bench.editor.scenario();
  Json json;
  json["view"] = kViews[static_cast<std::size_t>(bench.view)];
  json["axis"] = models::axis_name(scenario.wall.axis);
  json["stiffness_N_per_m"] = scenario.loop.stiffness_N_per_m;
  json["damping_Ns_per_m"] = scenario.loop.damping_Ns_per_m;
  json["delay_samples"] = scenario.loop.delay_samples;
  json["arm"] = bench.editor.arm_source();
  json["effects"] = Json::array();
  for (const auto& [axis, effect] : scenario.arm.effects) json["effects"].push_back(effect->info().name);
  json["changed"] = bench.editor.changed();
  json["path"] = bench.editor.path().string();
  json["message"] = bench.message;
  if (const auto& nominal = bench.tuning.nominal()) {
    const auto verdict = verdict_of(*nominal, bench.tuning.population());
    json["verdict"] = verdict.word;
    json["sentence"] = verdict.sentence;
    json["disk_margin"] = io::json_number(nominal->margins.disk_alpha);
  }
  if (const auto& robust = bench.tuning.robust()) {
    json["critical_stiffness_N_per_m"] = io::json_number(robust->critical_stiffness_N_per_m);
    json["map"] = {{"stiffness_high", robust->window.stiffness_high}, {"damping_high", robust->window.damping_high}};
  }
  json["computing"] = bench.tuning.busy();
  json["device"] = bench.session.device_address();
  json["running"] = bench.session.running();
  json["paused"] = bench.session.paused();
  json["armed"] = bench.session.arming().armed();
  json["fault"] = device::fault_name(bench.session.status().fault.fault);
  json["landmarks"] = Json::object();
  for (const auto& entry : landmarks.entries()) {
    Json place = {{"x", 0.5 * static_cast<double>(entry.low.x + entry.high.x)},
                  {"y", 0.5 * static_cast<double>(entry.low.y + entry.high.y)},
                  {"width", entry.high.x - entry.low.x},
                  {"height", entry.high.y - entry.low.y}};
    if (!entry.text.empty()) place["text"] = entry.text;
    json["landmarks"][entry.name] = std::move(place);
  }
  return json.dump(1) + "\n";
}

}  // namespace handloop::ui
