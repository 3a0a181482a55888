#include "studies/sweep_store.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "models/errors.h"

namespace handloop::studies {
namespace {

constexpr const char* kSchema = R"sql(
CREATE TABLE sweep(number INTEGER PRIMARY KEY, setting TEXT NOT NULL, value TEXT NOT NULL);
CREATE TABLE conditions(condition INTEGER PRIMARY KEY, axis TEXT, delay_samples INTEGER, device INTEGER,
                        mass_factor REAL, damping_factor REAL);
CREATE TABLE points(point INTEGER PRIMARY KEY, condition INTEGER, stage INTEGER, stiffness_N_per_m REAL, damping_Ns_per_m REAL);
CREATE TABLE cells(point INTEGER PRIMARY KEY, arms INTEGER, stable INTEGER, rho_p95 REAL,
                   gm_up_min REAL, gm_up_p05 REAL, gm_up_p50 REAL, pm_deg_min REAL, pm_deg_p05 REAL, pm_deg_p50 REAL,
                   dm_s_min REAL, dm_s_p05 REAL, dm_s_p50 REAL, sm_min REAL, sm_p05 REAL, sm_p50 REAL,
                   disk_alpha_min REAL, disk_alpha_p05 REAL, disk_alpha_p50 REAL);
CREATE TABLE evaluations(point INTEGER, arm INTEGER, stable INTEGER, rho REAL, gm_up REAL, gm_down REAL, pm_deg REAL,
                         dm_s REAL, sm REAL, disk_alpha REAL, PRIMARY KEY(point, arm)) WITHOUT ROWID;
CREATE TABLE arms(axis TEXT, arm INTEGER, mass_kg REAL, k1_N_per_m REAL, k2_N_per_m REAL, b1_Ns_per_m REAL, b2_Ns_per_m REAL,
                  PRIMARY KEY(axis, arm)) WITHOUT ROWID;
CREATE TABLE run_sessions(session INTEGER PRIMARY KEY, began_utc TEXT, host TEXT, jobs INTEGER, ranks INTEGER,
                          evaluations INTEGER, seconds REAL);
CREATE TABLE run_blocks(first_point INTEGER, first_arm INTEGER, points INTEGER, arms INTEGER, session INTEGER, rank INTEGER,
                        seconds REAL, PRIMARY KEY(first_point, first_arm)) WITHOUT ROWID;
CREATE TABLE run_events(event INTEGER PRIMARY KEY, session INTEGER, at_utc TEXT, text TEXT);
)sql";

/// Arms are listed up to here; beyond, `arm sample` with the same seed makes them.
constexpr std::uint64_t kListedArms = 100000;

std::string now_utc() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

models::Axis axis_of(const std::string& name) {
  return models::parse_axis(name);
}

}  // namespace

SweepStore SweepStore::create(const std::filesystem::path& path, const SweepSettings& settings) {
  SweepStore store(std::make_unique<io::Database>(path, io::Database::Open::create));
  io::Transaction transaction(*store.database_);
  store.database_->run(kSchema);
  {
    io::Statement insert(*store.database_, "INSERT INTO sweep(setting, value) VALUES(?, ?)");
    for (const auto& [setting, value] : sweep_identity(settings)) insert.bind(0, setting).bind(1, value).run();
  }
  const std::vector<SweepCondition> conditions = sweep_conditions(settings);
  {
    io::Statement insert(*store.database_, "INSERT INTO conditions VALUES(?, ?, ?, ?, ?, ?)");
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      const SweepCondition& c = conditions[i];
      insert.bind(0, static_cast<std::int64_t>(i)).bind(1, models::axis_name(c.axis)).bind(2, c.delay_samples);
      insert.bind(3, c.device).bind(4, c.mass_factor).bind(5, c.damping_factor).run();
    }
  }
  if (settings.arms <= kListedArms) {
    io::Statement insert(*store.database_, "INSERT OR IGNORE INTO arms VALUES(?, ?, ?, ?, ?, ?, ?)");
    std::map<models::Axis, bool> listed;
    for (const SweepCondition& c : conditions) {
      if (std::exchange(listed[c.axis], true)) continue;
      const models::ArmPopulation population(c.axis, settings.percentiles);
      for (std::uint64_t i = 0; i < settings.arms; ++i) {
        const auto values = models::to_array(population.sample(settings.seed, i));
        insert.bind(0, models::axis_name(c.axis)).bind(1, static_cast<std::int64_t>(i));
        for (int j = 0; j < 5; ++j) insert.bind(2 + j, values[static_cast<std::size_t>(j)]);
        insert.run();
      }
    }
  }
  transaction.commit();
  store.prepare();
  return store;
}

