#include "studies/identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <iterator>
#include <mutex>
#include <numeric>
#include <thread>

#include "identify/local_polynomial.h"
#include "identify/recording_check.h"
#include "identify/spectra.h"
#include "io/output.h"
#include "models/errors.h"

namespace handloop::studies {

namespace {

constexpr double kExample_s = 5.0;

/// rms of measured minus simulated position, both without their means.
void judge_in_time(TrialFit& out, const models::Recording& recording) {
  const double count = static_cast<double>(recording.size());
  const auto mean = [&](const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0) / count; };
  const double mean_force = mean(recording.force_N), mean_position = mean(recording.position_m);
  std::vector<double> force(recording.force_N);
  for (double& f : force) f -= mean_force;
  const identify::SampledArm model(out.fit.arm, out.fit.hold, recording.sample_time_s);
  const auto simulated = model.simulate(force);
  const double lag = out.fit.delay_s / recording.sample_time_s;
  const auto whole = static_cast<std::ptrdiff_t>(std::floor(lag));
  const double part = lag - static_cast<double>(whole);
  const auto at = [&](std::ptrdiff_t n) {
    return simulated[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(n, 0, std::ssize(simulated) - 1))];
  };
  double error = 0, squares = 0, power = 0;
  for (std::size_t n = 0; n < recording.size(); ++n) {
    const auto from = static_cast<std::ptrdiff_t>(n) - whole;
    const double predicted = part == 0 ? at(from) : (1 - part) * at(from) + part * at(from - 1);
    const double y = recording.position_m[n] - mean_position, e = y - predicted;
    error += e / count;
    squares += e * e / count;
    power += y * y / count;
  }
  out.rmse_m = std::sqrt(std::max(0.0, squares - error * error));
  out.nrmse = out.rmse_m / std::sqrt(power);
}

std::vector<IndexedTrial> trials_of(const IdentificationRequest& request) {
  namespace fs = std::filesystem;
  if (!request.index.empty()) return read_trial_index(request.index);
  if (request.recordings.size() == 1 && fs::is_regular_file(request.recordings.front() / "index.csv")) {
    return read_trial_index(request.recordings.front() / "index.csv");
  }
  std::vector<fs::path> files;
  for (const auto& path : request.recordings) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    const std::size_t before = files.size();
    for (const auto& entry : fs::directory_iterator(path)) {
      const auto extension = entry.path().extension();
      if (entry.is_regular_file() && (extension == ".csv" || extension == ".mat")) files.push_back(entry.path());
    }
    if (files.size() == before) {
      throw InputError(
          fmt::format("{}: holds no .csv or .mat recordings; give recordings, or the directory of an "
                      "experiment",
                      path.string()));
    }
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  std::vector<IndexedTrial> trials;
  for (const auto& file : files) {
    IndexedTrial t;
    t.trial = static_cast<int>(trials.size()) + 1;
    t.axis = request.axis;
    t.file = file;
    trials.push_back(t);
  }
  return trials;
}

/// What the paper's method fits eq. (1) to.
identify::FrequencyResponse paper_response(const models::Recording& recording, SpectralEstimate spectra) {
  const double T = recording.sample_time_s;
  const auto segments = identify::paper_settings(T);
  if (spectra == SpectralEstimate::welch) {
    return identify::frequency_response(identify::welch(recording.force_N, recording.position_m, T, segments));
  }
  std::vector<double> frequencies;
  for (std::size_t bin = segments.first_bin; bin <= segments.last_bin; ++bin) {
    frequencies.push_back(static_cast<double>(bin) / (static_cast<double>(segments.segment) * T));
  }
  return identify::local_polynomial_response(recording.force_N, recording.position_m, T, {}, frequencies);
}

}  // namespace

std::string_view spectra_name(SpectralEstimate spectra) {
  return spectra == SpectralEstimate::welch ? "welch" : "local";
}

std::string_view method_name(IdentificationMethod method) {
  return method == IdentificationMethod::paper ? "paper" : "unbiased";
}

IdentifiedTrial identify_recording(const models::Recording& recording, const IdentificationRequest& request) {
  IdentifiedTrial out;
  out.name = recording.name;
  out.samples = recording.size();
  out.sample_time_s = recording.sample_time_s;
  out.doubts = identify::check_recording(recording);
  const double T = recording.sample_time_s;
  try {
    auto& paper = out.fits[static_cast<std::size_t>(IdentificationMethod::paper)];
    paper.response = paper_response(recording, request.spectra);
    identify::ArmFitSettings paper_fit;
    // Neighbouring answers of the local polynomials share hardly a line.
    if (request.spectra == SpectralEstimate::local) paper_fit.error_correlation = {1, 0, 0};
    paper.fit = identify::fit_arm(paper.response, paper_fit);
    judge_in_time(paper, recording);

    identify::UnbiasedSettings settings;
    settings.hold = request.hold;
    auto unbiased = identify::fit_arm_unbiased(recording.force_N, recording.position_m, T, settings);
    auto& other = out.fits[static_cast<std::size_t>(IdentificationMethod::unbiased)];
    other.fit = std::move(unbiased.fit);
    other.response = std::move(unbiased.continuous);
    judge_in_time(other, recording);
    out.misfit = unbiased.misfit;
    out.hold_is_clear = unbiased.hold_is_clear;
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", recording.name, error.what()));
  }
  return out;
}

