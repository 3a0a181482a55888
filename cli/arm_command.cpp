#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/commands.h"
#include "cli/progress_bar.h"
#include "io/model_file.h"
#include "io/output.h"
#include "models/arm_tables.h"
#include "models/errors.h"
#include "studies/arm_bode.h"
#include "studies/arm_sampling.h"

namespace handloop::cli {
namespace {

using Json = nlohmann::ordered_json;
using models::kArmParameterNames;

Json to_json(const Eigen::VectorXcd& roots) {
  Json list = Json::array();
  for (const auto& root : roots) list.push_back({root.real(), root.imag()});
  return list;
}

// ---- arm show -------------------------------------------------------------------------------------------------------

struct ShowOptions {
  std::string axis, grip = "nominal", literature, json, model;
};

/// One published arm: where it stands and its values.
struct ShownArm {
  std::string source, title;
  models::AxisModel model;
};

ShownArm find_arm(const ShowOptions& options) {
  if (!options.literature.empty()) {
    const auto& row = models::find_literature_arm(options.literature);
    ShownArm shown{fmt::format("Fu and Cavusoglu, Table V: {}", row.source),
                   fmt::format("{} ({} grip)", row.name, row.grasp), row.model()};
    if (!options.axis.empty()) shown.model.axis = models::parse_axis(options.axis);
    return shown;
  }
  if (options.axis.empty()) throw InputError("arm show: give --axis x, y or z (or --literature NAME)");
  const auto axis = models::parse_axis(options.axis);
  const auto grip = models::parse_grip(options.grip);
  ShownArm shown;
  const bool nominal = grip == models::Grip::nominal;
  shown.source = nominal ? "Fu and Cavusoglu, Table II" : "Fu and Cavusoglu, Table I";
  shown.title = fmt::format("axis {}, {}", axis_name(axis), nominal ? "nominal" : "grip force " + options.grip + " N");
  shown.model.axis = axis;
  shown.model.arm = published_arm(axis, grip);
  return shown;
}

Json to_json(const ShownArm& shown) {
  Json json{{"axis", axis_name(shown.model.axis)}, {"source", shown.source}};
  if (shown.model.base == models::BaseModel::msd) {
    const auto& msd = shown.model.msd;
    json["base"] = "msd";
    json["mass_kg"] = msd.mass_kg;
    json["b_Ns_per_m"] = msd.b_Ns_per_m;
    json["k_N_per_m"] = msd.k_N_per_m;
    return json;
  }
  json["base"] = "arm5";
  const auto values = to_array(shown.model.arm);
  for (std::size_t i = 0; i < values.size(); ++i) json[std::string(kArmParameterNames[i])] = values[i];
  json["poles"] = to_json(compliance_poles(shown.model.arm));
  json["zeros"] = to_json(compliance_zeros(shown.model.arm));
  return json;
}

void print_roots(std::string_view name, const Eigen::VectorXcd& roots) {
  fmt::print("  {:<14}", name);
  for (const auto& root : roots) {
    if (root.imag() == 0) {
      fmt::print(" {:.4g}", root.real());
    } else if (root.imag() > 0) {
      fmt::print(" {:.4g}+-{:.4g}j ({:.3g} Hz, damping {:.2g})", root.real(), root.imag(),
                 std::abs(root) / (2 * std::numbers::pi), -root.real() / std::abs(root));
    }
  }
  fmt::print(" rad/s\n");
}

void print(const ShownArm& shown) {
  fmt::print("{} ({})\n", shown.title, shown.source);
  if (shown.model.base == models::BaseModel::msd) {
    const auto& msd = shown.model.msd;
    fmt::print(
        "  mass_kg        {}\n  b_Ns_per_m     {}\n  k_N_per_m      {}\n  the hand is rigid with the device: no k1, "
        "b1\n",
        msd.mass_kg, msd.b_Ns_per_m, msd.k_N_per_m);
    return;
  }
  const auto values = to_array(shown.model.arm);
  for (std::size_t i = 0; i < values.size(); ++i) fmt::print("  {:<14} {}\n", kArmParameterNames[i], values[i]);
  print_roots("poles", compliance_poles(shown.model.arm));
  print_roots("zeros", compliance_zeros(shown.model.arm));
}

void show(const ShowOptions& options) {
  const auto shown = find_arm(options);
  if (!options.model.empty()) io::write_model(options.model, shown.model);
  if (!options.json.empty()) io::write_file_atomically(options.json, to_json(shown).dump(2) + "\n");
  if (options.json != "-" && options.model != "-") print(shown);
}

void add_show(CLI::App* arm) {
  auto* command = arm->add_subcommand("show", "Parameters, poles and zeros of a published arm (Tables I, II and V)");
  const auto options = std::make_shared<ShowOptions>();
  command->add_option("--axis", options->axis, "x left-right, y up-down, z forward-backward");
  command->add_option("--grip", options->grip, "1, 2 or 3 (N, Table I) or nominal (Table II)")->capture_default_str();
  std::string names;
  for (const auto& row : models::literature_arms()) names += fmt::format("{}{}", names.empty() ? "" : ", ", row.name);
  command->add_option("--literature", options->literature, "an arm of Table V instead: " + names);
  command->add_option("--json", options->json, "write as JSON to a file, or - for the terminal");
  command->add_option("--model", options->model, "write as a model file for --arm");
  command->footer("Example: handloop arm show --axis z --grip 2");
  command->callback([options] { show(*options); });
}

// ---- arm sample -----------------------------------------------------------------------------------------------------

struct PopulationOptions {
  std::string axis, percentiles = "ecdf", correlation;
  std::uint64_t seed = 1;

