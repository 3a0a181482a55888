#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/commands.h"
#include "io/output.h"
#include "models/arm_uncertainty.h"

namespace handloop::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLowest_Hz = 0.6;
constexpr double kHighest_Hz = 30.0;
constexpr int kPoints = 200;

struct Options {
  std::string axis, set = "max", json;
};

struct Response {
  std::vector<double> frequency_Hz, magnitude_dB;
};

Response response(const models::UncertaintyModel& model) {
  Response r;
  for (int i = 0; i < kPoints; ++i) {
    const double f =
        i + 1 == kPoints ? kHighest_Hz : kLowest_Hz * std::pow(kHighest_Hz / kLowest_Hz, i / (kPoints - 1.0));
    r.frequency_Hz.push_back(f);
    r.magnitude_dB.push_back(20 * std::log10(std::abs(model({0, 2 * std::numbers::pi * f}))));
  }
  return r;
}

/// One row a conjugate pair: real part, imaginary part of either sign.
Json pairs(const std::vector<std::complex<double>>& roots) {
  Json list = Json::array();
  for (const auto& root : roots) list.push_back({root.real(), root.imag()});
  return list;
}

Json to_json(const models::UncertaintyModel& model) {
  const auto top = models::peak(model, kLowest_Hz, kHighest_Hz);
  return {{"gain", model.gain},
          {"zero_pairs", pairs(model.zeros)},
          {"pole_pairs", pairs(model.poles)},
          {"peak_dB", top.magnitude_dB},
          {"peak_frequency_Hz", top.frequency_Hz}};
}

void print(std::string_view title, const models::UncertaintyModel& model) {
  const auto top = models::peak(model, kLowest_Hz, kHighest_Hz);
  fmt::print("{}: peak {:.2f} dB at {:.2f} Hz (0.6-30 Hz)\n  gain {}\n", title, top.magnitude_dB, top.frequency_Hz,
             model.gain);
  for (const auto& z : model.zeros) fmt::print("  zeros {:>9.4g} +- {:.4g}j rad/s\n", z.real(), z.imag());
  for (const auto& p : model.poles) fmt::print("  poles {:>9.4g} +- {:.4g}j rad/s\n", p.real(), p.imag());
}

void run(const Options& options) {
  const auto axis = models::parse_axis(options.axis);
  const auto set = models::parse_uncertainty_set(options.set);
  const auto& used = models::uncertainty(axis, set);
  const auto& printed = models::uncertainty_as_printed(axis, set);
  if (!options.json.empty()) {
    const auto r = response(used);
    const auto top = models::peak(used, kLowest_Hz, kHighest_Hz);
    const Json json{{"axis", axis_name(axis)},
                    {"set", uncertainty_set_name(set)},
                    {"source", "Fu and Cavusoglu, Table IV"},
                    {"frequency_Hz", r.frequency_Hz},
                    {"magnitude_dB", r.magnitude_dB},
                    {"peak_dB", top.magnitude_dB},
                    {"peak_frequency_Hz", top.frequency_Hz},
                    {"corrected", models::is_corrected(axis, set)},
                    {"table_as_printed", to_json(printed)},
                    {"table_as_corrected", to_json(used)}};
    io::write_file_atomically(options.json, json.dump(2) + "\n");
    if (options.json == "-") return;
  }
  print(fmt::format("|W_u| axis {}, {}", axis_name(axis),
                    set == models::UncertaintySet::maximum ? "every subject and grip force" : "67th percentile"),
        used);
  if (models::is_corrected(axis, set)) {
    fmt::print(
        "\nCorrected: Table IV prints pole pair 5 as -8.002 +- 5.687j; with it the peak breaks the paper's own 0 "
        "dB:\n");
    print("as printed", printed);
  }
}

}  // namespace

void add_uncertainty_command(CLI::App& program) {
  auto* command = program.add_subcommand("uncertainty", "Unstructured variability |W_u| of the arm (Table IV)");
  const auto options = std::make_shared<Options>();
  command->add_option("--axis", options->axis, "x left-right, y up-down, z forward-backward")->required();
  command->add_option("--set", options->set, "max (every subject) or 67 (67th percentile)")->capture_default_str();
  command->add_option("--json", options->json, "write as JSON to a file, or - for the terminal");
  command->footer("Example: handloop uncertainty --axis z --set 67 --json -");
  command->callback([options] { run(*options); });
}

}  // namespace handloop::cli
