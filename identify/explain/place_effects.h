#pragma once

#include <vector>

#include "models/axis_model.h"

namespace handloop::identify {

/// The force effects that act at one place during a run: their internal states and the memory their delays look into.
/// Steps are numbered from 0; remember() is called for each step in turn before the next one is evaluated.
class PlaceEffects {
 public:
  /// Takes the effects of `model` at `place`; steps of h_s, `steps` of them at most. Tremor is left out: no input
  /// predicts it.
  PlaceEffects(const models::AxisModel& model, models::Place place, double h_s, std::size_t steps, double start_time_s);
  /// A single effect, whatever its place.
  PlaceEffects(const models::Effect& effect, const models::PortBase& base, double h_s, std::size_t steps,
               double start_time_s);

  bool empty() const { return acting_.empty(); }
  /// Mass that moves with the place from the start, kg; belongs to the linear part.
  double constant_mass_kg() const;
  /// Stiffness and damping at small motion, which limit the step.
  models::LinearElement steepest() const;

  /// Sum of the resisting forces at a step, in N, with the present states.
  double force_N(std::size_t step, double x_m, double v_m_per_s, double a_m_per_s2) const;
  /// Carries the states from `step` to the next one, motion linear between its ends (Runge-Kutta 4).
  void advance(std::size_t step, double x0_m, double v0_m_per_s, double x1_m, double v1_m_per_s);
  /// Stores the motion of a step for later look-back.
  void remember(std::size_t step, double x_m, double v_m_per_s);

 private:
  struct Acting {
    const models::Effect* effect;
    double delay_steps;
    double constant_mass_kg;
    std::vector<double> states;
  };
  void add(const models::Effect& effect);
  models::PortMotion port(const Acting& acting, double step, double x_m, double v_m_per_s) const;

  models::PortBase base_;
  double h_s_, start_time_s_;
  std::size_t steps_;
  bool looks_back_ = false;
  std::vector<Acting> acting_;
  std::vector<double> past_x_m_, past_v_m_per_s_;
};

}  // namespace handloop::identify
