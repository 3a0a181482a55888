#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "io/json.h"
#include "models/effects/effect.h"

namespace handloop::cli {
namespace {

nlohmann::ordered_json to_json(const models::EffectInfo& info) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array(), places = nlohmann::ordered_json::array();
  for (const auto& p : info.parameters) {
    parameters.push_back({{"name", p.name},
                          {"unit", p.unit},
                          {"lower", io::json_number(p.lower)},
                          {"upper", io::json_number(p.upper)},
                          {"typical", io::json_number(p.typical)},
                          {"meaning", p.meaning}});
  }
  for (const auto place : info.places) places.push_back(models::place_name(place));
  return {{"name", info.name},
          {"title", info.title},
          {"equation", info.equation},
          {"source", info.source},
          {"fingerprint", info.fingerprint},
          {"experiment", info.experiment},
          {"acts_on", places},
          {"parameters", parameters}};
}

void print(const models::EffectInfo& info) {
  fmt::print("{} ({})\n  {}\n  acts on:", info.name, info.title, info.equation);
  for (const auto place : info.places) fmt::print(" {}", models::place_name(place));
  fmt::print("\n");
  constexpr std::size_t kMost = 8;  // the table's knots are all alike
  for (std::size_t i = 0; i < std::min(info.parameters.size(), kMost); ++i) {
    const auto& p = info.parameters[i];
    fmt::print("  {:<28} {:>9} {:<10} {:g} to {:g}: {}\n", p.name, fmt::format("{:g}", p.typical), p.unit, p.lower,
               p.upper, p.meaning);
  }
  if (info.parameters.size() > kMost) fmt::print("  ... and {} more of the kind\n", info.parameters.size() - kMost);
}

}  // namespace

void add_effects_command(CLI::App& program) {
  auto json = std::make_shared<std::string>();
  auto* command =
      program.add_subcommand("effects", "The catalogue of effects: equations, parameters, units and bounds");
  command->add_option("--json", *json, "File for the machine form, - for standard output");
  command->footer("Example: handloop effects --json -");
  command->callback([json] {
    if (json->empty()) {
      for (const auto& type : models::effect_catalogue()) print(type.info);
      return;
    }
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const auto& type : models::effect_catalogue()) list.push_back(to_json(type.info));
    io::write_json({{"effects", list}}, *json);
  });
}

}  // namespace handloop::cli
