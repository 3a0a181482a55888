#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "identify/envelope.h"
#include "identify/repeated_measures.h"
#include "identify/unbiased_fit.h"
#include "identify/variability.h"
#include "io/recording_file.h"
#include "studies/progress.h"
#include "studies/trial_index.h"

/// `identify`: from recordings to arms, their statistics and their variability, by the arm paper's method and by the
/// unbiased one beside it.
namespace handloop::studies {

enum class IdentificationMethod { paper, unbiased };
std::string_view method_name(IdentificationMethod method);

/// Where the paper's method takes its frequency response from: Welch's averaged segments as the paper does, or the
/// local polynomial method at the same frequencies, which has no leakage to speak of.
enum class SpectralEstimate { welch, local };
std::string_view spectra_name(SpectralEstimate spectra);

struct IdentificationRequest {
  /// Either these; a directory stands for its index.csv, or for every .csv and .mat file in it.
  std::vector<std::filesystem::path> recordings;
  std::filesystem::path index;       ///< or an index
  std::optional<models::Axis> axis;  ///< of `recordings`
  IdentificationMethod method = IdentificationMethod::unbiased;
  SpectralEstimate spectra = SpectralEstimate::welch;
  io::RecordingOptions columns;
  std::optional<identify::Hold> hold;  ///< of the unbiased method; none: each recording decides
  models::PercentileReading percentiles = models::PercentileReading::ecdf;
  bool skip_bad = false;  ///< go on without recordings that cannot be used, and say so
  unsigned threads = 0;   ///< 0: as many as there are cores
};

/// One method's answer to one recording.
struct TrialFit {
  identify::ArmFit fit;
  identify::FrequencyResponse response;  ///< what eq. (1) was fitted to (the unbiased method's without hold and delay)
  double rmse_m = 0.0;                   ///< of the simulated position, means removed, the whole record
  double nrmse = 0.0;                    ///< over the standard deviation of the measured position
};

struct IdentifiedTrial {
  IndexedTrial trial;
  std::string name;
  std::size_t samples = 0;
  double sample_time_s = 0.0;
  std::array<TrialFit, 2> fits;  ///< by IdentificationMethod
  double misfit = 0.0;           ///< of the unbiased method: chi squared a degree of freedom
  bool hold_is_clear = false;
  std::vector<std::string> doubts;  ///< about the recording itself

  const TrialFit& by(IdentificationMethod method) const { return fits[static_cast<std::size_t>(method)]; }
};

/// An envelope beside the published table of the same name on the same data.
struct FittedEnvelope {
  identify::Envelope fitted;
  std::optional<identify::Envelope> published;         ///< Table IV as it stands: may be below the data
  std::optional<identify::Envelope> published_lifted;  ///< with its gain changed until it touches
};

/// What a method says about all trials of one axis together. Arrays are in the order of models::kArmParameterNames.
struct AxisSet {
  std::optional<models::Axis> axis;
  std::vector<std::size_t> trials;  ///< indices into Identification::trials
  std::array<models::ParameterStatistics, 5> statistics{};
  std::optional<std::array<models::ParameterStatistics, 5>> truth;  ///< of the true arms, where all are known
  std::array<double, 5> bias{};                                     ///< mean error over mean truth, where known
  std::map<int, identify::ArmFit> by_grip;                          ///< Set 1
  std::map<int, identify::FrequencyResponse> grip_response;         ///< mean over subjects
  std::optional<identify::ArmFit> nominal;                          ///< Set 2; two trials or more
  std::optional<identify::UnstructuredVariability> variability;
  std::optional<FittedEnvelope> maximum, percentile67;
  std::optional<std::array<identify::RepeatedMeasures, 5>> grip_effect;  ///< complete sets of subjects and grips only
  models::ParameterStatistics rmse_m{};
};

struct Identification {
  IdentificationMethod method = IdentificationMethod::unbiased;
  SpectralEstimate spectra = SpectralEstimate::welch;
  models::PercentileReading percentiles = models::PercentileReading::ecdf;
  std::vector<IdentifiedTrial> trials;
  std::vector<AxisSet> sets;         ///< of the method, by axis
  std::vector<AxisSet> other_sets;   ///< of the other method: no envelopes, no analysis of variance
  std::vector<std::string> skipped;  ///< recordings left out, with the reason
  std::vector<double> example_time_s, example_force_N, example_position_m;  ///< 5 s of the first trial (Figure 3)
  std::string example_name;
};

/// Both methods on one recording in memory.
IdentifiedTrial identify_recording(const models::Recording& recording, const IdentificationRequest& request);

/// Reads and fits every recording (in threads; the results do not depend on their number), then the sets. Throws
/// InputError naming the file for the first recording, in the order given, that cannot be used.
Identification run_identification(const IdentificationRequest& request, const Progress& progress = {});

/// The sets of one method over fitted trials; envelopes and analysis of variance only where `complete`.
std::vector<AxisSet> identify_sets(const std::vector<IdentifiedTrial>& trials, IdentificationMethod method,
                                   models::PercentileReading percentiles, bool complete);

/// Writes fits.csv (the method's), fits_paper.csv, fits_unbiased.csv, statistics.json and report.html into the
/// directory.
void write_identification(const Identification& identification, const std::filesystem::path& directory);

/// statistics.json.
std::string statistics_json(const Identification& identification);
/// fits.csv of one method.
std::string fits_csv(const Identification& identification, IdentificationMethod method);
/// report.html.
std::string identification_report(const Identification& identification);

}  // namespace handloop::studies
