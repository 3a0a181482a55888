#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/database.h"
#include "studies/sweep_plan.h"
#include "studies/sweep_statistics.h"

/// The database of a sweep. Tables (docs/sweeps.md has every column):
///   sweep        what was asked for: one row a setting
///   conditions, points, arms
///   cells        the statistics of every point
///   evaluations  every arm at every point, where kept
///   run_sessions, run_blocks, run_events: when, where and by whom; the only contents that may differ between two runs
namespace handloop::studies {

/// A finished block: its evaluations, and the statistics of its points where it holds all arms.
struct SweepBlockResult {
  SweepBlock block;
  std::vector<Evaluation> evaluations;      ///< empty where they are not kept
  std::vector<PointStatistics> statistics;  ///< one a point, or empty
  int rank = 0;
  double seconds = 0.0;
};

/// What was asked for, as text: equal text, equal results.
using SweepIdentity = std::map<std::string, std::string>;
SweepIdentity sweep_identity(const SweepSettings& settings);

class SweepStore {
 public:
  /// Creates the database of a new sweep.
  static SweepStore create(const std::filesystem::path& path, const SweepSettings& settings);
  /// Opens an unfinished one. Throws InputError naming the first thing that differs where it belongs to another sweep.
  static SweepStore resume(const std::filesystem::path& path, const SweepSettings& settings);
  /// Opens a finished one for reading. Throws InputError where the file is not a sweep of this version.
  static SweepStore read(const std::filesystem::path& path);

  SweepIdentity identity();
  /// Throws InputError naming the first setting that differs.
  void require_same(const SweepSettings& settings);

  /// Adds points at the end; does nothing for those that are there already (they must be equal).
  void add_points(const std::vector<SweepPoint>& points);
  std::vector<SweepPoint> points();
  std::vector<SweepCondition> conditions();

  /// Commits one block: all of it or nothing.
  void commit(const SweepBlockResult& result);
  /// Which blocks are there already, by (first point, first arm).
  std::map<std::pair<std::uint32_t, std::uint64_t>, SweepBlock> committed();

  /// Makes the statistics of points whose blocks were committed in parts, from their evaluations.
  void finish_cells(std::uint64_t arms);
  /// Statistics of every point, in order; throws where one is missing.
  std::vector<PointStatistics> cells();
  /// One flag an arm, where evaluations are kept: true where stable. Empty otherwise.
  std::vector<bool> stable_arms(std::uint32_t point);

  void begin_session(int jobs, int ranks);
  void end_session(std::uint64_t evaluations, double seconds);
  /// Commits at once a line of the run's log.
  void log_event(const std::string& text);

  /// All of it into one file.
  void settle() { database_->settle(); }
  const std::filesystem::path& path() const { return database_->path(); }

 private:
  explicit SweepStore(std::unique_ptr<io::Database> database) : database_(std::move(database)) {}
  void prepare();
  void write_cell(std::uint32_t point, const PointStatistics& statistics);

  std::unique_ptr<io::Database> database_;
  std::unique_ptr<io::Statement> insert_evaluation_, insert_cell_, insert_block_;
  std::int64_t session_ = 0;
};

}  // namespace handloop::studies
