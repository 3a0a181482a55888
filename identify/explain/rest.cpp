#include "identify/explain/rest.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "identify/explain/force_view.h"
#include "identify/explain/signals.h"
#include "models/effects/tabulated.h"

namespace handloop::identify {
namespace {

using Grid = models::TabulatedGrid;
constexpr auto kKnots = static_cast<Eigen::Index>(Grid::kDisplacements * Grid::kVelocities);

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// Second differences of the table along both its directions, each a row.
Eigen::MatrixXd roughness() {
  std::vector<Eigen::RowVectorXd> rows;
  const auto at = [](std::size_t i, std::size_t j) { return static_cast<Eigen::Index>(i * Grid::kVelocities + j); };
  const auto add = [&](Eigen::Index a, Eigen::Index b, Eigen::Index c) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(kKnots);
    row[a] = 1;
    row[b] = -2;
    row[c] = 1;
    rows.push_back(row);
  };
  for (std::size_t i = 0; i < Grid::kDisplacements; ++i) {
    for (std::size_t j = 0; j < Grid::kVelocities; ++j) {
      if (i > 0 && i + 1 < Grid::kDisplacements) add(at(i - 1, j), at(i, j), at(i + 1, j));
      if (j > 0 && j + 1 < Grid::kVelocities) add(at(i, j - 1), at(i, j), at(i, j + 1));
    }
  }
  Eigen::MatrixXd matrix(rows.size(), kKnots);
  for (std::size_t r = 0; r < rows.size(); ++r) matrix.row(static_cast<Eigen::Index>(r)) = rows[r];
  return matrix;
}

constexpr Eigen::Index kPlainShapes = 11;

/// Plain laws of displacement and velocity at the knots, in shares of the ranges: damping and friction that depend on
/// displacement, springs that depend on the direction of motion, stops, and the odd and even powers.
Eigen::MatrixXd plain_shapes() {
  Eigen::MatrixXd shapes(kKnots, kPlainShapes);
  for (std::size_t i = 0; i < Grid::kDisplacements; ++i) {
    for (std::size_t j = 0; j < Grid::kVelocities; ++j) {
      const double x = Grid::kDisplacementKnots[i], v = Grid::kVelocityKnots[j];
      const double sign = v == 0 ? 0.0 : std::copysign(1.0, v);
      shapes.row(static_cast<Eigen::Index>(i * Grid::kVelocities + j)) << std::abs(x) * v, x * x * v,
          std::abs(x) * sign, sign, x * sign, x * std::abs(v), v * std::abs(v), x * x, x * x * x,
          std::max(x - 0.4, 0.0), std::max(-x - 0.4, 0.0);
    }
  }
  return shapes;
}

using Corners = std::vector<std::array<Grid::Corner, 4>>;

/// Where the motion passes through the table, and how often it visits each knot.
Corners pass_through(const PlaceMotion& motion, const std::array<double, 3>& frame, Eigen::VectorXd& visits) {
  Corners corners(motion.x_m.size());
  visits = Eigen::VectorXd::Zero(kKnots);
  for (std::size_t n = 0; n < corners.size(); ++n) {
    corners[n] = Grid::corners((motion.x_m[n] - frame[0]) / frame[1], motion.v_m_per_s[n] / frame[2]);
    for (const auto& corner : corners[n]) visits[static_cast<Eigen::Index>(corner.index)] += corner.weight;
  }
  return corners;
}

/// One column for each knot: what `see` makes of one newton there along the motion.
template <class See>
Eigen::MatrixXd knot_columns(const Corners& corners, Eigen::Index rows, const See& see) {
  Eigen::MatrixXd columns(rows, kKnots);
  std::vector<double> force(corners.size());
  for (Eigen::Index k = 0; k < kKnots; ++k) {
    for (std::size_t n = 0; n < corners.size(); ++n) {
      force[n] = 0.0;
      for (const auto& corner : corners[n]) {
        if (static_cast<Eigen::Index>(corner.index) == k) force[n] += corner.weight;
      }
    }
    columns.col(k) = see(force);
  }
  return columns;
}

/// Smoothing by five-fold cross-validation over contiguous blocks, from normal equations of each block.
Eigen::VectorXd solve_smoothed(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, Eigen::Index own,
                               const Eigen::VectorXd& knot_prior, const Eigen::MatrixXd& rough, double& smoothing) {
  constexpr int kFolds = 5;
  const Eigen::Index rows = columns.rows(), size = columns.cols(), fold = rows / kFolds;
  std::array<Eigen::MatrixXd, kFolds> information;
  std::array<Eigen::VectorXd, kFolds> right;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd all_right = Eigen::VectorXd::Zero(size);
  for (int f = 0; f < kFolds; ++f) {
    const auto part = columns.middleRows(f * fold, fold);
    information[f] = part.transpose() * part;
    right[f] = part.transpose() * target.segment(f * fold, fold);
    all += information[f];
    all_right += right[f];
  }
  Eigen::MatrixXd penalty = Eigen::MatrixXd::Zero(size, size);
  penalty.bottomRightCorner(kKnots, kKnots) =
      rough.transpose() * rough + 1e-3 * Eigen::MatrixXd::Identity(kKnots, kKnots);
  // the penalty is on the whole table, not on its change
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(size);
  pull.tail(kKnots) = -penalty.bottomRightCorner(kKnots, kKnots) * knot_prior;
  const double unit = all.bottomRightCorner(kKnots, kKnots).trace() / static_cast<double>(kKnots);
  const Eigen::VectorXd ridge = Eigen::VectorXd::Constant(size, 1e-12 * all.trace());
  const auto solve = [&](const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double level) -> Eigen::VectorXd {
    Eigen::MatrixXd matrix = a + level * penalty;
    matrix.diagonal() += 1e-9 * a.diagonal().head(size) + ridge * (own > 0 ? 1e-6 : 0.0);
    return matrix.ldlt().solve(b + level * pull);
  };
  double best = std::numeric_limits<double>::infinity();
  for (double level = 1e-4; level < 3e2; level *= 6) {
    double error = 0;
    for (int f = 0; f < kFolds; ++f) {
      const auto solution = solve(all - information[f], all_right - right[f], level * unit);
      error += (target.segment(f * fold, fold) - columns.middleRows(f * fold, fold) * solution).squaredNorm();
    }
    if (error < best) {
      best = error;
      smoothing = level;
    }
  }
  return solve(all, all_right, smoothing * unit);
}

void describe(Rest& rest, const Eigen::VectorXd& forces, const Eigen::VectorXd& visits) {
  constexpr auto kRows = static_cast<Eigen::Index>(Grid::kDisplacements),
                 kColumns = static_cast<Eigen::Index>(Grid::kVelocities);
  const double total = visits.sum();
  const double mean = forces.dot(visits) / total;
  Eigen::VectorXd row = Eigen::VectorXd::Zero(kRows), column = Eigen::VectorXd::Zero(kColumns), row_weight = row,
                  column_weight = column;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    for (Eigen::Index j = 0; j < kColumns; ++j) {
      const double weight = visits[i * kColumns + j], force = forces[i * kColumns + j] - mean;
      row[i] += weight * force;
      row_weight[i] += weight;
      column[j] += weight * force;
      column_weight[j] += weight;
    }
  }
  double power = 0, power_x = 0, power_v = 0;
  for (Eigen::Index i = 0; i < kRows; ++i) power_x += row_weight[i] > 0 ? row[i] * row[i] / row_weight[i] : 0;
  for (Eigen::Index j = 0; j < kColumns; ++j)
    power_v += column_weight[j] > 0 ? column[j] * column[j] / column_weight[j] : 0;
  for (Eigen::Index k = 0; k < kKnots; ++k) power += visits[k] * (forces[k] - mean) * (forces[k] - mean);
  if (!(power > 0)) return;
  rest.by_displacement = std::min(1.0, power_x / power);
  rest.by_velocity = std::min(1.0, power_v / power);
  rest.by_both = std::max(0.0, 1 - rest.by_displacement - rest.by_velocity);
  const char* main = rest.by_displacement > 0.6 ? "mostly a function of displacement"
                     : rest.by_velocity > 0.6   ? "mostly a function of velocity"
                                                : "a function of displacement and velocity together";
  char text[320];
  std::snprintf(
      text, sizeof text,
      "a force at the arm, %s (%.0f %% by displacement alone, %.0f %% by velocity alone, %.0f %% needs both); %.3g rms",
      main, 100 * rest.by_displacement, 100 * rest.by_velocity, 100 * rest.by_both, std::sqrt(power / total));
  rest.description = text;
}

}  // namespace

