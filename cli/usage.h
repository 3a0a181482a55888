#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

/// What a person is told who typed something the program does not know: one line that says what was wrong and what
/// would be right.
namespace handloop::cli {

/// The first word that is not a command although one is expected there, as a message; "" where there is none. Asked
/// before parsing, because the parser would only say that a command is missing.
std::string unknown_command(const CLI::App& program, const std::vector<std::string>& words);

/// Message for an error of the parser: the command it belongs to, the nearest option where one was mistyped, and where
/// to read on.
std::string explain(const CLI::App& program, const CLI::ParseError& error);

/// What may follow the words already typed (the last one is still being typed), separated by blanks; empty where a file
/// or a number is expected. `handloop complete-words WORD...` prints it for the shell.
std::string completions(const CLI::App& program, const std::vector<std::string>& words);

/// A message on one line, without control characters.
std::string one_line(std::string text);

}  // namespace handloop::cli
