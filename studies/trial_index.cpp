#include "studies/trial_index.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <string>

#include "io/csv_file.h"
#include "models/errors.h"

namespace handloop::studies {

namespace {

int whole_number(double value, const std::string& place) {
  if (value != std::floor(value) || value < 0 || value > 1e6) {
    throw InputError(fmt::format("{}: {:.6g} is not a whole number from 0 on", place, value));
  }
  return static_cast<int>(value);
}

}  // namespace

std::vector<IndexedTrial> read_trial_index(const std::filesystem::path& index) {
  const io::CsvFile csv(index);
  const std::size_t trial = csv.require("trial"), axis = csv.require("axis");
  const auto subject = csv.find("subject"), grip = csv.find("grip"), file = csv.find("file");
  std::array<std::optional<std::size_t>, 5> truth;
  bool has_truth = true;
  for (std::size_t i = 0; i < 5; ++i) {
    truth[i] = csv.find(models::kArmParameterNames[i]);
    has_truth = has_truth && truth[i];
  }
  std::vector<IndexedTrial> trials;
  std::set<int> seen;
  csv.for_each_row([&](std::size_t row, std::span<const std::string> cells) {
    auto number = [&](std::size_t column) { return csv.to_number(cells[column], row, column); };
    IndexedTrial t;
    t.trial = whole_number(number(trial), csv.place(row, trial));
    if (!seen.insert(t.trial).second) {
      throw InputError(fmt::format("{}: trial {} stands twice in the index", csv.place(row, trial), t.trial));
    }
    if (subject) t.subject = whole_number(number(*subject), csv.place(row, *subject));
    if (grip) t.grip = whole_number(number(*grip), csv.place(row, *grip));
    try {
      t.axis = models::parse_axis(cells[axis]);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", csv.place(row, axis), error.what()));
    }
    const std::string name = file ? cells[*file] : fmt::format("trial_{:03d}.csv", t.trial);
    t.file = index.parent_path() / name;
    if (has_truth) {
      std::array<double, 5> values{};
      for (std::size_t i = 0; i < 5; ++i) values[i] = number(*truth[i]);
      t.truth = models::arm_from_array(values);
    }
    trials.push_back(std::move(t));
  });
  if (trials.empty())
    throw InputError(fmt::format("{}: no trials; one line for each recording is expected", index.string()));
  return trials;
}

}  // namespace handloop::studies
