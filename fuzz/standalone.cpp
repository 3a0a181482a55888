// Feeds a fuzz target its seeds and repeatable mutations of them, where libFuzzer is not at hand.
//   fuzz_csv COUNT FOLDER_OR_FILE...
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void feed(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

class Mutator {
 public:
  explicit Mutator(const std::vector<std::string>& seeds) : seeds_(&seeds) {}

  std::string next() {
    auto text = (*seeds_)[below(seeds_->size())];
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(text);
    return text;
  }

 private:
  const std::vector<std::string>* seeds_;
  std::mt19937_64 random_{20121};

  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : random_() % limit; }

  void change(std::string& text) {
    static constexpr std::string_view kPieces[] = {
        "nan", "-inf", "1e999", ",",   "\n", "\r\n", "\"",  "[",    "]", "[[",       "=", ".",
        "-",   "\0",   "#",     "'''", "{",  "}",    "0x1", "1e-9", ";", "\xff\xfe", "0", "9999999999999999999"};
    const auto at = below(text.size() + 1);
    switch (below(6)) {
      case 0:  // one bit
        if (!text.empty()) text[below(text.size())] ^= static_cast<char>(1U << below(8));
        break;
      case 1:  // something a parser may stumble over
        text.insert(at, kPieces[below(std::size(kPieces))]);
        break;
      case 2:  // a part is missing
        text.erase(at, below(text.size() / 4 + 2));
        break;
      case 3:  // a part comes twice
        text.insert(below(text.size() + 1), text.substr(at, below(64)));
        break;
      case 4:  // cut off
        text.resize(at);
        break;
      default: {  // a part of another seed
        const auto& other = (*seeds_)[below(seeds_->size())];
        text.insert(at, other.substr(below(other.size() + 1), below(128)));
      }
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s COUNT FOLDER_OR_FILE...\n", argv[0]);
    return 2;
  }
  const auto count = std::strtoul(argv[1], nullptr, 10);
  std::vector<fs::path> paths;
  for (int i = 2; i < argc; ++i) {
    if (fs::is_directory(argv[i])) {
      for (const auto& entry : fs::directory_iterator(argv[i])) paths.push_back(entry.path());
    } else {
      paths.emplace_back(argv[i]);
    }
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> seeds{""};
  for (const auto& path : paths) seeds.push_back(read(path));
  for (const auto& seed : seeds) feed(seed);
  Mutator mutator(seeds);
  for (unsigned long i = 0; i < count; ++i) {
    const auto input = mutator.next();
    if (std::getenv("HANDLOOP_FUZZ_KEEP") != nullptr) {  // leaves the input that ends the program
      std::ofstream(std::getenv("HANDLOOP_FUZZ_KEEP"), std::ios::binary) << input;
    }
    feed(input);
  }
  std::printf("%zu seeds and %lu mutations\n", seeds.size(), count);
  return 0;
}