  models::ArmPopulation population() const {
    std::optional<models::ArmCorrelation> matrix;
    if (!correlation.empty()) matrix = studies::read_correlation(correlation);
    return models::ArmPopulation(models::parse_axis(axis), models::parse_percentile_reading(percentiles), matrix);
  }
};

void add_population_options(CLI::App* command, PopulationOptions* options) {
  command->add_option("--seed", options->seed, "the same seed gives the same arms")->capture_default_str();
  command
      ->add_option("--percentiles", options->percentiles,
                   "how Table III's CI ends are read: ecdf (5, 33, 67, 95 %) or central (2.5, 16.5, 83.5, 97.5 %)")
      ->capture_default_str();
  command->add_option("--correlation", options->correlation,
                      "5 x 5 correlation matrix of the normal scores of M, k1, k2, b1, b2 (CSV file)");
}

struct SampleOptions : PopulationOptions {
  std::size_t count = 0;
  std::string out, json;
};

Json to_json(const models::ParameterStatistics& s) {
  return {{"minimum", s.minimum},           {"mean", s.mean},
          {"maximum", s.maximum},           {"standard_deviation", s.standard_deviation},
          {"ci95_minimum", s.ci95_minimum}, {"ci95_maximum", s.ci95_maximum},
          {"ci67_minimum", s.ci67_minimum}, {"ci67_maximum", s.ci67_maximum}};
}

Json to_json(const studies::SampleSummary& summary, const SampleOptions& options, const std::string& assumptions) {
  Json json{{"axis", options.axis}, {"count", options.count}, {"seed", options.seed}, {"assumptions", assumptions}};
  for (std::size_t j = 0; j < summary.size(); ++j) {
    const auto& s = summary[j];
    json["parameters"][std::string(kArmParameterNames[j])] = {{"sample", to_json(s.sample)},
                                                              {"table", to_json(s.table)},
                                                              {"worst_statistic", s.worst_statistic},
                                                              {"worst_deviation", s.worst_deviation},
                                                              {"feasible", s.feasible},
                                                              {"distribution_distance", s.distribution_distance},
                                                              {"gap_at_a_percentile", s.gap}};
  }
  return json;
}

void print(const studies::SampleSummary& summary, const SampleOptions& options, const std::string& assumptions) {
  fmt::print("{} arms of axis {}, seed {}: {}\n{}\n\n", options.count, options.axis, options.seed, options.out,
             assumptions);
  fmt::print("{:<12} {:>21} {:>21}   {}\n", "parameter", "mean (Table III)", "std (Table III)",
             "worst of the eight statistics");
  for (std::size_t j = 0; j < summary.size(); ++j) {
    const auto& s = summary[j];
    fmt::print("{:<12} {:>10.4g} ({:>8.4g}) {:>10.4g} ({:>8.4g})   {} {:.2f} %", kArmParameterNames[j], s.sample.mean,
               s.table.mean, s.sample.standard_deviation, s.table.standard_deviation, s.worst_statistic,
               100 * s.worst_deviation);
    if (!s.feasible) {
      fmt::print("; infeasible: no distribution meets this row, the nearest is {:.2f} % off",
                 100 * s.distribution_distance);
    } else if (s.gap) {
      fmt::print("; met only by a distribution with a gap at a percentile");
    }
    fmt::print("\n");
  }
}

void sample(const SampleOptions& options) {
  const auto population = options.population();
  const auto summary =
      studies::write_arm_sample(population, options.count, options.seed, options.out, progress_bar("sampling"));
  const auto assumptions = studies::population_assumptions(population);
  if (!options.json.empty())
    io::write_file_atomically(options.json, to_json(summary, options, assumptions).dump(2) + "\n");
  if (options.json != "-" && options.out != "-") print(summary, options, assumptions);
}

void add_sample(CLI::App* arm) {
  auto* command = arm->add_subcommand("sample", "Draw arms from the measured population (Table III)");
  const auto options = std::make_shared<SampleOptions>();
  command->add_option("--axis", options->axis, "x left-right, y up-down, z forward-backward")->required();
  command->add_option("--count", options->count, "number of arms")->required()->check(CLI::Range(1, 100'000'000));
  add_population_options(command, options.get());
  command->add_option("--out", options->out, "CSV file, or - for the terminal")->required();
  command->add_option("--json", options->json,
                      "write the sample's statistics as JSON to a file, or - for the terminal");
  command->footer("Example: handloop arm sample --axis x --count 1000 --seed 1 --out arms.csv");
  command->callback([options] { sample(*options); });
}

// ---- arm bode -------------------------------------------------------------------------------------------------------

struct BodeOptions : PopulationOptions {
  std::size_t count = 0;
  std::vector<std::string> literature;
  std::string out;
};

void add_bode(CLI::App* arm) {
  auto* command = arm->add_subcommand("bode", "Plot the frequency response x/F of the published and of sampled arms");
  const auto options = std::make_shared<BodeOptions>();
  command->add_option("--axis", options->axis, "x left-right, y up-down, z forward-backward")->required();
  command->add_option("--count", options->count, "sampled arms behind the published ones")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  command->add_option("--literature", options->literature, "arms of Table V to add, or all")->delimiter(',');
  add_population_options(command, options.get());
  command->add_option("--out", options->out, "directory for report.html, two SVG plots and bode.csv")->required();
  command->footer("Example: handloop arm bode --axis z --count 200 --out out/bode");
  command->callback([options] {
    const auto population = options->population();
    const studies::BodeRequest request{options->count, options->seed, options->literature};
    const auto bode = studies::arm_bode(population, request);
    studies::write_arm_bode(bode, population, options->out);
    fmt::print("{}/report.html\n", options->out);
  });
}

}  // namespace

void add_arm_command(CLI::App& program) {
  auto* arm = program.add_subcommand("arm", "The measured arms: show, sample and plot them");
  arm->require_subcommand(1);
  arm->footer("Example: handloop arm show --axis x --grip nominal");
  add_show(arm);
  add_sample(arm);
  add_bode(arm);
}

}  // namespace handloop::cli
