#include "studies/sweep_plan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "models/errors.h"
#include "models/random.h"
#include "models/suggest.h"

namespace handloop::studies {
namespace {

constexpr std::array<std::string_view, 2> kMethods{"margins", "mujoco"};
constexpr std::array<std::string_view, 3> kDesigns{"grid", "lhs", "adaptive"};

template <std::size_t n>
std::size_t index_of(std::string_view word, const std::array<std::string_view, n>& words, const char* what) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    throw InputError(std::string("unknown ") + what + " '" + std::string(word) + "'" + suggestion(word, words));
  return static_cast<std::size_t>(found - words.begin());
}

double parse_number(std::string_view text, std::string_view part) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw InputError("gains '" + std::string(part) + "': '" + std::string(text) +
                     "' is not a number; wanted is for example k=100:3000:8,b=0:5:4");
  return value;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

GainRange parse_range(std::string_view text, std::string_view part) {
  std::vector<std::string_view> words = split(text, ':');
  GainRange range;
  if (words.size() == 4 && words.back() == "log") {
    range.logarithmic = true;
    words.pop_back();
  }
  if (words.size() == 1) {
    range.low = range.high = parse_number(words[0], part);
  } else if (words.size() == 3) {
    range.low = parse_number(words[0], part);
    range.high = parse_number(words[1], part);
    const double count = parse_number(words[2], part);
    if (count != std::floor(count) || count < 1 || count > 1e6)
      throw InputError("gains '" + std::string(part) + "': the count must be a whole number from 1 to 1000000");
    range.count = static_cast<int>(count);
  } else {
    throw InputError("gains '" + std::string(part) + "': wanted is LO:HI:N, LO:HI:N:log or one value");
  }
  if (range.low < 0) throw InputError("gains '" + std::string(part) + "': a gain must not be negative");
  if (range.high < range.low) throw InputError("gains '" + std::string(part) + "': the upper end is below the lower");
  if (range.logarithmic && range.low <= 0)
    throw InputError("gains '" + std::string(part) + "': a logarithmic range must begin above zero");
  return range;
}

/// Point i of a Latin hypercube of n in two dimensions: in each the i-th stratum of a shuffled order, anywhere inside
/// it.
std::vector<std::array<double, 2>> latin_hypercube(std::uint64_t seed, int n, std::uint32_t substream) {
  const models::CounterRandom random(seed, models::RandomStream::gain_point, substream);
  std::vector<std::array<double, 2>> shares(static_cast<std::size_t>(n));
  for (std::size_t d = 0; d < 2; ++d) {
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    for (int i = n - 1; i > 0; --i) {  // Fisher and Yates
      const double u = random.uniforms(static_cast<std::uint64_t>(i), d)[0];
      std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(u * (i + 1))]);
    }
    for (int i = 0; i < n; ++i) {
      const double within = random.uniforms(static_cast<std::uint64_t>(i), d)[1];
      shares[static_cast<std::size_t>(i)][d] = (order[static_cast<std::size_t>(i)] + within) / n;
    }
  }
  return shares;
}

}  // namespace

SweepMethod parse_sweep_method(std::string_view text) {
  return static_cast<SweepMethod>(index_of(text, kMethods, "method"));
}
SweepDesign parse_sweep_design(std::string_view text) {
  return static_cast<SweepDesign>(index_of(text, kDesigns, "design"));
}
std::string_view sweep_method_name(SweepMethod method) {
  return kMethods[static_cast<std::size_t>(method)];
}
std::string_view sweep_design_name(SweepDesign design) {
  return kDesigns[static_cast<std::size_t>(design)];
}

double GainRange::at_share(double share) const {
  if (share <= 0 || low == high) return low;
  if (share >= 1) return high;
  return logarithmic ? low * std::pow(high / low, share) : low + (high - low) * share;
}

double GainRange::at(int index) const {
  return count <= 1 ? low : at_share(static_cast<double>(index) / (count - 1));
}

void parse_gain_ranges(std::string_view text, GainRange& stiffness, GainRange& damping) {
  for (const std::string_view part : split(text, ',')) {
    const std::size_t equals = part.find('=');
    const std::string_view key = part.substr(0, equals);
    if (equals == std::string_view::npos || (key != "k" && key != "b"))
      throw InputError("gains '" + std::string(part) +
                       "': wanted is k=LO:HI:N or b=LO:HI:N, stiffness in N/m, damping in Ns/m");
    (key == "k" ? stiffness : damping) = parse_range(part.substr(equals + 1), part);
  }
}

