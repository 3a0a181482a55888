#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>

#include "io/mapped_file.h"
#include "io/output.h"

namespace handloop {
namespace {

/// The lines of a source file between two comments "// [tag]".
std::string part(const std::string& source, const std::string& tag) {
  const std::string mark = "// [" + tag + "]\n";
  const auto from = source.find(mark);
  const auto to = source.find(mark, from + mark.size());
  if (from == source.npos || to == source.npos) return {};
  return source.substr(from + mark.size(), to - from - mark.size());
}

// The examples are built and run by install.examples; what the guide shows of them is what runs.
// HANDLOOP_UPDATE_DOCS=1 writes the blocks again.
TEST(Documentation, CodeOfTheWorkedExamplesIsThatOfTheFiles) {
  const std::filesystem::path root(HANDLOOP_SOURCE_DIR);
  const auto guide = root / "docs/extending.md";
  const auto text = io::read_file(guide);
  const std::regex block(R"(<!-- (examples/\w+\.cpp) \[(\w+)\] -->\n```cpp\n)");
  std::string updated;
  std::size_t done = 0, blocks = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), block), end; match != end; ++match, ++blocks) {
    const auto code_at = static_cast<std::size_t>(match->position() + match->length());
    const auto code_end = text.find("```\n", code_at);
    ASSERT_NE(code_end, text.npos);
    const auto expected = part(io::read_file(root / (*match)[1].str()), (*match)[2].str());
    EXPECT_FALSE(expected.empty()) << (*match)[0];
    EXPECT_EQ(text.substr(code_at, code_end - code_at), expected) << (*match)[0];
    updated += text.substr(done, code_at - done) + expected;
    done = code_end;
  }
  updated += text.substr(done);
  EXPECT_EQ(blocks, 4U);
  if (std::getenv("HANDLOOP_UPDATE_DOCS") != nullptr) io::write_file_atomically(guide, updated);
}

}  // namespace
}  // namespace handloop
