#include "studies/arm_bode.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handloop::studies {
namespace {

constexpr double kLowest_Hz = 0.1;
constexpr double kHighest_Hz = 100;
constexpr int kPoints = 241;

template <typename Response>
BodeCurve curve(std::string name, const std::vector<double>& frequency_Hz, const Response& response) {
  BodeCurve result{std::move(name), {}, {}};
  for (const double f : frequency_Hz) {
    const std::complex<double> h = response(std::complex<double>(0, 2 * std::numbers::pi * f));
    result.magnitude_dB.push_back(20 * std::log10(std::abs(h)));
    result.phase_deg.push_back(std::arg(h) * 180 / std::numbers::pi);
  }
  return result;
}

BodeCurve curve(std::string name, const std::vector<double>& frequency_Hz, const models::ArmParameters& arm) {
  return curve(std::move(name), frequency_Hz, [&](std::complex<double> s) { return compliance(arm, s); });
}

BodeBand band(const std::vector<BodeCurve>& curves, std::vector<double> BodeCurve::*quantity) {
  BodeBand result;
  if (curves.empty()) return result;
  const auto last = static_cast<double>(curves.size() - 1);
  std::vector<double> values(curves.size());
  for (std::size_t i = 0; i < (curves[0].*quantity).size(); ++i) {
    for (std::size_t c = 0; c < curves.size(); ++c) values[c] = (curves[c].*quantity)[i];
    std::sort(values.begin(), values.end());
    result.p05.push_back(values[static_cast<std::size_t>(std::lround(0.05 * last))]);
    result.p50.push_back(values[static_cast<std::size_t>(std::lround(0.50 * last))]);
    result.p95.push_back(values[static_cast<std::size_t>(std::lround(0.95 * last))]);
  }
  return result;
}

std::vector<const models::LiteratureArm*> wanted_literature(const std::vector<std::string>& names) {
  std::vector<const models::LiteratureArm*> rows;
  for (const auto& name : names) {
    if (name == "all") {
      for (const auto& row : models::literature_arms()) rows.push_back(&row);
    } else {
      rows.push_back(&models::find_literature_arm(name));
    }
  }
  return rows;
}

}  // namespace

ArmBode arm_bode(const models::ArmPopulation& population, const BodeRequest& request) {
  ArmBode bode;
  for (int i = 0; i < kPoints; ++i) {
    bode.frequency_Hz.push_back(kLowest_Hz * std::pow(kHighest_Hz / kLowest_Hz, i / (kPoints - 1.0)));
  }
  using models::Grip;
  for (const Grip grip : {Grip::one_N, Grip::two_N, Grip::three_N, Grip::nominal}) {
    const std::string name =
        grip == Grip::nominal ? "nominal (Table II)" : std::string(grip_name(grip)) + " N (Table I)";
    bode.published.push_back(curve(name, bode.frequency_Hz, published_arm(population.axis(), grip)));
  }
  for (const auto* row : wanted_literature(request.literature)) {
    const auto model = row->model();
    bode.literature.push_back(curve(std::string(row->name) + " (Table V)", bode.frequency_Hz,
                                    [&](std::complex<double> s) { return compliance(model, {}, s); }));
  }
  for (std::size_t i = 0; i < request.count; ++i) {
    bode.samples.push_back(curve("sample " + std::to_string(i), bode.frequency_Hz, population.sample(request.seed, i)));
  }
  bode.magnitude_dB = band(bode.samples, &BodeCurve::magnitude_dB);
  bode.phase_deg = band(bode.samples, &BodeCurve::phase_deg);
  return bode;
}

}  // namespace handloop::studies
