#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/explain/prediction.h"

namespace handloop::identify {

/// One parameter that a fit may change: of the base model, or of an effect. Where the range allows, the search runs
/// over its logarithm.
struct FreeParameter {
  std::string name;  ///< key of the model file
  int effect = -1;   ///< index among the model's effects; -1: base model
  int index = 0;     ///< among the base model's or the effect's parameters
  double lower = 0.0, upper = 0.0;
  bool logarithmic = false;
  double scale = 1.0;  ///< unit of the search where it is not logarithmic
};

/// Free parameters of the base model.
std::vector<FreeParameter> base_parameters(const models::AxisModel& model);
/// Values of free parameters in a model, and the model with other values.
Eigen::VectorXd get_values(const models::AxisModel& model, const std::vector<FreeParameter>& free);
models::AxisModel with_values(const models::AxisModel& model, const std::vector<FreeParameter>& free,
                              const Eigen::VectorXd& values);

struct FitOptions {
  int most_iterations = 30;
  double tolerance = 1e-7;  ///< relative change of the cost at which it has converged
};

struct Fit {
  models::AxisModel model;
  std::vector<FreeParameter> free;
  double cost = 0.0;  ///< mean square of the filtered training error
  bool ok = false;    ///< false: no finite run was found
  int iterations = 0;
};

/// Least squares of the filtered training error over the free parameters (Levenberg-Marquardt with bounds,
/// forward differences). Never throws; a model that cannot be run gives ok = false.
Fit fit(const Prediction& prediction, const models::AxisModel& start, const std::vector<FreeParameter>& free,
        const FitOptions& options = {});

/// Sensitivity of the filtered, thinned prediction to each free parameter, in its search unit: residuals x parameters.
Eigen::MatrixXd sensitivity(const Prediction& prediction, const models::AxisModel& model,
                            const std::vector<FreeParameter>& free);

/// 95 % half-widths of the free parameters, in the parameters' own units: sandwich covariance over blocks of one
/// second, so that coloured residuals count for what they are; infinite where a parameter is not determined.
Eigen::VectorXd half_widths95(const Prediction& prediction, const models::AxisModel& model,
                              const std::vector<FreeParameter>& free);

}  // namespace handloop::identify
