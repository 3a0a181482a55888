#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace handloop {
namespace {

using Words = std::vector<std::string>;

test::ProgramRun handloop(const Words& words) {
  return test::run_program(HANDLOOP_PROGRAM, words);
}

std::string joined(const Words& words) {
  std::string text;
  for (const auto& word : words) text += word + " ";
  return text;
}

Words words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// Every command of the program, as typed: {"arm", "show"}.
std::vector<Words> all_commands() {
  std::vector<Words> found;
  const std::function<void(const Words&)> visit = [&](const Words& path) {
    Words question{"complete-words"};
    question.insert(question.end(), path.begin(), path.end());
    question.push_back("");
    const auto below = words_of(handloop(question).out);
    for (const auto& name : below) {
      if (path.size() == 1 && path.front() == "completion") break;  // these are shells
      auto deeper = path;
      deeper.push_back(name);
      visit(deeper);
    }
    if (!path.empty()) found.push_back(path);
  };
  visit({});
  return found;
}

void expect_refused(const Words& words, const std::vector<std::string>& expected) {
  const auto run = handloop(words);
  EXPECT_EQ(run.exit_code, 2) << joined(words);
  EXPECT_TRUE(run.out.empty()) << run.out;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  for (const auto& word : expected)
    EXPECT_NE(run.err.find(word), std::string::npos) << "'" << word << "' in: " << run.err;
}

TEST(Usage, UnknownWordsAreAnsweredWithTheNearestKnownOne) {
  expect_refused({}, {"say what to do", "arm", "--help"});
  expect_refused({"frobnicate"}, {"unknown command 'frobnicate'", "arm"});
  expect_refused({"marigns", "--json", "-"}, {"unknown command 'marigns'", "did you mean 'margins'"});
  expect_refused({"arm"}, {"arm: say what to do", "show"});
  expect_refused({"arm", "shwo"}, {"arm: unknown command 'shwo'", "did you mean 'show'"});
  expect_refused({"arm", "show", "--axes", "x"}, {"arm show", "--axes", "did you mean --axis"});
  expect_refused({"arm", "show", "--axis"}, {"arm show", "--axis needs a value"});
  expect_refused({"arm", "show", "--axis", "q"}, {"'q'", "left-right"});
  expect_refused({"arm", "show", "--axis", "x", "surplus"}, {"'surplus' is not expected"});
  expect_refused({"arm", "sample", "--axis", "x", "--count", "many", "--out", "-"}, {"--count", "'many'"});
  expect_refused({"--jsn"}, {"unknown option --jsn"});
  expect_refused({"completion", "fish"}, {"'fish'", "bash"});
}

TEST(Usage, MessagesStayOnOneLineWhateverWasTyped) {
  expect_refused({"arm\nshow"}, {"unknown command"});
  expect_refused({"arm", "show", "--axis", "x\ny\x1b[31m"}, {"unknown axis"});
}

TEST(Usage, EveryCommandExplainsItselfWithAnExample) {
  const auto commands = all_commands();
  EXPECT_GE(commands.size(), 5U);
  for (const auto& command : commands) {
    auto words = command;
    words.push_back("--help");
    const auto run = handloop(words);
    EXPECT_EQ(run.exit_code, 0) << joined(words);
    // An example of this command, not of the program.
    const auto path = joined(command);
    const auto example = run.out.find("Example");
    EXPECT_NE(example, std::string::npos) << path << "ends without an example";
    if (example != std::string::npos && command.front() != "completion") {
      EXPECT_NE(run.out.substr(example).find("handloop " + path), std::string::npos) << path;
    }
    EXPECT_TRUE(run.err.empty()) << run.err;
  }
}

TEST(Usage, EveryCommandRefusesAnOptionItDoesNotKnow) {
  for (auto command : all_commands()) {
    command.push_back("--no-such-option");
    const auto run = handloop(command);
    EXPECT_EQ(run.exit_code, 2) << joined(command);
    EXPECT_LE(std::count(run.err.begin(), run.err.end(), '\n'), 3) << run.err;
  }
}

TEST(Usage, CompletionOffersWhatMayFollow) {
  const auto has = [](const Words& typed, const std::string& word) {
    Words question{"complete-words"};
    question.insert(question.end(), typed.begin(), typed.end());
    const auto answers = words_of(handloop(question).out);
    return std::find(answers.begin(), answers.end(), word) != answers.end();
  };
  EXPECT_TRUE(has({""}, "margins"));
  EXPECT_TRUE(has({"arm", "s"}, "show"));
  EXPECT_TRUE(has({"arm", "show", "--"}, "--axis"));
  EXPECT_TRUE(has({"arm", "show", "--axis", ""}, "x"));
  EXPECT_FALSE(has({"arm", "show", "--model", ""}, "x"));
  const auto script = handloop({"completion", "bash"});
  EXPECT_EQ(test::run_program("/bin/bash", {"-n", "-c", script.out}).exit_code, 0) << "valid bash";
}

TEST(Usage, FullDiskIsNotSuccess) {
  const auto run =
      test::run_program("/bin/sh", {"-c", std::string(HANDLOOP_PROGRAM) + " arm show --axis x > /dev/full"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("standard output"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace handloop
