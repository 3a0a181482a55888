#include "studies/seven_bar_margins.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "studies/margins_json.h"

namespace handloop::studies {
namespace {

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> p(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) p[i + k] += a[i] * b[k];
  }
  return p;
}

constexpr const char* kAssumption =
    "the paper gives no filter K: K = k/(0.03 s + 1)^3 with k = 0.0198 m/N is ours, chosen so that alpha = 5 and 8 are "
    "stable "
    "and 19 is not, as in its experiment";

}  // namespace

control::TransferLoop seven_bar_loop(double alpha, double filter_gain) {
  const std::vector<double> lag{0.03, 1};
  const std::vector<double> impedance{alpha * 4.0418 + 9.08, alpha * 34.76107, alpha * 176.5862};
  control::TransferLoop loop;
  loop.numerator = product({filter_gain}, product({1.2516, 2.079}, impedance));
  loop.denominator = product({0.002, 1, 1.2516, 2.079}, product(lag, product(lag, lag)));
  return loop;
}

SevenBarMargins seven_bar_margins() {
  SevenBarMargins result;
  const auto judge = [&](double alpha) { return control::evaluate(seven_bar_loop(alpha, result.filter_gain)); };
  for (const double alpha : {8.0, 5.0, 19.0}) result.loops.push_back({alpha, judge(alpha)});
  double low = 5, high = 19;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (judge(middle).margins.stable ? low : high) = middle;
  }
  result.alpha_limit = low;
  return result;
}

nlohmann::ordered_json to_json(const SevenBarMargins& r) {
  nlohmann::ordered_json j;
  j["scenario"] = "seven_bar";
  j["assumption"] = kAssumption;
  j["stable"] = r.loops.front().result.margins.stable;
  j["nominal"] = to_json(r.loops.front().result);
  j["alpha_limit"] = r.alpha_limit;
  for (const auto& [alpha, result] : r.loops) {
    auto entry = to_json(result);
    entry["alpha"] = alpha;
    j["loops"].push_back(entry);
  }
  return j;
}

std::string to_text(const SevenBarMargins& r) {
  std::string text = fmt::format("seven_bar: loop G K (alpha H0 + E0) of Kazerooni and Her; {}\n", kAssumption);
  for (const auto& [alpha, result] : r.loops) {
    const auto& m = result.margins;
    text +=
        m.stable
            ? fmt::format(
                  "alpha = {:<4g} stable: gain x {:.4g}, phase {:.4g} deg, delay {:.4g} s, |1+L| {:.4g}, disk {:.4g}\n",
                  alpha, m.gain_up, m.phase_deg, m.delay_s, m.modulus, m.disk_alpha)
            : fmt::format("alpha = {:<4g} UNSTABLE: a pole at {:.4g} 1/s\n", alpha, result.abscissa);
  }
  return text + fmt::format("stable up to alpha = {:.5g}\n", r.alpha_limit);
}

}  // namespace handloop::studies
