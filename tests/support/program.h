#pragma once

#include <string>
#include <vector>

namespace handloop::test {

/// What the handloop program printed and how it ended.
struct ProgramRun {
  int exit_code = -1;  ///< -1 where a signal ended it
  std::string out, err;
};

/// Runs a program with arguments (no shell between), standard input closed. working_directory empty: the current one.
ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments,
                       const std::string& working_directory = "");

}  // namespace handloop::test
