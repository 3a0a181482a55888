#include "studies/doctor.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "control/controllers/phantom_mechanism.h"
#include "control/controllers/virtual_wall.h"
#include "device/live_loop.h"
#include "device/sim_device.h"
#include "io/scenario_file.h"

namespace handloop::studies {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;

std::string first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// Sums of /proc/stat: all of the processors' time and the part that was stolen.
std::array<double, 2> processor_time() {
  std::ifstream file("/proc/stat");
  std::string word;
  file >> word;
  double total = 0.0, steal = 0.0, value = 0.0;
  for (int column = 0; column < 8 && file >> value; ++column) {
    total += value;
    if (column == 7) steal = value;
  }
  return {total, steal};
}

void measure_wake_ups(Diagnosis& d, const Progress& progress) {
  // A thread of its own: its priority goes with it.
  std::thread thread([&] {
    d.realtime = device::request_realtime();
    device::MonotonicClock clock;
    d.timing = device::begin_schedule(clock.now_ns(), kPeriod_ns);
    const auto cycles = static_cast<std::int64_t>(d.seconds * 1e3);
    while (d.timing.next_cycle < cycles) d.wake.add(wait_for_next_cycle(d.timing, clock).late_ns);
  });
  if (progress) {
    const auto parts = static_cast<std::size_t>(std::ceil(d.seconds * 5));
    for (std::size_t i = 0; i < parts; ++i) {
      std::this_thread::sleep_for(std::chrono::duration<double>(d.seconds / static_cast<double>(parts)));
      progress(i + 1, parts);
    }
  }
  thread.join();
}

void measure_loop(Diagnosis& d) {
  constexpr int kSteps = 5000;
  const auto scenario = io::default_scenario();
  device::SimDevice plant(scenario);
  const auto mechanism = control::make_mechanism(scenario.device);
  const Eigen::Vector3d home = mechanism->at(device::pose_rad(scenario)).tip_m;
  auto wall = control::make_virtual_wall(scenario, home);
  device::Loop loop(device::loop_config(scenario, home), plant.description(), *mechanism, wall);
  plant.start();
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kSteps; ++i) d.loop.add(loop.step(plant).compute_ns);
  d.sim_steps_per_s = kSteps / std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Renderer of an OpenGL context without a window.
void look_at_opengl(Diagnosis& d) {
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (display == EGL_NO_DISPLAY) display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
    d.opengl_problem = "no EGL display";
    return;
  }
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglBindAPI(EGL_OPENGL_API);
  eglChooseConfig(display, wanted, &config, 1, &count);
  EGLContext context = count > 0 ? eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr) : EGL_NO_CONTEXT;
  if (context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) {
    const auto text = [](GLenum what) {
      const auto* found = reinterpret_cast<const char*>(glGetString(what));
      return std::string(found == nullptr ? "?" : found);
    };
    d.opengl = text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  } else {
    d.opengl_problem = "no OpenGL context";
  }
  if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  eglTerminate(display);
}

std::string gnuplot_version() {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen("gnuplot --version 2>/dev/null", "r"), &pclose);
  std::array<char, 128> line{};
  if (!pipe || std::fgets(line.data(), line.size(), pipe.get()) == nullptr) return "";
  std::string text = line.data();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace

char grade(const device::LatencyHistogram& wake, const device::Schedule& timing, const device::RealtimeGrant& realtime,
           std::vector<std::string>& reasons) {
  constexpr double kGood_us = 50.0, kFair_us = 200.0;
  const double missed = static_cast<double>(timing.missed);
  const double all = std::max(missed + static_cast<double>(wake.count()), 1.0);
  if (timing.missed > 0) {
    reasons.push_back(fmt::format("{} of {:.0f} deadlines were missed, at most {} in a row", timing.missed, all,
                                  timing.longest_miss));
  }
  if (wake.max_us() > kGood_us) {
    reasons.push_back(
        fmt::format("a wake-up came {:.0f} us late (p99.9: {:.0f} us)", wake.max_us(), wake.percentile_us(0.999)));
  }
  for (const auto& refused : realtime.refused) reasons.push_back("not granted: " + refused);
  if (missed / all >= 1e-3) return 'E';
  if (timing.missed > 0) return 'D';
  if (wake.max_us() > kFair_us) return 'C';
  if (wake.max_us() > kGood_us || !realtime.refused.empty()) return 'B';
  return 'A';
}

