#include "io/output.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "models/errors.h"

namespace handloop::io {
namespace {
namespace fs = std::filesystem;

class Output : public testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("handloop_output_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Number of entries, hidden ones included.
  static std::ptrdiff_t entries(const fs::path& path) {
    return std::distance(fs::directory_iterator(path), fs::directory_iterator());
  }
  static void make(const fs::path& target, std::initializer_list<const char*> names) {
    OutputDirectory out(target);
    for (const auto* name : names) write_file_atomically(out / name, name);
    out.commit();
  }
};

TEST_F(Output, FileAppearsWholeAndReplacesTheOldOne) {
  write_file_atomically(folder / "a.txt", "one");
  write_file_atomically(folder / "a.txt", "two");
  EXPECT_EQ(read(folder / "a.txt"), "two");
  EXPECT_EQ(entries(folder), 1);
}

TEST_F(Output, FileThatIsNotCommittedLeavesNothing) {
  {
    OutputFile file(folder / "a.txt");
    file.write(std::string(1 << 20, 'x'));
    file.write("tail");
  }
  EXPECT_EQ(entries(folder), 0);
}

TEST_F(Output, LargeFileKeepsItsOrder) {
  std::string expected;
  OutputFile file(folder / "a.txt");
  for (int i = 0; i < 100000; ++i) {
    const auto piece = std::to_string(i) + "\n";
    expected += piece;
    file.write(piece);
    if (i == 50000) {
      const std::string big(1 << 19, 'b');
      expected += big;
      file.write(big);
    }
  }
  file.commit();
  EXPECT_EQ(read(folder / "a.txt"), expected);
}

TEST_F(Output, LinkStaysALink) {
  write_file_atomically(folder / "real.txt", "one");
  fs::create_symlink("real.txt", folder / "link.txt");
  write_file_atomically(folder / "link.txt", "two");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read(folder / "real.txt"), "two");
}

TEST_F(Output, ImpossiblePlacesAreRefusedByName) {
  for (const fs::path path : {"/proc/none/z.csv", "/nowhere/at/all.csv"}) {
    try {
      write_file_atomically(path, "x");
      FAIL() << path;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(write_file_atomically(folder, "x"), InputError);
  EXPECT_THROW(OutputDirectory("/proc/none/out"), InputError);
  write_file_atomically(folder / "file", "x");
  EXPECT_THROW(OutputDirectory(folder / "file"), InputError);
  EXPECT_THROW(OutputDirectory(folder / "file" / "deeper"), InputError);
}

TEST_F(Output, DirectoryAppearsWithItsParents) {
  make(folder / "a" / "b" / "out", {"x.csv"});
  EXPECT_EQ(read(folder / "a" / "b" / "out" / "x.csv"), "x.csv");
  EXPECT_EQ(entries(folder / "a" / "b"), 1);
}

TEST_F(Output, DirectoryThatIsNotCommittedLeavesNothing) {
  {
    OutputDirectory out(folder / "a" / "b" / "out");
    write_file_atomically(out / "x.csv", "x");
  }
  EXPECT_EQ(entries(folder), 0);
}

TEST_F(Output, NewResultReplacesAnOlderOneAsAWhole) {
  make(folder / "out", {"old.csv", "both.csv"});
  make(folder / "out", {"both.csv", "new.csv"});
  EXPECT_FALSE(fs::exists(folder / "out" / "old.csv"));
  EXPECT_TRUE(fs::exists(folder / "out" / "both.csv"));
  EXPECT_TRUE(fs::exists(folder / "out" / "new.csv"));
  EXPECT_EQ(entries(folder), 1);
}

TEST_F(Output, FilesOfAPersonAreLeftAlone) {
  fs::create_directories(folder / "out");
  write_file_atomically(folder / "out" / "thesis.txt", "mine");
  make(folder / "out", {"x.csv"});
  make(folder / "out", {"x.csv", "y.csv"});
  EXPECT_EQ(read(folder / "out" / "thesis.txt"), "mine");
  EXPECT_TRUE(fs::exists(folder / "out" / "y.csv"));
  EXPECT_EQ(entries(folder), 1);
}

TEST_F(Output, DirectoryMayBeNamedWithASlashAtTheEnd) {
  make(folder / "out/", {"x.csv"});
  EXPECT_TRUE(fs::exists(folder / "out" / "x.csv"));
}

}  // namespace
}  // namespace handloop::io
