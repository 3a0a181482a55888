#include "tests/support/exam.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

namespace handloop::tests {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

std::string format(const char* pattern, auto... values) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : "+") + word;
  return text.empty() ? "-" : text;
}

/// This laboratory's words for a parameter and the program's, where both mean the same number.
struct Translation {
  const char *effect, *here, *there;
};
constexpr Translation kTranslations[] = {
    {"coulomb_friction", "force_N", "force_N"},
    {"time_delay", "delay_s", "delay_s"},
    {"sensor_lag", "lag_s", "time_constant_s"},
    {"added_mass", "mass_kg", "mass_kg"},
    {"backlash", "gap_m", "gap_m"},
    {"cubic_stiffness", "k3_N_per_m3", "coefficient_N_per_m3"},
    {"asymmetric_stiffness", "side_N_per_m", "difference_N_per_m"},
    {"quadratic_damping", "drag_Ns2_per_m2", "coefficient_Ns2_per_m2"},
    {"reflex_feedback", "gain_Ns_per_m", "velocity_gain_Ns_per_m"},
    {"reflex_feedback", "gain_N_per_m", "position_gain_N_per_m"},
    {"reflex_feedback", "delay_s", "delay_s"},
    {"position_ripple", "force_N", "amplitude_N"},
    {"position_ripple", "period_m", "period_m"},
    {"viscoelastic_relaxation", "k_N_per_m", "stiffness_N_per_m"},
    {"viscoelastic_relaxation", "time_s", "time_constant_s"},
    {"flexible_mode", "mass_kg", "mass_kg"},
    {"tremor", "frequency_Hz", "frequency_Hz"},
    {"offset", "force_N", "force_N"},
};

void compare_intervals(const PlantedRecording& recording, const nlohmann::json& effects, ExamResult& result) {
  for (const PlantedEffect& planted : recording.truth) {
    if (planted.variant == "rounded corner" || planted.variant.find("mode added") == 0) continue;
    for (const nlohmann::json& found : effects) {
      if (found.value("name", "") != planted.name || !found.contains("interval95")) continue;
      for (const Translation& word : kTranslations) {
        if (planted.name != word.effect || !planted.parameters.contains(word.here)) continue;
        const nlohmann::json& all = found["interval95"];
        if (!all.contains(word.there)) continue;
        const nlohmann::json& ends = all[word.there];
        if (!ends.is_array() || ends.size() != 2 || !ends[0].is_number() || !ends[1].is_number()) continue;
        result.intervals.push_back({planted.name + "." + word.there, planted.parameters.at(word.here),
                                    ends[0].get<double>(), ends[1].get<double>()});
      }
    }
  }
}

double number_at(const nlohmann::json& json, const char* group, const char* key) {
  if (!json.contains(group) || !json[group].contains(key) || !json[group][key].is_number()) return 0;
  return json[group][key].get<double>();
}

/// Runs a command of the shell; `seconds` is the processor time it took, for the machine may be busy with others.
int run_shell(const std::string& command, double& seconds) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  int status = -1;
  rusage usage{};
  if (child < 0 || ::wait4(child, &status, 0, &usage) < 0) return -1;
  const auto in_seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  seconds = in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime);
  return status;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

}  // namespace

std::size_t ExamResult::named_count() const {
  std::size_t count = 0;
  for (const std::string& name : planted) count += contains(found, name) || contains(indistinguishable, name);
  return count;
}

bool ExamResult::named() const {
  return ran && named_count() == planted.size() && (!planted.empty() || false_effects() == 0);
}

std::size_t ExamResult::false_effects() const {
  std::size_t strangers = 0, stand_ins = 0;
  for (const std::string& name : found)
    if (name != "tabulated" && !contains(planted, name)) ++strangers;
  for (const std::string& name : planted)
    if (!contains(found, name) && contains(indistinguishable, name)) ++stand_ins;
  return strangers > stand_ins ? strangers - stand_ins : 0;
}

