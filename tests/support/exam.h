#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/planted_recording.h"

/// What an explanation is worth, measured against what was planted.
namespace handloop::tests {

/// One recording, what was planted in it, and what `explain` said.
struct ExamResult {
  std::string file;
  PlantedGroup group = PlantedGroup::none;
  std::vector<std::string> planted;
  std::string variant, base;  ///< how it was planted and in which arm, for the eye
  bool catalogued = true;
  bool ran = false;  ///< false: the program failed; `message` says how
  std::string message;
  std::string verdict;
  std::vector<std::string> found;
  std::vector<std::string> indistinguishable;  ///< rivals that the program declares to be one with what it found
  double floor = 0, base_here = 0;             ///< this laboratory's: true model's error and its own base fit's
  double before = 0, after = 0;                ///< the program's held-out errors
  double claimed_floor = 0;
  double seconds = 0;  ///< of processor time

  /// One true parameter beside the interval that was given for it.
  struct Interval {
    std::string name;
    double truth = 0, lo = 0, hi = 0;
    bool holds() const { return lo <= truth && truth <= hi; }
  };
  std::vector<Interval> intervals;

  /// Every planted effect was found, or is among the rivals declared indistinguishable from what was found.
  bool named() const;
  std::size_t named_count() const;
  /// Effects found beyond what was planted. A stand-in for a planted effect that was declared indistinguishable is
  /// none.
  std::size_t false_effects() const;
  double after_over_floor() const { return floor > 0 ? after / floor : 0; }
};

/// Writes the recording as CSV, as the contract has it (`time_s,force_N,position_m`, or torque_Nm and angle_rad).
void write_recording_csv(const std::filesystem::path& path, const PlantedRecording& recording);

/// Runs `program explain` on the recording in a process of its own, within `work`; the folder of its outputs is
/// work/<name>.out and stays.
ExamResult examine(const std::filesystem::path& program, const PlantedRecording& recording,
                   const std::filesystem::path& work, const std::string& name);

/// The report in plain text: confusion matrix, false alarms, hit rates, errors over the floor, calibration.
std::string exam_summary(const std::vector<ExamResult>& results);

/// One line of a table for one result.
std::string exam_line(const ExamResult& result);

}  // namespace handloop::tests