std::optional<Rest> fit_rest(const Prediction& given, const Hypothesis& from) {
  const Prediction prediction = with_hold(given, from.hold);
  const auto start = prediction.run(from.model, true);
  if (!start.finite) return std::nullopt;
  const auto recorded = prediction.recorded_motion(from.model);
  const auto [lowest, highest] = std::ranges::minmax(recorded.arm.x_m);
  const double centre = 0.5 * (lowest + highest);
  // a grasp that fits nothing makes motions without bound of the record
  const auto& bounds = models::find_effect_type("tabulated").info.parameters;
  std::array frame{centre, 0.5 * (highest - lowest), largest(recorded.arm.v_m_per_s)};
  for (std::size_t i = 0; i < frame.size(); ++i) frame[i] = std::clamp(frame[i], bounds[i].lower, bounds[i].upper);
  Rest rest{from, 0, 0, 0, ""};
  const int number = static_cast<int>(from.model.effects.size());
  std::vector<double> values(Grid::kParameters, 0.0);
  std::copy(frame.begin(), frame.end(), values.begin());
  rest.hypothesis.model.effects.push_back(models::make_effect("tabulated", models::Place::arm, values));
  const auto rough = roughness();
  double cost = from.train_cost, smoothing = 1.0;
  Eigen::VectorXd visits, forces = Eigen::VectorXd::Zero(kKnots);
  // the table by regression, the model's own parameters by a short fit on top of it; true where that is better
  const auto take = [&](const Eigen::VectorXd& wanted, models::AxisModel model, int iterations) {
    // a constant force is an offset, which the selection filter does not see: not the table's to hold
    const Eigen::VectorXd table = wanted.array() - wanted.dot(visits) / visits.sum();
    std::copy(table.data(), table.data() + kKnots, values.begin() + static_cast<std::ptrdiff_t>(Grid::kFirstForce));
    model.effects[number] = models::make_effect("tabulated", models::Place::arm, values);
    const auto fitted = fit(prediction, model, from.free, {.most_iterations = iterations, .tolerance = 1e-4});
    if (!fitted.ok || !(fitted.cost < 0.999 * cost)) return false;
    cost = fitted.cost;
    rest.hypothesis.model = fitted.model;
    forces = table;
    return true;
  };
  if (prediction.driven_by() == DrivenBy::force && from.model.base == models::BaseModel::arm5) {
    // along the recorded motion first: the simulated one may be far from it
    const ForceView view(prediction, from.model);
    const auto own = static_cast<Eigen::Index>(view.known().size());
    Eigen::MatrixXd columns(view.force().size(), own + kKnots);
    for (Eigen::Index j = 0; j < own; ++j) columns.col(j) = view.known()[static_cast<std::size_t>(j)];
    const auto corners = pass_through(view.motion().arm, frame, visits);
    columns.rightCols(kKnots) =
        knot_columns(corners, columns.rows(), [&](const auto& force) { return view.seen(force); });
    const auto begin = [&](const Eigen::VectorXd& own_part, const Eigen::VectorXd& table) {
      auto model = rest.hypothesis.model;
      model.arm = view.arm_with(own_part);
      take(table, model, 12);
    };
    const Eigen::VectorXd solution = solve_smoothed(columns, view.force(), own, forces, rough, smoothing);
    begin(solution.head(own), solution.tail(kKnots));
    // under much noise a hundred knots wander: a few plain shapes hold still
    Eigen::MatrixXd shaped(columns.rows(), own + kPlainShapes);
    const Eigen::MatrixXd shapes = plain_shapes();
    shaped << columns.leftCols(own), columns.rightCols(kKnots) * shapes;
    const Eigen::VectorXd few = shaped.colPivHouseholderQr().solve(view.force());
    begin(few.head(own), shapes * few.tail(kPlainShapes));
  }
  for (int pass = 0; pass < 4; ++pass) {
    const auto motion = prediction.run(rest.hypothesis.model, true);
    const auto residual = prediction.train_residual(rest.hypothesis.model);
    const Eigen::MatrixXd own = sensitivity(prediction, rest.hypothesis.model, from.free);
    Eigen::MatrixXd columns(own.rows(), own.cols() + kKnots);
    columns.leftCols(own.cols()) = own;
    const auto corners = pass_through(motion.arm, frame, visits);
    columns.rightCols(kKnots) = knot_columns(corners, own.rows(), [&](const auto& force) -> Eigen::VectorXd {
      const auto response = response_to_force(rest.hypothesis.model, models::Place::arm, force, prediction.driven_by(),
                                              prediction.options(false));
      const auto filtered = prediction.filtered_train(response);
      return Eigen::Map<const Eigen::VectorXd>(filtered.data(), static_cast<Eigen::Index>(filtered.size()));
    });
    const Eigen::VectorXd target =
        Eigen::Map<const Eigen::VectorXd>(residual.data(), static_cast<Eigen::Index>(residual.size()));
    const Eigen::VectorXd change = solve_smoothed(columns, target, own.cols(), forces, rough, smoothing);
    const double before = cost;
    for (const double share : {1.0, 0.5, 0.2}) {
      if (take(forces + share * change.tail(kKnots), rest.hypothesis.model, 4)) break;
    }
    if (!(cost < 0.97 * before)) break;
  }
  if (!(cost < from.train_cost)) return std::nullopt;
  rest.hypothesis.train_cost = cost;
  rest.hypothesis.errors = prediction.errors(rest.hypothesis.model);
  if (!rest.hypothesis.errors.finite) return std::nullopt;
  describe(rest, forces, visits);
  return rest;
}

}  // namespace handloop::identify
