/// The sweep as a process: killed, starved of disk, spread over ranks. What it has committed must stay, and the end
/// must be the same bytes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "io/database.h"
#include "tests/support/paths.h"
#include "tests/support/sanitized.h"

extern char** environ;

namespace handloop {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kSweep{"sweep",   std::string(HANDLOOP_SOURCE_DIR) + "/scenes/phantom_wall.toml",
                                      "--arms",  "400",
                                      "--gains", "k=100:3000:24,b=0:5:6",
                                      "--seed",  "3",
                                      "--jobs",  "2"};

pid_t start(std::vector<std::string> words, const fs::path& log) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, 1, 2);
  pid_t pid = -1;
  EXPECT_EQ(posix_spawnp(&pid, argv[0], &files, nullptr, argv.data(), environ), 0) << argv[0];
  posix_spawn_file_actions_destroy(&files);
  return pid;
}

/// Exit code, or 128 + signal.
int finish(pid_t pid) {
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Every row of every table that may not differ between runs.
std::string rows(const fs::path& database_path) {
  io::Database database(database_path, io::Database::Open::read_only);
  std::string text;
  std::vector<std::pair<std::string, int>> tables;
  {
    io::Statement query(
        database,
        "SELECT m.name, (SELECT count(*) FROM pragma_table_info(m.name)) FROM sqlite_master m WHERE type = 'table' AND "
        "name NOT LIKE 'run\\_%' ESCAPE '\\' AND name NOT LIKE 'meta\\_%' ESCAPE '\\' ORDER BY name");
    while (query.step()) tables.emplace_back(query.text(0), static_cast<int>(query.integer(1)));
  }
  for (const auto& [table, columns] : tables) {
    io::Statement query(database, "SELECT * FROM " + table + " ORDER BY 1, 2, 3");
    text += table + "\n";
    while (query.step())
      for (int c = 0; c < columns; ++c) text += query.text(c) + (c + 1 < columns ? "," : "\n");
  }
  return text;
}

class SweepProgram : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("handloop_sweep_" + std::to_string(::getpid()) + "_" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<std::string> words(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> w{HANDLOOP_PROGRAM};
    w.insert(w.end(), kSweep.begin(), kSweep.end());
    w.insert(w.end(), {"--out", (folder_ / out).string()});
    w.insert(w.end(), more.begin(), more.end());
    return w;
  }
  fs::path log() const { return folder_ / "log"; }
  fs::path folder_;
};

TEST_F(SweepProgram, KilledAtTwentyRandomMomentsItRepeatsNothingAndEndsWithTheSameBytes) {
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(finish(start(words("whole"), log())), 0) << contents(log());
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - began;
  const std::string expected = rows(folder_ / "whole" / "sweep.sqlite");
  std::mt19937 random(20260101);
  int killed = 0, progressed = 0;
  std::int64_t before = 0;
  const auto compare = [&] {
    EXPECT_EQ(rows(folder_ / "killed" / "sweep.sqlite"), expected);
    for (const char* file : {"summary.json", "junit.xml", "report.html"})
      EXPECT_EQ(contents(folder_ / "killed" / file), contents(folder_ / "whole" / file)) << file;
    fs::remove_all(folder_ / "killed");
    before = 0;
  };
  while (killed < 20 ||
         (progressed < 5 && killed < 60)) {  // one sweep is killed again and again until it is done, then the next
    const pid_t pid = start(words("killed", {"--resume"}), log());
    std::this_thread::sleep_for(duration * (0.02 + 1e-3 * static_cast<double>(random() % 1000)));
    kill(pid, SIGKILL);
    if (finish(pid) == 0) {
      compare();
      continue;
    }
    ++killed;
    const fs::path part = folder_ / "killed" / "sweep.sqlite.part";
    if (!fs::exists(part)) continue;
    io::Database database(part, io::Database::Open::existing);
    if (!database.has_table("run_blocks")) continue;
    io::Statement count(database, "SELECT count(*) FROM run_blocks");
    count.step();
    EXPECT_GE(count.integer(0), before) << "a committed block is gone";
    progressed += count.integer(0) > before;
    before = count.integer(0);
    // a block computed twice would break the primary keys; its evaluations must be there with it
    io::Statement whole(database, "SELECT sum(points * arms) - (SELECT count(*) FROM evaluations) FROM run_blocks");
    whole.step();
    EXPECT_EQ(whole.integer(0), 0) << "half a block is there";
  }
  ASSERT_EQ(finish(start(words("killed", {"--resume"}), log())), 0) << contents(log());
  compare();
  EXPECT_GT(progressed, 3) << "kills came too early to prove anything";
}

TEST_F(SweepProgram, OnAFullDiskItSaysSoAndGoesOnWhenThereIsSpace) {
  const fs::path disk = folder_ / "disk";
  fs::create_directories(disk);
  if (std::system(("mount -t tmpfs -o size=2m tmpfs '" + disk.string() + "' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "mounting a small disk needs root";
  const int code = finish(start(words("disk/run"), log()));
  const std::string message = contents(log());
  const bool enlarged = std::system(("mount -o remount,size=64m '" + disk.string() + "'").c_str()) == 0;
  const int resumed = finish(start(words("disk/run", {"--resume"}), log()));
  const std::string after = contents(log());
  std::string expected, found;
  if (finish(start(words("whole"), folder_ / "log2")) == 0) expected = rows(folder_ / "whole" / "sweep.sqlite");
  if (resumed == 0) found = rows(disk / "run" / "sweep.sqlite");
  EXPECT_EQ(std::system(("umount '" + disk.string() + "'").c_str()), 0);
  EXPECT_EQ(code, 2);
  EXPECT_NE(message.find("disk is full"), std::string::npos) << message;
  ASSERT_TRUE(enlarged);
  EXPECT_EQ(resumed, 0) << after;
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(found, expected);
}

TEST_F(SweepProgram, AskedToStopItKeepsWhatIsDoneAndSaysHowToGoOn) {
  const pid_t pid = start(words("run"), log());
  const fs::path part = folder_ / "run" / "sweep.sqlite.part";
  for (int i = 0; i < 500 && !fs::exists(part); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  kill(pid, SIGTERM);
  const int code = finish(pid);
  if (code == 0) GTEST_SKIP() << "it was done before the signal came";
  EXPECT_EQ(code, 1);
  EXPECT_NE(contents(log()).find("--resume"), std::string::npos) << contents(log());
  EXPECT_FALSE(fs::exists(folder_ / "run" / "summary.json"));
}

class SweepOverRanks : public SweepProgram {
 protected:
  void SetUp() override {
    SweepProgram::SetUp();
    // Open MPI crashes the leak check of its own ranks, and locks in two orders
    if (tests::kAddressSanitizer || tests::kThreadSanitizer) GTEST_SKIP() << "Open MPI under a sanitizer";
    if (std::system("mpirun --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "mpirun is not installed";
  }
  std::vector<std::string> launched(int ranks, const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> w{"mpirun", "--allow-run-as-root", "--oversubscribe", "-n", std::to_string(ranks)};
    const std::vector<std::string> program = words(out, std::move(more));
    w.insert(w.end(), program.begin(), program.end());
    return w;
  }
};

TEST_F(SweepOverRanks, FourRanksGiveTheBytesOfOne) {
  ASSERT_EQ(finish(start(words("one"), log())), 0) << contents(log());
  ASSERT_EQ(finish(start(launched(4, "four"), log())), 0) << contents(log());
  EXPECT_EQ(rows(folder_ / "one" / "sweep.sqlite"), rows(folder_ / "four" / "sweep.sqlite"));
  EXPECT_EQ(contents(folder_ / "one" / "summary.json"), contents(folder_ / "four" / "summary.json"));
  io::Database database(folder_ / "four" / "sweep.sqlite", io::Database::Open::read_only);
  io::Statement ranks(database, "SELECT count(DISTINCT rank) FROM run_blocks");
  ranks.step();
  EXPECT_GE(ranks.integer(0), 2) << "the work was not spread";
}

TEST_F(SweepOverRanks, BadInputIsSaidOnce) {
  ASSERT_EQ(finish(start(launched(3, "x", {"--require", "nonsense"}), log())), 2) << contents(log());
  const std::string text = contents(log());
  const std::size_t first = text.find("no comparison in it");
  ASSERT_NE(first, std::string::npos) << text;
  EXPECT_EQ(text.find("no comparison in it", first + 1), std::string::npos) << text;
}

TEST_F(SweepOverRanks, ADeadRankLosesOnlyWhatItWasDoing) {
  ASSERT_EQ(finish(start(words("one"), log())), 0);
  const pid_t pid = start(launched(3, "dead"), log());
  const fs::path part = folder_ / "dead" / "sweep.sqlite.part";
  for (int i = 0; i < 2000 && !fs::exists(part); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  // a child of mpirun that is not rank 0: found by the environment the launcher gave it
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream stat(entry.path() / "stat");
    std::string number, program, state;
    pid_t parent = 0;
    stat >> number >> program >> state >> parent;
    if (parent == pid && contents(entry.path() / "environ").find("OMPI_COMM_WORLD_RANK=2") != std::string::npos)
      kill(static_cast<pid_t>(std::stol(name)), SIGKILL);
  }
  finish(pid);
  ASSERT_EQ(finish(start(words("dead", {"--resume"}), log())), 0) << contents(log());
  EXPECT_EQ(rows(folder_ / "dead" / "sweep.sqlite"), rows(folder_ / "one" / "sweep.sqlite"));
}

}  // namespace
}  // namespace handloop
