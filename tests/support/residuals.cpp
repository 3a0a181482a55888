#include "tests/support/residuals.h"

#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

namespace handloop::test {
namespace {

struct Worst {
  Check check;
  long count = 0;
};

/// How far a check is from failing, in parts of its bound where that means something.
double slack(const Check& check) {
  const double room = check.at_most ? check.bound - check.residual : check.residual - check.bound;
  return check.bound != 0 ? room / std::abs(check.bound) : room;
}

class Records : public testing::EmptyTestEventListener {
 public:
  void add(Check check) {
    const std::lock_guard lock(mutex_);
    auto [place, is_new] = worst_.try_emplace({std::string(check.file), check.line});
    auto& worst = place->second;
    ++worst.count;
    if (is_new || !(slack(check) >= slack(worst.check))) worst.check = std::move(check);
  }

  void OnTestEnd(const testing::TestInfo& test) override {
    const std::lock_guard lock(mutex_);
    const std::string_view target = std::getenv("HANDLOOP_RESIDUALS");
    const bool to_file = target != "1";
    std::FILE* out = to_file ? std::fopen(std::string(target).c_str(), "a") : stdout;
    if (out == nullptr) {
      std::perror(std::string(target).c_str());
      std::exit(2);
    }
    std::string text;
    for (const auto& [where, worst] : worst_) text += line(test, worst, to_file);
    worst_.clear();
    std::fwrite(text.data(), 1, text.size(), out);
    if (to_file) std::fclose(out);
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<std::string, int>, Worst> worst_;

  static std::string line(const testing::TestInfo& test, const Worst& worst, bool to_file) {
    const auto& check = worst.check;
    std::string_view file = check.file;
    if (const auto at = file.rfind("tests/"); at != file.npos) file.remove_prefix(at);
    std::string text(1024 + check.what.size() + file.size(), '\0');
    const int length =
        to_file
            ? std::snprintf(text.data(), text.size(), "%s.%s\t%.*s:%d\t%.6g\t%s\t%.6g\t%ld\t%s\n",
                            test.test_suite_name(), test.name(), static_cast<int>(file.size()), file.data(), check.line,
                            check.residual, check.at_most ? "<=" : ">=", check.bound, worst.count, check.what.c_str())
            : std::snprintf(text.data(), text.size(), "[ RESIDUAL ] %.*s:%d: %.6g, %s %.6g (worst of %ld): %s\n",
                            static_cast<int>(file.size()), file.data(), check.line, check.residual,
                            check.at_most ? "at most" : "at least", check.bound, worst.count, check.what.c_str());
    text.resize(static_cast<std::size_t>(std::min<int>(length, static_cast<int>(text.size()) - 1)));
    return text;
  }
};

Records& records() {
  // GoogleTest owns its listeners.
  static auto* const listener = [] {
    auto made = std::make_unique<Records>();
    auto* const kept = made.get();
    testing::UnitTest::GetInstance()->listeners().Append(made.release());
    return kept;
  }();
  return *listener;
}

}  // namespace

bool residuals_wanted() {
  static const bool wanted = [] {
    const char* value = std::getenv("HANDLOOP_RESIDUALS");
    return value != nullptr && *value != '\0' && std::string_view(value) != "0";
  }();
  return wanted;
}

void record_residual(Check check) {
  records().add(std::move(check));
}

}  // namespace handloop::test