std::vector<SweepCondition> sweep_conditions(const SweepSettings& settings) {
  const std::vector<models::Axis> axes =
      settings.axes.empty() ? std::vector{settings.scenario.wall.axis} : settings.axes;
  const std::vector<int> delays =
      settings.delays.empty() ? std::vector{settings.scenario.loop.delay_samples} : settings.delays;
  std::vector<SweepCondition> conditions;
  for (const models::Axis axis : axes)
    for (const int delay : delays)
      for (int device = 0; device < settings.devices; ++device) {
        SweepCondition c{axis, delay, device};
        if (device > 0) {
          // the two published parameter sets differ by 5 to 13 % on the diagonal; viscous friction was never published
          const models::CounterRandom random(settings.seed, models::RandomStream::gain_point, 0x1000);
          const auto u = random.uniforms(static_cast<std::uint64_t>(device));
          c.mass_factor = 0.9 + 0.2 * u[0];
          c.damping_factor = std::pow(2.0, 2 * u[1] - 1);
        }
        conditions.push_back(c);
      }
  return conditions;
}

std::vector<SweepPoint> first_points(const SweepSettings& settings, std::size_t conditions) {
  std::vector<SweepPoint> points;
  for (std::uint32_t c = 0; c < conditions; ++c) {
    if (settings.design == SweepDesign::latin_hypercube) {
      for (const auto& share : latin_hypercube(settings.seed, settings.points, c))
        points.push_back({c, 0, settings.stiffness.at_share(share[0]), settings.damping.at_share(share[1])});
      continue;
    }
    for (int i = 0; i < settings.stiffness.count; ++i)
      for (int j = 0; j < settings.damping.count; ++j)
        points.push_back({c, 0, settings.stiffness.at(i), settings.damping.at(j)});
  }
  return points;
}

std::vector<SweepPoint> next_points(const SweepSettings& settings, std::size_t conditions,
                                    const std::vector<SweepPoint>& points, const std::vector<double>& stable_share,
                                    int stage) {
  if (settings.design != SweepDesign::adaptive || stage > settings.levels) return {};
  // Points live on a lattice whose step halves with every level: find each by its place on the finest one.
  const int scale = 1 << settings.levels, step = 1 << (settings.levels - stage + 1);
  const int width = (settings.stiffness.count - 1) * scale, height = (settings.damping.count - 1) * scale;
  const auto stiffness = [&](int i) { return settings.stiffness.at_share(static_cast<double>(i) / width); };
  const auto damping = [&](int j) { return settings.damping.at_share(static_cast<double>(j) / height); };
  std::vector<SweepPoint> added;
  for (std::uint32_t c = 0; c < conditions; ++c) {
    std::map<std::pair<double, double>, double> share;
    for (std::size_t p = 0; p < points.size(); ++p)
      if (points[p].condition == c) share[{points[p].stiffness_N_per_m, points[p].damping_Ns_per_m}] = stable_share[p];
    std::map<std::pair<int, int>, bool> wanted;  // ordered: the points' numbers are part of the result
    for (int i = 0; i + step <= width; i += step) {
      for (int j = 0; j + step <= height; j += step) {
        int known = 0, above = 0;
        for (const int a : {i, i + step})
          for (const int b : {j, j + step})
            if (const auto found = share.find({stiffness(a), damping(b)}); found != share.end()) {
              ++known;
              above += found->second >= settings.boundary;
            }
        if (known < 4 || above == 0 || above == 4) continue;
        for (int a = i; a <= i + step; a += step / 2)
          for (int b = j; b <= j + step; b += step / 2)
            if (!share.contains({stiffness(a), damping(b)})) wanted[{a, b}] = true;
      }
    }
    for (const auto& [place, unused] : wanted)
      added.push_back({c, stage, stiffness(place.first), damping(place.second)});
  }
  return added;
}

std::vector<SweepBlock> cut_blocks(const std::vector<SweepPoint>& points, std::size_t from, std::uint64_t arms,
                                   std::uint64_t target, bool whole_points) {
  std::vector<SweepBlock> blocks;
  const std::uint64_t most_arms = whole_points ? arms : std::min(arms, std::max<std::uint64_t>(1, target));
  const std::uint64_t most_points = std::max<std::uint64_t>(1, target / most_arms);
  for (std::size_t first = from; first < points.size();) {
    std::size_t last = first + 1;
    while (last < points.size() && last - first < most_points && points[last].condition == points[first].condition)
      ++last;
    for (std::uint64_t arm = 0; arm < arms; arm += most_arms)
      blocks.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first), arm,
                        std::min(most_arms, arms - arm)});
    first = last;
  }
  return blocks;
}

}  // namespace handloop::studies
