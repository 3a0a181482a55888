#include "sim/signal_path.h"

#include <string>

#include "models/errors.h"
#include "models/matrix_exponential.h"

namespace handloop::sim {
namespace {

std::vector<double> without_leading_zeros(const std::vector<double>& polynomial) {
  std::size_t first = 0;
  while (first + 1 < polynomial.size() && polynomial[first] == 0.0) ++first;
  return {polynomial.begin() + static_cast<std::ptrdiff_t>(first), polynomial.end()};
}

}  // namespace

SignalPath::SignalPath(const std::vector<models::EffectPtr>& effects, models::Place place, double step_s) {
  for (const auto& effect : effects) {
    if (effect->place() != place || !effect->acts_on_signal()) continue;
    effects_.push_back(effect);
    const auto element = effect->linearise({}, {});
    delay_s_ += element.delay_s;
    const auto denominator = without_leading_zeros(element.denominator);
    auto numerator = without_leading_zeros(element.numerator);
    const auto order = static_cast<Eigen::Index>(denominator.size()) - 1;
    if (numerator.size() > denominator.size()) {
      throw InputError(std::string(effect->info().name) +
                       ": a signal effect with more zeros than poles cannot be simulated");
    }
    numerator.insert(numerator.begin(), denominator.size() - numerator.size(), 0.0);
    // controllable form, carried over a step by one exponential of [A B 0; 0 0 1; 0 0 0] h (input linear in time)
    Section section;
    section.direct = numerator[0] / denominator[0];
    Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(order + 2, order + 2);
    section.read.resize(order);
    for (Eigen::Index i = 0; i < order; ++i) {
      augmented(0, i) = -denominator[i + 1] / denominator[0] * step_s;
      if (i > 0) augmented(i, i - 1) = step_s;
      section.read[i] = (numerator[i + 1] - section.direct * denominator[i + 1]) / denominator[0];
    }
    if (order > 0) augmented(0, order) = step_s;
    augmented(order, order + 1) = 1.0;
    const Eigen::MatrixXd exponential = models::matrix_exponential(augmented);
    section.transition = exponential.topLeftCorner(order, order);
    section.to_gain = exponential.topRightCorner(order, 1);
    section.from_gain = exponential.block(0, order, order, 1) - section.to_gain;
    section.state = Eigen::VectorXd::Zero(order);
    section.scratch = section.state;
    sections_.push_back(std::move(section));
  }
}

double SignalPath::addition(double t_s) const {
  double sum = 0;
  for (const auto& effect : effects_) sum += effect->signal_addition(t_s);
  return sum;
}

void SignalPath::reset() {
  for (auto& section : sections_) section.state.setZero();
}

void SignalPath::step(double from, double to) {
  for (auto& section : sections_) {
    const double out_from = section.output(from);
    section.scratch.noalias() = section.transition * section.state;
    section.scratch += section.from_gain * from + section.to_gain * to;
    section.state.swap(section.scratch);
    to = section.output(to);
    from = out_from;
  }
}

double SignalPath::output(double input) const {
  for (const auto& section : sections_) input = section.output(input);
  return input;
}

}  // namespace handloop::sim