std::string grade_text(char grade) {
  switch (grade) {
    case 'A':
      return "fit for a hand at 1 kHz: never more than 50 us late";
    case 'B':
      return "fit for a hand at 1 kHz with a little jitter: never more than 200 us late";
    case 'C':
      return "usable with care: late at times, but no deadline missed";
    case 'D':
      return "for trials without a hand: single deadlines missed";
    default:
      return "for simulation only: too many deadlines missed";
  }
}

Diagnosis diagnose(double seconds, const Progress& progress) {
  Diagnosis d;
  d.seconds = seconds;
  const auto before = processor_time();
  measure_wake_ups(d, progress);
  const auto after = processor_time();
  if (after[0] > before[0]) d.steal_percent = 100.0 * (after[1] - before[1]) / (after[0] - before[0]);
  measure_loop(d);
  utsname system{};
  uname(&system);
  d.kernel = std::string(system.sysname) + " " + system.release;
  d.realtime_kernel =
      std::string(system.version).find("PREEMPT_RT") != std::string::npos || first_line("/sys/kernel/realtime") == "1";
  d.processors = std::thread::hardware_concurrency();
  d.governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  look_at_opengl(d);
  d.boards = device::comedi::list_boards();
  d.gnuplot = gnuplot_version();
  d.grade = grade(d.wake, d.timing, d.realtime, d.reasons);
  if (d.grade != 'A') {
    if (!d.realtime_kernel) d.reasons.push_back("the kernel is not a real-time one (Debian: linux-image-rt-amd64)");
    if (!d.governor.empty() && d.governor != "performance") {
      d.reasons.push_back("the processors' governor is " + d.governor + ", not performance");
    }
    if (d.steal_percent > 0.1) {
      d.reasons.push_back(fmt::format("{:.1f} % of the time went to other virtual machines", d.steal_percent));
    }
  }
  return d;
}

std::string diagnosis_json(const Diagnosis& d) {
  using Json = nlohmann::ordered_json;
  const auto percentiles = [](const device::LatencyHistogram& h) {
    return Json{{"count", h.count()},
                {"p50_us", h.percentile_us(0.5)},
                {"p99_us", h.percentile_us(0.99)},
                {"p99_9_us", h.percentile_us(0.999)},
                {"max_us", h.max_us()}};
  };
  Json boards = Json::array();
  for (const auto& board : d.boards) {
    boards.push_back({{"path", board.path},
                      {"name", board.name},
                      {"problem", board.problem},
                      {"counters", board.counters},
                      {"analog_inputs", board.analog_inputs},
                      {"analog_outputs", board.analog_outputs}});
  }
  const Json json{{"grade", std::string(1, d.grade)},
                  {"meaning", grade_text(d.grade)},
                  {"reasons", d.reasons},
                  {"seconds", d.seconds},
                  {"wake_up", percentiles(d.wake)},
                  {"deadline_misses", d.timing.missed},
                  {"longest_miss", d.timing.longest_miss},
                  {"loop_step", percentiles(d.loop)},
                  {"sim_steps_per_s", d.sim_steps_per_s},
                  {"sched_fifo", d.realtime.fifo},
                  {"memory_locked", d.realtime.memory_locked},
                  {"kernel", d.kernel},
                  {"realtime_kernel", d.realtime_kernel},
                  {"processors", d.processors},
                  {"governor", d.governor},
                  {"steal_percent", d.steal_percent},
                  {"opengl", d.opengl},
                  {"opengl_problem", d.opengl_problem},
                  {"comedi", boards},
                  {"gnuplot", d.gnuplot}};
  return json.dump(2) + "\n";
}

}  // namespace handloop::studies
