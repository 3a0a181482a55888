#pragma once

#include <complex>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// An effect is one component, used four times: the identification looks for it, the simulator runs it, the margins
/// feel it and the panel shows it. Each effect is one file in this folder; the catalogue lists them all.
///
/// Units are those of a translational axis; for a rotary recording read N as Nm and m as rad.
namespace handloop::models {

/// Where an effect enters the chain device - sensor - grasp - arm.
enum class Place {
  arm,       ///< between the arm's mass and the resting body (beside k2, b2); for an `msd` plant, beside its spring
  grasp,     ///< between the stylus and the arm's mass (beside k1, b1)
  joint,     ///< between the stylus and ground: what the device's own joints or structure add
  actuator,  ///< on the force signal, before the plant receives it
  sensor     ///< on the position signal, after the plant
};

std::string_view place_name(Place place);
/// Throws InputError for an unknown word, naming the five.
Place parse_place(std::string_view text);

/// How a search over recordings treats a parameter.
enum class Role {
  gain,   ///< the force (or signal) is proportional to it: its start follows by linear regression
  shape,  ///< enters otherwise: starts are tried over a range
  choice  ///< not a quantity of the fit: every listed value is a variant of its own
};

/// In what a search range is measured: absolute units, or multiples of the rms motion at the effect's place.
enum class Scale { absolute, position, velocity };

struct Search {
  Role role = Role::gain;
  double from = 0.0;  ///< first and last start; shapes in geometric, choices in arithmetic steps
  double to = 0.0;
  int points = 1;
  Scale scale = Scale::absolute;
  /// May a fit end at the edge of the range? Where not, it is taken for another effect in disguise.
  bool edge_allowed = false;
};

/// One parameter of an effect, as it stands in model files.
struct EffectParameter {
  std::string_view name;  ///< key, the unit as its suffix: "force_N"
  std::string_view unit;  ///< "N"
  double lower;           ///< physically admissible range, both ends included
  double upper;
  double typical;            ///< a usual value: default of a model file, first position of a slider
  std::string_view meaning;  ///< one line
  Search search = {};
};

/// What is known of an effect before it has any value.
struct EffectInfo {
  std::string_view name;         ///< as in CONTRACT: "coulomb_friction"
  std::string_view title;        ///< "Coulomb friction"
  std::string_view equation;     ///< plain text, with the parameter names
  std::string_view source;       ///< paper or textbook
  std::string_view fingerprint;  ///< what a residual shows where the effect is missing
  std::string_view experiment;   ///< what would set it apart from its rivals
  std::vector<Place> places;     ///< where it may act, the usual place first
  std::vector<EffectParameter> parameters;
  std::vector<Place> search_places = {};  ///< where a search looks for it; empty: found by other means

  /// Index of a parameter by its key, or parameters.size() where there is none.
  std::size_t parameter_index(std::string_view key) const;
};

/// Spring, damper and mass that the effect stands beside: effects that modify them (backlash, drift) need to know them.
struct PortBase {
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;
  double mass_kg = 0.0;
};

/// Motion at the place an effect acts on, at one instant. x and v are the extension of the element there: of the arm's
/// mass (arm), of grip minus mass (grasp), of the grip (joint).
struct PortMotion {
  double t_s = 0.0;
  double x_m = 0.0;
  double v_m_per_s = 0.0;
  double delayed_x_m = 0.0;  ///< the same, delay_s() ago
  double delayed_v_m_per_s = 0.0;
};

/// How far things move when the effect is linearised.
struct OperatingPoint {
  double x_rms_m = 1e-3;  ///< of the motion about its mean, at the effect's place
  double v_rms_m_per_s = 1e-2;
  double x_mean_m = 0.0;
  double t_s = 0.0;  ///< for effects that drift
};

/// The linear stand-in of an effect at an operating point.
/// A force element resists motion with F(s) = (k + b s + m s^2 + e^(-s delay) numerator(s)/denominator(s)) X(s);
/// a signal element multiplies its signal by e^(-s delay) numerator(s)/denominator(s).
/// Polynomials are given highest power first; empty numerator means no such term.
struct LinearElement {
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;
  double mass_kg = 0.0;
  std::vector<double> numerator = {};
  std::vector<double> denominator = {};
  double delay_s = 0.0;

  /// Dynamic stiffness (force element) or transfer (signal element) at s in rad/s.
  std::complex<double> operator()(std::complex<double> s) const;
};

/// An effect with values. Immutable and without hidden state: every state it has lives with the caller, so one object
/// may serve many simulations and threads at once. force() and state_rates() neither allocate, lock nor throw:
/// real-time safe.
class Effect {
 public:
  virtual ~Effect() = default;

  const EffectInfo& info() const { return *info_; }
  Place place() const { return place_; }
  /// In the order of info().parameters.
  std::span<const double> parameters() const { return values_; }
  double parameter(std::string_view key) const;
  /// False for a parameter that does nothing at this place or with the choices made.
  virtual bool uses(std::size_t /*parameter*/) const { return true; }

  // ---- as a force between two points -----------------------------------------------------------------------------
  /// Number of internal states (bristle, relaxing spring, filter); all start at zero.
  virtual std::size_t state_count() const { return 0; }
  /// Resisting force in N: positive opposes positive motion, like k x + b v.
  virtual double force_N(const PortMotion&, const PortBase&, std::span<const double> /*states*/) const { return 0.0; }
  /// Time derivatives of the internal states.
  virtual void state_rates(const PortMotion&, const PortBase&, std::span<const double> /*states*/,
                           std::span<double> /*rates*/) const {}
  /// Mass that moves with the point, kg; adds m a to the resisting force. At the grasp it moves with the grip.
  virtual double added_mass_kg(double /*t_s*/) const { return 0.0; }
  /// How old delayed_x_m and delayed_v_m_per_s are to be; 0 where the effect has no memory of that kind.
  virtual double delay_s() const { return 0.0; }

  // ---- as an operation on a signal (places actuator and sensor) --------------------------------------------------
  /// True where the effect acts on a signal: y = e^(-s delay) transfer(s) u + addition(t).
  virtual bool acts_on_signal() const { return place_ == Place::actuator || place_ == Place::sensor; }
  /// What is added to the signal at time t (offset, tremor), in the signal's unit.
  virtual double signal_addition(double /*t_s*/) const { return 0.0; }

  // ---- for the margins -------------------------------------------------------------------------------------------
  /// Linearisation, by describing function (random-input for friction and other memoryless effects) at the point.
  virtual LinearElement linearise(const OperatingPoint& point, const PortBase& base) const = 0;

 protected:
  Effect(const EffectInfo& info, Place place, std::span<const double> values);
  double value(std::size_t index) const { return values_[index]; }

 private:
  const EffectInfo* info_;
  Place place_;
  std::vector<double> values_;
};

using EffectPtr = std::shared_ptr<const Effect>;

/// An entry of the catalogue: what is known, and how to make one with values.
struct EffectType {
  const EffectInfo& info;
  EffectPtr (*make)(Place place, std::span<const double> values);
};

/// Every effect there is, in the order of the contract.
std::span<const EffectType> effect_catalogue();
/// Entry by name. Throws InputError for an unknown one, suggesting the nearest.
const EffectType& find_effect_type(std::string_view name);
/// Makes an effect. Values in the order of the info's parameters; throws InputError where a value is outside its bounds
/// or not finite, or the effect cannot act at that place.
EffectPtr make_effect(std::string_view name, Place place, std::span<const double> values);
/// The same with the typical values.
EffectPtr make_typical_effect(std::string_view name, Place place);

}  // namespace handloop::models