void write_recording_csv(const std::filesystem::path& path, const PlantedRecording& recording) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) throw std::runtime_error("cannot write " + path.string());
  std::fprintf(file, recording.rotary ? "time_s,torque_Nm,angle_rad\n" : "time_s,force_N,position_m\n");
  for (std::size_t i = 0; i < recording.force.size(); ++i)
    std::fprintf(file, "%.3f,%.7g,%.9g\n", static_cast<double>(i) * recording.sample_time_s, recording.force[i],
                 recording.position[i]);
  if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path.string());
}

ExamResult examine(const std::filesystem::path& program, const PlantedRecording& recording,
                   const std::filesystem::path& work, const std::string& name) {
  ExamResult result;
  result.file = name;
  result.group = recording.group;
  result.catalogued = recording.catalogued;
  for (const PlantedEffect& effect : recording.truth) {
    result.planted.push_back(effect.name);
    result.variant += (result.variant.empty() ? "" : " + ") + effect.variant;
    for (const auto& [key, value] : effect.parameters) result.variant += format(" %s=%.3g", key.c_str(), value);
  }
  for (const auto& [key, value] : recording.base_parameters) result.base += format(" %s=%.4g", key.c_str(), value);
  result.floor = recording.rmse_floor;
  result.base_here = recording.rmse_base;

  const std::filesystem::path csv = work / (name + ".csv"), out = work / (name + ".out"), log = work / (name + ".log");
  write_recording_csv(csv, recording);
  std::filesystem::remove_all(out);
  std::string command = "'" + program.string() + "' explain '" + csv.string() + "' --base " + recording.base +
                        " --driven-by " + recording.driven_by + " --out '" + out.string() + "'";
  if (recording.rotary) command += " --force torque_Nm --position angle_rad";
  command += " >'" + log.string() + "' 2>&1";
  const int status = run_shell(command, result.seconds);

  std::ifstream stream(out / "explain.json");
  if (status != 0 || !stream) {
    std::ifstream words(log);
    std::string line;
    while (std::getline(words, line)) result.message = line;
    if (result.message.empty()) result.message = "no explain.json, status " + std::to_string(status);
    return result;
  }
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  if (json.is_discarded()) {
    result.message = "explain.json is not JSON";
    return result;
  }
  result.ran = true;
  result.verdict = json.value("verdict", "");
  for (const nlohmann::json& effect : json.value("effects", nlohmann::json::array()))
    result.found.push_back(effect.value("name", ""));
  for (const nlohmann::json& rival : json.value("rivals", nlohmann::json::array()))
    if (rival.value("indistinguishable", false)) result.indistinguishable.push_back(rival.value("name", ""));
  result.before = number_at(json, "base", "rmse_validation");
  result.after = number_at(json, "after", "rmse_validation");
  result.claimed_floor = number_at(json, "noise_floor", "rmse");
  compare_intervals(recording, json.value("effects", nlohmann::json::array()), result);
  return result;
}

std::string exam_line(const ExamResult& r) {
  if (!r.ran)
    return format("%-8s %-7s %-38s FAILED: %s  [%s;%s]", r.file.c_str(), std::string(group_name(r.group)).c_str(),
                  joined(r.planted).c_str(), r.message.substr(0, 200).c_str(), r.variant.c_str(), r.base.c_str());
  std::string rivals = r.indistinguishable.empty() ? "" : "  (~ " + joined(r.indistinguishable) + ")";
  const char* mark = r.group == PlantedGroup::outside      ? (r.verdict == "unexplained_residual" ? "ok" : "??")
                     : r.named() && r.false_effects() == 0 ? "ok"
                     : r.named()                           ? "+f"
                                                           : "NO";
  return format("%-8s %-7s %-38s %-2s %-20s %-38s base/floor %6.2f  after/floor %6.3f  %5.1f s  [%s;%s]",
                r.file.c_str(), std::string(group_name(r.group)).c_str(), joined(r.planted).c_str(), mark,
                r.verdict.c_str(), joined(r.found).c_str(), r.floor > 0 ? r.before / r.floor : 0, r.after_over_floor(),
                r.seconds, r.variant.c_str(), r.base.c_str()) +
         rivals;
}