Identification run_identification(const IdentificationRequest& request, const Progress& progress) {
  const auto trials = trials_of(request);
  if (trials.empty()) throw InputError("identify: no recordings; name them, or give --index DIR/index.csv");
  Identification out;
  out.method = request.method;
  out.spectra = request.spectra;
  out.percentiles = request.percentiles;

  std::vector<std::optional<IdentifiedTrial>> done(trials.size());
  std::vector<std::string> refused(trials.size());
  std::vector<std::exception_ptr> failed(trials.size());
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::size_t finished = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < trials.size() && !stop; i = next++) {
      try {
        const auto recording = io::read_recording(trials[i].file, request.columns);
        auto result = identify_recording(recording, request);
        result.trial = trials[i];
        if (i == 0) {
          const auto count = std::min(recording.size(), static_cast<std::size_t>(kExample_s / recording.sample_time_s));
          for (std::size_t n = 0; n < count; ++n) {
            out.example_time_s.push_back(static_cast<double>(n) * recording.sample_time_s);
          }
          out.example_force_N.assign(recording.force_N.begin(),
                                     recording.force_N.begin() + static_cast<std::ptrdiff_t>(count));
          out.example_position_m.assign(recording.position_m.begin(),
                                        recording.position_m.begin() + static_cast<std::ptrdiff_t>(count));
          out.example_name = trials[i].file.filename().string();
        }
        done[i] = std::move(result);
      } catch (const InputError& error) {
        refused[i] = error.what();
        failed[i] = std::current_exception();
        if (!request.skip_bad) stop = true;
      } catch (...) {
        failed[i] = std::current_exception();
        stop = true;
      }
      const std::lock_guard lock(mutex);
      ++finished;
      if (progress) progress(finished, trials.size());
    }
  };
  const unsigned wanted = request.threads > 0 ? request.threads : std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (std::size_t t = 1; t < std::min<std::size_t>(wanted, trials.size()); ++t) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();

  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (failed[i] && (!request.skip_bad || refused[i].empty())) std::rethrow_exception(failed[i]);
    if (!refused[i].empty()) out.skipped.push_back(refused[i]);
    if (done[i]) out.trials.push_back(std::move(*done[i]));
  }
  if (out.trials.empty())
    throw InputError(fmt::format("identify: no recording could be used; the first: {}", out.skipped.front()));

  const bool paper = request.method == IdentificationMethod::paper;
  out.sets = identify_sets(out.trials, request.method, request.percentiles, true);
  out.other_sets = identify_sets(out.trials, paper ? IdentificationMethod::unbiased : IdentificationMethod::paper,
                                 request.percentiles, false);
  return out;
}

std::string fits_csv(const Identification& identification, IdentificationMethod method) {
  std::string csv = "trial,axis,mass_kg,k1_N_per_m,k2_N_per_m,b1_Ns_per_m,b2_Ns_per_m,cost,nrmse";
  for (const auto name : models::kArmParameterNames) csv += fmt::format(",{}_lo95,{}_hi95", name, name);
  csv += '\n';
  for (const auto& trial : identification.trials) {
    const auto& result = trial.by(method);
    csv += fmt::format("{},{}", trial.trial.trial, trial.trial.axis ? models::axis_name(*trial.trial.axis) : "");
    for (const double v : models::to_array(result.fit.arm)) csv += fmt::format(",{:.9g}", v);
    csv += fmt::format(",{:.9g},{:.9g}", result.fit.cost, result.nrmse);
    for (std::size_t i = 0; i < 5; ++i) csv += fmt::format(",{:.9g},{:.9g}", result.fit.low95[i], result.fit.high95[i]);
    csv += '\n';
  }
  return csv;
}

void write_identification(const Identification& identification, const std::filesystem::path& directory) {
  io::OutputDirectory output(directory);
  io::write_file_atomically(output / "fits.csv", fits_csv(identification, identification.method));
  for (const auto method : {IdentificationMethod::paper, IdentificationMethod::unbiased}) {
    io::write_file_atomically(output / fmt::format("fits_{}.csv", method_name(method)),
                              fits_csv(identification, method));
  }
  io::write_file_atomically(output / "statistics.json", statistics_json(identification));
  io::write_file_atomically(output / "report.html", identification_report(identification));
  output.commit();
}

}  // namespace handloop::studies
