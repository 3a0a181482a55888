#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

/// Recordings with an effect planted in them, for the exams of `explain`. This is another laboratory: the physics is
/// written here a second time, from the equations of the plant, with its own integrator (RK4 at 20 kHz or finer, exact
/// stick-slip), its own sign and scale conventions that vary from recording to recording, and with the nuisances of a
/// real bench (noise, quantisation, slow wander of the hand). It shares no code with models/, identify/ or sim/, and
/// must never do so: what the fitting code and this code have in common cannot be found out by a test.
namespace handloop::tests {

/// The kinds of recordings an exam is made of.
enum class PlantedGroup {
  none,     ///< the base model and nothing else (noise and wander only)
  single,   ///< one effect of the catalogue
  pair,     ///< two effects of the catalogue
  outside,  ///< one effect that the catalogue does not hold
  axis      ///< another base: mass, spring, damper; driven by force or by position, linear or rotary
};
std::string_view group_name(PlantedGroup group);

/// One planted effect, described in this laboratory's words.
struct PlantedEffect {
  std::string name;     ///< the catalogue's word, or this file's own where it is none of the catalogue's
  std::string variant;  ///< how it was written here: "tanh", "exact stick-slip", ...
  std::map<std::string, double> parameters;  ///< SI, unit as suffix
};

/// A recording and the truth about it.
struct PlantedRecording {
  PlantedGroup group = PlantedGroup::none;
  std::string base = "arm5";        ///< arm5 or msd
  std::string driven_by = "force";  ///< force or position: what an explanation should simulate from
  bool rotary = false;              ///< Nm and rad in the place of N and m
  bool catalogued = true;           ///< false: the truth is not in the catalogue
  double sample_time_s = 0.001;
  std::vector<double> force;        ///< as recorded, N (or Nm)
  std::vector<double> position;     ///< as recorded, m (or rad)
  std::vector<double> predictable;  ///< what the true model with the true effects predicts of the output (position, or
                                    ///< force where driven_by is position): no noise, no wander, no tremor
  std::vector<PlantedEffect> truth;
  std::map<std::string, double> base_parameters;  ///< true M, k1, ... named as in `arm show`; msd: mass_kg, b, k

  double rmse_floor = 0.0;  ///< rms of output - predictable over the last 40 %: the error of the true model
  double rmse_base = 0.0;   ///< the same of the base model, fitted here (output error) to the first 60 %
  std::map<std::string, double> base_fit;  ///< that fit
  double noise_rms = 0.0;                  ///< of the output channel, before quantisation
  double wander_rms = 0.0;
  std::string hold;  ///< how the force ran between samples: "held" or "interpolated"

  double ratio() const { return rmse_floor > 0 ? rmse_base / rmse_floor : 0.0; }
  std::string truth_names() const;  ///< "reflex_feedback;cubic_stiffness", "" where nothing was planted
};

/// Names that can be planted: singles of the catalogue on an arm, pairs ("a+b"), outsiders, and axes.
const std::vector<std::string>& planted_singles();
const std::vector<std::string>& planted_pairs();
const std::vector<std::string>& planted_outsiders();
const std::vector<std::string>& planted_axes();

/// How long a recording is; the rest is drawn from the seed.
struct PlantedOptions {
  double duration_s = 60.0;
};

/// Makes one recording. `what`: "none", or a name of the lists above. The strength of what is planted is scaled so that
/// the base model's held-out error is 2 to 100 times the floor (a tremor, which no model predicts, is scaled to 1.5 to
/// 6 times the noise instead). The same what, seed and options give the same recording. Throws std::invalid_argument
/// for an unknown name.
PlantedRecording plant_recording(std::string_view what, std::uint64_t seed, const PlantedOptions& options = {});

/// The i-th recording of a stratified set: of every ten two are clean, four carry one effect, two a pair, one an
/// outsider and one is another axis, each group running through its names in turn; every fifth is 30 s long.
PlantedRecording plant_stratified(std::size_t index, std::uint64_t seed);

}  // namespace handloop::tests
