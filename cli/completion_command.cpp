#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "cli/usage.h"
#include "models/errors.h"

namespace handloop::cli {
namespace {

/// Asks the program itself at each press of the key, so that it never falls behind the commands there are.
// clang-format off
constexpr const char* kBash = R"bash(# handloop completion for bash. Put this into ~/.bashrc:  eval "$(handloop completion bash)"
_handloop() {
  local current=${COMP_WORDS[COMP_CWORD]}
  local answers
  answers=$("${COMP_WORDS[0]}" complete-words "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  COMPREPLY=($(compgen -W "$answers" -- "$current"))
  if [ ${#COMPREPLY[@]} -eq 0 ] && [[ $current != -* ]]; then
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "$current"))
  fi
}
complete -F _handloop handloop
)bash";
// clang-format on

/// Values worth offering, by option.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kValues{
    {{"--axis", "x y z all"},
     {"--grip", "1 2 3 nominal"},
     {"--set", "max 67"},
     {"--percentiles", "ecdf central"},
     {"--base", "arm5 msd"},
     {"--driven-by", "force position"},
     {"--device", "sim comedi udp:// replay:"},
     {"--json", "-"}}};

/// The option of that name ("--axis"), or nullptr.
const CLI::Option* find_option(const CLI::App& app, const std::string& name) {
  for (const auto* option : app.get_options()) {
    if (option->check_name(name)) return option;
  }
  return nullptr;
}

}  // namespace

std::string completions(const CLI::App& program, const std::vector<std::string>& words) {
  const auto* app = &program;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    for (const auto* command : app->get_subcommands([](const CLI::App*) { return true; })) {
      if (command->get_name() != words[i]) continue;
      app = command;
      break;
    }
  }
  const std::string current = words.empty() ? "" : words.back();
  if (words.size() > 1) {
    const auto& previous = words[words.size() - 2];
    for (const auto& [option, values] : kValues) {
      if (previous == option) return std::string(values);
    }
    const auto* option = previous.starts_with("-") ? find_option(*app, previous) : nullptr;
    if (option != nullptr && option->get_items_expected_max() > 0) return {};  // a file, or a number
  }
  if (app->get_name() == "completion") return "bash";
  std::string list;
  if (current.starts_with("-")) {
    for (const auto* option : app->get_options()) {
      for (const auto& name : option->get_lnames()) list += "--" + name + " ";
    }
  } else {
    for (const auto* command : app->get_subcommands([](const CLI::App*) { return true; })) {
      list += command->get_name() + " ";
    }
  }
  return list;
}

void add_completion_command(CLI::App& program) {
  auto* completion = program.add_subcommand("completion", "A script that completes commands and options in a shell");
  const auto shell = std::make_shared<std::string>();
  completion->add_option("shell", *shell, "bash")->required();
  completion->footer("Example: eval \"$(handloop completion bash)\"");
  completion->callback([shell] {
    if (*shell != "bash") throw InputError(fmt::format("completion: '{}' is not known; give bash", *shell));
    fmt::print("{}", kBash);
  });
}

}  // namespace handloop::cli
