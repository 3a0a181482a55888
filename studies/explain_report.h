#pragma once

#include "io/report.h"
#include "studies/explain.h"

namespace handloop::studies {

/// The page a person reads: verdict, error before and after, the residual and its spectrum, fingerprints, ranking with
/// rivals, parameters with intervals, what it does to the wall, and the next experiment.
io::Report explain_report(const ExplainStudy& study, const ExplainOutcome& outcome);

}  // namespace handloop::studies