SweepStore SweepStore::resume(const std::filesystem::path& path, const SweepSettings& settings) {
  SweepStore store(std::make_unique<io::Database>(path, io::Database::Open::existing));
  bool empty = false;
  {
    io::Statement tables(*store.database_, "SELECT count(*) FROM sqlite_master");
    tables.step();
    empty = tables.integer(0) == 0;
  }
  if (empty) return create(path, settings);  // it was killed before it had begun
  if (!store.database_->has_table("sweep"))
    throw InputError(path.string() + ": not a sweep of this program; remove it to begin anew");
  store.require_same(settings);
  store.prepare();
  return store;
}

void SweepStore::require_same(const SweepSettings& settings) {
  const SweepIdentity there = identity(), here = sweep_identity(settings);
  const auto brief = [](const std::string& text) { return text.size() > 40 ? text.substr(0, 37) + "..." : text; };
  for (const auto& [setting, value] : here) {
    const auto found = there.find(setting);
    const std::string before = found == there.end() ? "" : found->second;
    if (before == value) continue;
    throw InputError(path().string() + ": belongs to another sweep: its " + setting +
                     (setting == "scenario" ? " differs" : " is '" + brief(before) + "', not '" + brief(value) + "'") +
                     "; ask for the same sweep again, or choose another --out");
  }
}

SweepStore SweepStore::read(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path))
    throw InputError(path.string() + ": there is no such database; `handloop sweep` makes one");
  SweepStore store(std::make_unique<io::Database>(path, io::Database::Open::read_only));
  if (!store.database_->has_table("sweep") || !store.database_->has_table("cells"))
    throw InputError(path.string() + ": not the database of a sweep");
  return store;
}

void SweepStore::prepare() {
  insert_evaluation_ =
      std::make_unique<io::Statement>(*database_, "INSERT INTO evaluations VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert_cell_ = std::make_unique<io::Statement>(
      *database_, "INSERT INTO cells VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert_block_ = std::make_unique<io::Statement>(*database_, "INSERT INTO run_blocks VALUES(?, ?, ?, ?, ?, ?, ?)");
}

SweepIdentity SweepStore::identity() {
  SweepIdentity identity;
  io::Statement query(*database_, "SELECT setting, value FROM sweep");
  while (query.step()) identity[query.text(0)] = query.text(1);
  return identity;
}

void SweepStore::add_points(const std::vector<SweepPoint>& points) {
  const std::vector<SweepPoint> there = this->points();
  io::Transaction transaction(*database_);
  io::Statement insert(*database_, "INSERT INTO points VALUES(?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i < there.size()) {
      if (!(there[i] == points[i]))
        throw InputError(path().string() + ": its point " + std::to_string(i) +
                         " is not the one this sweep would make; choose another --out");
      continue;
    }
    insert.bind(0, static_cast<std::int64_t>(i))
        .bind(1, static_cast<std::int64_t>(points[i].condition))
        .bind(2, points[i].stage);
    insert.bind(3, points[i].stiffness_N_per_m).bind(4, points[i].damping_Ns_per_m).run();
  }
  transaction.commit();
}

std::vector<SweepPoint> SweepStore::points() {
  std::vector<SweepPoint> points;
  io::Statement query(*database_,
                      "SELECT condition, stage, stiffness_N_per_m, damping_Ns_per_m FROM points ORDER BY point");
  while (query.step())
    points.push_back({static_cast<std::uint32_t>(query.integer(0)), static_cast<int>(query.integer(1)), query.real(2),
                      query.real(3)});
  return points;
}

std::vector<SweepCondition> SweepStore::conditions() {
  std::vector<SweepCondition> conditions;
  io::Statement query(
      *database_, "SELECT axis, delay_samples, device, mass_factor, damping_factor FROM conditions ORDER BY condition");
  while (query.step())
    conditions.push_back({axis_of(query.text(0)), static_cast<int>(query.integer(1)),
                          static_cast<int>(query.integer(2)), query.real(3), query.real(4)});
  return conditions;
}

void SweepStore::write_cell(std::uint32_t point, const PointStatistics& s) {
  insert_cell_->bind(0, static_cast<std::int64_t>(point)).bind(1, static_cast<std::int64_t>(s.arms));
  insert_cell_->bind(2, static_cast<std::int64_t>(s.stable)).bind(3, s.rho_p95);
  int column = 4;
  for (const MarginQuantiles& margin : s.margins)
    for (std::size_t q = 0; q < kSweepQuantiles.size(); ++q) insert_cell_->bind(column++, margin.at(q));
  insert_cell_->run();
}

