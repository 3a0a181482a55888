#include "io/mat_elements.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>

/// MAT-File Format (The MathWorks), "Level 5 MAT-files": a header of 128 bytes, then elements of a tag and data.
namespace handloop::io::detail {
namespace {

constexpr std::size_t kHeaderBytes = 128;
constexpr std::uint32_t kMatrix = 14, kCompressed = 15;
constexpr std::uint32_t kFirstNumericClass = 6, kLastNumericClass = 15;
/// Deflate cannot shrink by more than about 1032.
constexpr std::size_t kMostShrunk = 1100;

/// Bytes a number of a data type takes, 0 where it is no number.
std::size_t bytes_of_type(std::uint32_t type) {
  constexpr std::array<std::size_t, 14> kBytes{0, 1, 1, 2, 2, 4, 4, 4, 0, 8, 0, 0, 8, 8};
  return type < kBytes.size() ? kBytes[type] : 0;
}

/// One element: its type, its data as far as present, and the bytes it takes with tag and padding.
struct Element {
  std::uint32_t type = 0;
  std::size_t size = 0;  ///< claimed
  std::string_view data;
  std::size_t total = 0;
};

class Reader {
 public:
  explicit Reader(bool swapped) : swapped_(swapped) {}

  std::uint32_t number(std::string_view bytes, std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return swapped_ ? (value >> 24) | ((value >> 8) & 0xff00U) | ((value << 8) & 0xff0000U) | (value << 24) : value;
  }

  /// The element at the start of the bytes; nothing where not even its tag is there.
  std::optional<Element> element(std::string_view bytes) const {
    if (bytes.size() < 8) return std::nullopt;
    const auto first = number(bytes, 0);
    Element e;
    if (first >> 16 != 0) {  // small: type, size and up to four bytes of data share the tag
      e.type = first & 0xffffU;
      e.size = std::min<std::size_t>(first >> 16, 4);
      e.data = bytes.substr(4, e.size);
      e.total = 8;
      return e;
    }
    e.type = first;
    e.size = number(bytes, 4);
    e.data = bytes.substr(8, e.size);
    e.total = 8 + (e.type == kCompressed ? e.size : (e.size + 7) / 8 * 8);
    return e;
  }

  enum class Verdict { sound, of_no_interest, damaged };

  /// Looks at the inside of a matrix element: flags, dimensions, name and the tag of its data. `inside` may be the
  /// beginning only, of `claimed` bytes.
  Verdict judge(std::string_view inside, std::size_t claimed, std::string& name) const {
    const auto flags = element(inside);
    if (!flags || flags->type != 6 || flags->size != 8 || flags->data.size() != 8) return Verdict::damaged;
    const auto word = number(flags->data, 0);
    const auto kind = word & 0xffU;
    const bool complex = (word & 0x0800U) != 0;
    if (kind < kFirstNumericClass || kind > kLastNumericClass || complex) return Verdict::of_no_interest;
    std::size_t at = flags->total;

    const auto dimensions = element(inside.substr(std::min(at, inside.size())));
    if (!dimensions || dimensions->type != 5 || dimensions->data.size() != dimensions->size ||
        dimensions->size % 4 != 0) {
      return Verdict::damaged;
    }
    if (dimensions->size != 8) return Verdict::of_no_interest;
    const std::size_t rows = number(dimensions->data, 0), columns = number(dimensions->data, 4);
    if (std::min(rows, columns) != 1 || std::max(rows, columns) < 2) return Verdict::of_no_interest;
    at += dimensions->total;

    const auto title = element(inside.substr(std::min(at, inside.size())));
    if (!title || title->type != 1 || title->data.size() != title->size || title->size == 0 || title->size > 256) {
      return Verdict::damaged;
    }
    name = title->data.substr(0, title->data.find('\0'));
    const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c < 0x7f; });
    if (!printable || name.empty()) {
      name = "file";
      return Verdict::damaged;
    }
    at += title->total;

    const auto values = element(inside.substr(std::min(at, inside.size())));
    if (!values) return Verdict::damaged;
    const auto width = bytes_of_type(values->type);
    const auto count = std::max(rows, columns);
    if (width == 0 || values->size != width * count || at + values->size > claimed) return Verdict::damaged;
    return Verdict::sound;
  }

 private:
  bool swapped_;
};

/// The first bytes of what is compressed.
std::string inflate_beginning(std::string_view compressed) {
  std::string output(1024, '\0');
  z_stream stream{};
  if (::inflateInit(&stream) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(compressed.size(), 1U << 20));
  stream.next_out = reinterpret_cast<Bytef*>(output.data());
  stream.avail_out = static_cast<uInt>(output.size());
  const int status = ::inflate(&stream, Z_SYNC_FLUSH);
  output.resize(status == Z_OK || status == Z_STREAM_END || status == Z_BUF_ERROR ? output.size() - stream.avail_out
                                                                                  : 0);
  ::inflateEnd(&stream);
  return output;
}

}  // namespace

std::string sound_vectors_only(std::string_view file, std::string& damaged) {
  damaged.clear();
  if (file.size() < kHeaderBytes || (file.substr(126, 2) != "IM" && file.substr(126, 2) != "MI")) {
    damaged = "file";
    return {};
  }
  // "IM" is what a little-endian machine writes.
  const bool little = file.substr(126, 2) == "IM";
  const Reader reader(little != (std::endian::native == std::endian::little));
  std::string sound(file.substr(0, kHeaderBytes));
  for (auto rest = file.substr(kHeaderBytes); !rest.empty();) {
    const auto element = reader.element(rest);
    if (!element || element->data.size() != element->size) {
      if (damaged.empty()) damaged = "file";
      break;
    }
    std::string inflated, name = "file";
    std::string_view inside = element->data;
    std::size_t claimed = element->size;
    bool matrix = element->type == kMatrix;
    if (element->type == kCompressed) {
      inflated = inflate_beginning(element->data);
      const auto inner = reader.element(inflated);
      matrix = inner && inner->type == kMatrix && inner->size <= kMostShrunk * element->size + 1024;
      if (matrix) {
        inside = std::string_view(inflated).substr(8);
        claimed = inner->size;
      } else if (damaged.empty()) {
        damaged = "file";
      }
    }
    if (matrix) {
      const auto verdict = reader.judge(inside, claimed, name);
      if (verdict == Reader::Verdict::sound) sound += rest.substr(0, element->total);
      if (verdict == Reader::Verdict::damaged && damaged.empty()) damaged = name;
    }
    rest.remove_prefix(std::min(element->total, rest.size()));
  }
  return sound;
}

}  // namespace handloop::io::detail
