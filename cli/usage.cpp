#include "cli/usage.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "models/suggest.h"

namespace handloop::cli {
namespace {

bool is_option(const std::string& word) {
  return word.size() > 1 && word.front() == '-';
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  auto commands = app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
  return {commands.begin(), commands.end()};
}

std::string names_of(const std::vector<const CLI::App*>& commands) {
  std::string names;
  for (const auto* command : commands) names += fmt::format("{}{}", names.empty() ? "" : ", ", command->get_name());
  return names;
}

/// The innermost command that was named.
const CLI::App& innermost(const CLI::App& program) {
  const auto* app = &program;
  for (auto parsed = app->get_subcommands(); !parsed.empty(); parsed = app->get_subcommands()) app = parsed.front();
  return *app;
}

/// "arm show", or "" for the program itself.
std::string path_of(const CLI::App& app) {
  if (app.get_parent() == nullptr) return {};
  const auto before = path_of(*app.get_parent());
  return before.empty() ? app.get_name() : before + " " + app.get_name();
}

std::string prefix_of(const CLI::App& app) {
  const auto path = path_of(app);
  return path.empty() ? path : path + ": ";
}

std::string help_of(const CLI::App& app) {
  const auto path = path_of(app);
  return fmt::format("see handloop {}--help", path.empty() ? "" : path + " ");
}

/// The parser's own words where they are good, better ones where they are not.
std::string reworded(const CLI::ParseError& error) {
  static const std::regex missing(R"((--?[\w-]+): (\d+) required .* missing)");
  static const std::regex range(R"((.+): Value (.*) not in range \[?(\S+) (?:to|-) ([^\s\]]+)\]?)");  // 2.1 and 2.4
  static const std::regex conversion(R"(Could not convert: (.+) = (.*))");
  const std::string text = error.what();
  std::smatch found;
  if (std::regex_match(text, found, missing)) return fmt::format("{} needs a value after it", found[1].str());
  if (std::regex_match(text, found, range)) {
    return fmt::format("{}: '{}' is not possible; give a number from {} to {}", found[1].str(), found[2].str(),
                       found[3].str(), found[4].str());
  }
  if (std::regex_match(text, found, conversion)) {
    return fmt::format("{}: '{}' is not a number of the kind it takes", found[1].str(), found[2].str());
  }
  return text;
}

std::string unexpected(const CLI::App& app, const std::string& word) {
  if (!is_option(word)) return fmt::format("'{}' is not expected here", word);
  const auto name = word.substr(0, word.find('='));
  std::vector<std::string> owned;
  for (const auto* option : app.get_options()) {
    for (const auto& long_name : option->get_lnames()) owned.push_back("--" + long_name);
  }
  const std::vector<std::string_view> known(owned.begin(), owned.end());
  const auto nearest = nearest_word(name, known);
  if (!nearest.empty()) return fmt::format("unknown option {}; did you mean {}?", name, nearest);
  return fmt::format("unknown option {}", name);
}

}  // namespace

std::string unknown_command(const CLI::App& program, const std::vector<std::string>& words) {
  const auto* app = &program;
  for (const auto& word : words) {
    const auto commands = commands_of(*app);
    if (commands.empty()) return {};
    if (is_option(word)) {
      const auto options = app->get_options();
      const bool known =
          std::any_of(options.begin(), options.end(), [&](const auto* o) { return o->check_name(word); });
      return known ? std::string() : fmt::format("{}; {}", unexpected(*app, word), help_of(*app));
    }
    const auto found = std::find_if(commands.begin(), commands.end(),
                                    [&](const auto* command) { return command->get_name() == word; });
    if (found == commands.end()) {
      std::vector<std::string> owned;
      for (const auto* command : commands) owned.push_back(command->get_name());
      const std::vector<std::string_view> known(owned.begin(), owned.end());
      return fmt::format("{}unknown command '{}'{}", prefix_of(*app), word, suggestion(word, known));
    }
    app = *found;
  }
  return {};
}

std::string explain(const CLI::App& program, const CLI::ParseError& error) {
  const auto& app = innermost(program);
  const auto help = help_of(app);
  const auto prefix = prefix_of(app);
  const auto commands = commands_of(app);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !commands.empty()) {
    return fmt::format("{}say what to do: {}; {}", prefix, names_of(commands), help);
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const auto words = program.remaining(true);
    if (!words.empty()) {
      // An option is more telling than the value that follows it.
      const auto option = std::find_if(words.begin(), words.end(), is_option);
      return fmt::format("{}{}; {}", prefix, unexpected(app, option != words.end() ? *option : words.front()), help);
    }
  }
  return fmt::format("{}{}; {}", prefix, reworded(error), help);
}

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (auto at = text.find('\n'); at != std::string::npos; at = text.find('\n')) text.replace(at, 1, "; ");
  for (auto& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return text;
}

}  // namespace handloop::cli
