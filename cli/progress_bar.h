#pragma once

#include <string>

#include "studies/progress.h"

namespace handloop::cli {

/// A line on the terminal that fills up, with the time left; nothing at all where standard error is a pipe or a file.
/// The line is wiped when the job is done.
studies::Progress progress_bar(std::string what);

}  // namespace handloop::cli
