/// The planted-effect exam in full: `handloop explain` on recordings of the independent simulator.
///   exam [--count N] [--seed S] [--from I] [--what NAME | --group none|single|pair|outside|axis] [--jobs J] [--keep
///   DIR]
///        [--program FILE]
/// Prints a line for each recording as it is done and, at the end, the confusion matrix, false alarms, hits, errors
/// over the floor and the calibration of the intervals. Exit code 0 whatever the marks: it measures, tests decide.
#include "tests/support/exam.h"

#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

using namespace handloop::tests;

namespace {

struct Options {
  std::size_t count = 40, from = 0, jobs = 2;
  std::uint64_t seed = 1;
  std::string what, group, keep, program = HANDLOOP_PROGRAM;
};

PlantedRecording recording_of(const Options& o, std::size_t i) {
  if (!o.what.empty()) return plant_recording(o.what, o.seed * 7919 + i);
  if (o.group.empty()) return plant_stratified(i, o.seed);
  const std::vector<std::string> none{"none"};
  const std::vector<std::string>& names = o.group == "single"    ? planted_singles()
                                          : o.group == "pair"    ? planted_pairs()
                                          : o.group == "outside" ? planted_outsiders()
                                          : o.group == "axis"    ? planted_axes()
                                                                 : none;
  return plant_recording(names[i % names.size()], o.seed * 7919 + i * 104729, {i % 5 == 4 ? 30.0 : 60.0});
}

}  // namespace

int main(int argc, char** argv) {
  Options o;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--count")
      o.count = std::stoul(value);
    else if (key == "--from")
      o.from = std::stoul(value);
    else if (key == "--seed")
      o.seed = std::stoull(value);
    else if (key == "--what")
      o.what = value;
    else if (key == "--group")
      o.group = value;
    else if (key == "--jobs")
      o.jobs = std::stoul(value);
    else if (key == "--keep")
      o.keep = value;
    else if (key == "--program")
      o.program = value;
    else {
      std::fprintf(stderr, "exam: unknown option %s\n", key.c_str());
      return 2;
    }
  }
  namespace fs = std::filesystem;
  const fs::path work =
      o.keep.empty() ? fs::temp_directory_path() / ("handloop_exam_" + std::to_string(::getpid())) : fs::path(o.keep);
  fs::create_directories(work);
  std::vector<ExamResult> results(o.count);
  std::atomic<std::size_t> next{0};
  std::mutex printing;
  const auto worker = [&] {
    for (std::size_t i; (i = next++) < o.count;) {
      char name[24];
      std::snprintf(name, sizeof name, "rec_%03zu", o.from + i);
      try {
        results[i] = examine(o.program, recording_of(o, o.from + i), work, name);
      } catch (const std::exception& error) {
        results[i].file = name;
        results[i].message = error.what();
      }
      if (o.keep.empty()) fs::remove(work / (std::string(name) + ".csv"));
      const std::lock_guard lock(printing);
      std::printf("%s\n", exam_line(results[i]).c_str());
      std::fflush(stdout);
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t j = 0; j < o.jobs; ++j) threads.emplace_back(worker);
  for (std::thread& thread : threads) thread.join();
  std::printf("\n%s", exam_summary(results).c_str());
  if (o.keep.empty()) fs::remove_all(work);
}