std::string exam_summary(const std::vector<ExamResult>& results) {
  std::string text;
  // what was planted against what was found, singles only: a pair has no one row
  std::map<std::string, std::map<std::string, int>> confusion;
  for (const ExamResult& r : results) {
    if (!r.ran || r.planted.size() > 1) continue;
    confusion[joined(r.planted)][joined(r.found)] += 1;
  }
  text += "confusion (planted: found x times)\n";
  for (const auto& [planted, row] : confusion) {
    text += format("  %-30s", planted.c_str());
    for (const auto& [found, times] : row) text += format(" %s x%d;", found.c_str(), times);
    text += "\n";
  }
  text +=
      "\ngroup     count failed named  false-effects  before/floor median  after/floor median worst  <=1.15  seconds "
      "median worst\n";
  for (const PlantedGroup group :
       {PlantedGroup::none, PlantedGroup::single, PlantedGroup::pair, PlantedGroup::outside, PlantedGroup::axis}) {
    std::vector<double> before, after, seconds;
    int count = 0, failed = 0, named = 0, alarms = 0, within = 0;
    for (const ExamResult& r : results) {
      if (r.group != group) continue;
      ++count;
      if (!r.ran) {
        ++failed;
        continue;
      }
      named += group == PlantedGroup::outside ? r.verdict == "unexplained_residual" : r.named();
      alarms += group != PlantedGroup::outside && r.false_effects() > 0;
      before.push_back(r.before / r.floor);
      after.push_back(r.after_over_floor());
      within += r.after_over_floor() <= 1.15;
      seconds.push_back(r.seconds);
    }
    if (count == 0) continue;
    const double worst = after.empty() ? 0.0 : *std::max_element(after.begin(), after.end());
    const double slowest = seconds.empty() ? 0.0 : *std::max_element(seconds.begin(), seconds.end());
    text += format("%-9s %5d %6d %5d  %13d  %19.2f  %18.3f %5.2f  %6d  %14.1f %5.1f\n",
                   std::string(group_name(group)).c_str(), count, failed, named, alarms, median(before), median(after),
                   worst, within, median(seconds), slowest);
  }
  int pairs = 0, both = 0, one = 0, outsiders = 0, declared = 0, halved = 0;
  for (const ExamResult& r : results) {
    if (!r.ran) continue;
    if (r.group == PlantedGroup::pair) {
      ++pairs;
      both += r.named_count() == 2;
      one += r.named_count() == 1;
    }
    if (r.group == PlantedGroup::outside) {
      ++outsiders;
      declared += r.verdict == "unexplained_residual";
      halved += r.after <= 0.5 * r.before;
    }
  }
  if (pairs) text += format("\npairs: both named in %d of %d, one in %d\n", both, pairs, one);
  if (outsiders)
    text += format("outside the catalogue: declared unexplained in %d of %d, error at least halved in %d\n", declared,
                   outsiders, halved);
  std::map<std::string, std::pair<int, int>> calibration;
  int holds = 0, total = 0;
  for (const ExamResult& r : results)
    for (const ExamResult::Interval& interval : r.intervals) {
      auto& [inside, all] = calibration[interval.name];
      inside += interval.holds();
      ++all;
      holds += interval.holds();
      ++total;
    }
  if (total) {
    text += format("\n95 %% intervals that hold the truth: %d of %d\n", holds, total);
    for (const auto& [name, hits] : calibration)
      text += format("  %-45s %d of %d\n", name.c_str(), hits.first, hits.second);
  }
  return text;
}

}  // namespace handloop::tests