void SweepStore::commit(const SweepBlockResult& result) {
  const SweepBlock& block = result.block;
  io::Transaction transaction(*database_);
  if (!result.evaluations.empty()) {
    io::Statement& insert = *insert_evaluation_;
    for (std::uint32_t p = 0; p < block.point_count; ++p) {
      for (std::uint64_t a = 0; a < block.arm_count; ++a) {
        const Evaluation& e = result.evaluations[p * block.arm_count + a];
        insert.bind(0, static_cast<std::int64_t>(block.first_point + p))
            .bind(1, static_cast<std::int64_t>(block.first_arm + a));
        insert.bind(2, e.stable > 0.5 ? 1 : 0).bind(3, e.rho).bind(4, e.gm_up).bind(5, e.gm_down).bind(6, e.pm_deg);
        insert.bind(7, e.dm_s).bind(8, e.sm).bind(9, e.disk_alpha).run();
      }
    }
  }
  for (std::size_t p = 0; p < result.statistics.size(); ++p)
    write_cell(block.first_point + static_cast<std::uint32_t>(p), result.statistics[p]);
  insert_block_->bind(0, static_cast<std::int64_t>(block.first_point))
      .bind(1, static_cast<std::int64_t>(block.first_arm));
  insert_block_->bind(2, static_cast<std::int64_t>(block.point_count))
      .bind(3, static_cast<std::int64_t>(block.arm_count));
  insert_block_->bind(4, session_).bind(5, result.rank).bind(6, result.seconds).run();
  transaction.commit();
}

std::map<std::pair<std::uint32_t, std::uint64_t>, SweepBlock> SweepStore::committed() {
  std::map<std::pair<std::uint32_t, std::uint64_t>, SweepBlock> blocks;
  io::Statement query(*database_, "SELECT first_point, first_arm, points, arms FROM run_blocks");
  while (query.step()) {
    const SweepBlock block{static_cast<std::uint32_t>(query.integer(0)), static_cast<std::uint32_t>(query.integer(2)),
                           static_cast<std::uint64_t>(query.integer(1)), static_cast<std::uint64_t>(query.integer(3))};
    blocks[{block.first_point, block.first_arm}] = block;
  }
  return blocks;
}

void SweepStore::finish_cells(std::uint64_t arms) {
  std::vector<std::uint32_t> missing;
  {
    io::Statement query(*database_,
                        "SELECT point FROM points WHERE point NOT IN (SELECT point FROM cells) ORDER BY point");
    while (query.step()) missing.push_back(static_cast<std::uint32_t>(query.integer(0)));
  }
  if (missing.empty()) return;
  io::Transaction transaction(*database_);
  io::Statement query(
      *database_,
      "SELECT stable, rho, gm_up, gm_down, pm_deg, dm_s, sm, disk_alpha FROM evaluations WHERE point = ? ORDER BY arm");
  std::vector<Evaluation> evaluations;
  std::vector<double> scratch(arms);
  for (const std::uint32_t point : missing) {
    evaluations.clear();
    query.reset();
    query.bind(0, static_cast<std::int64_t>(point));
    while (query.step())
      evaluations.push_back({query.real(0), query.real(1), query.real(2), query.real(3), query.real(4), query.real(5),
                             query.real(6), query.real(7)});
    write_cell(point, summarise(evaluations, scratch));
  }
  transaction.commit();
}

std::vector<PointStatistics> SweepStore::cells() {
  std::vector<PointStatistics> cells;
  io::Statement query(*database_, "SELECT c.* FROM points p LEFT JOIN cells c USING(point) ORDER BY p.point");
  while (query.step()) {
    if (query.is_null(1))
      throw InputError(path().string() + ": point " + std::to_string(cells.size()) + " was never finished");
    PointStatistics s;
    s.arms = static_cast<std::uint64_t>(query.integer(1));
    s.stable = static_cast<std::uint64_t>(query.integer(2));
    s.rho_p95 = query.real(3);
    int column = 4;
    for (MarginQuantiles& margin : s.margins) {
      margin.min = query.real(column++);
      margin.p05 = query.real(column++);
      margin.p50 = query.real(column++);
    }
    cells.push_back(s);
  }
  return cells;
}

std::vector<bool> SweepStore::stable_arms(std::uint32_t point) {
  std::vector<bool> stable;
  io::Statement query(*database_, "SELECT stable FROM evaluations WHERE point = ? ORDER BY arm");
  query.bind(0, static_cast<std::int64_t>(point));
  while (query.step()) stable.push_back(query.integer(0) != 0);
  return stable;
}

void SweepStore::begin_session(int jobs, int ranks) {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  io::Statement insert(*database_, "INSERT INTO run_sessions(began_utc, host, jobs, ranks) VALUES(?, ?, ?, ?)");
  insert.bind(0, now_utc()).bind(1, std::string_view(host)).bind(2, jobs).bind(3, ranks).run();
  io::Statement query(*database_, "SELECT max(session) FROM run_sessions");
  query.step();
  session_ = query.integer(0);
}

void SweepStore::end_session(std::uint64_t evaluations, double seconds) {
  io::Statement update(*database_, "UPDATE run_sessions SET evaluations = ?, seconds = ? WHERE session = ?");
  update.bind(0, static_cast<std::int64_t>(evaluations)).bind(1, seconds).bind(2, session_).run();
}

void SweepStore::log_event(const std::string& text) {
  io::Statement insert(*database_, "INSERT INTO run_events(session, at_utc, text) VALUES(?, ?, ?)");
  insert.bind(0, session_).bind(1, now_utc()).bind(2, text).run();
}

}  // namespace handloop::studies
