#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace handloop::device::wire {

inline constexpr std::size_t kTagBytes = 32;
inline constexpr std::size_t kSmallestKeyBytes = 16;
using Tag = std::array<std::byte, kTagBytes>;

/// HMAC-SHA256 (OpenSSL) with a key that both ends hold. One object for each thread.
class Authenticator {
 public:
  /// Throws InputError where the key is shorter than 16 bytes.
  explicit Authenticator(std::string_view key);
  ~Authenticator();
  Authenticator(Authenticator&&) noexcept;

  Tag tag(std::span<const std::byte> bytes) const noexcept;
  /// Compares in constant time.
  bool verify(std::span<const std::byte> bytes, std::span<const std::byte> tag) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Key from a file (the line end at its end is not part of it). Throws InputError naming the file where it cannot be
/// read or the key is too short.
Authenticator read_key_file(const std::filesystem::path& path);

/// First 64 bits of the SHA-256 of a text: names a scenario in the opening packet.
std::uint64_t text_hash(std::string_view text);

/// 64 bits from the system's random source, never 0.
std::uint64_t random_number();

}  // namespace handloop::device::wire
