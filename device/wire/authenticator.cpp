#include "device/wire/authenticator.h"

#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/params.h>
#include <openssl/rand.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "models/errors.h"

namespace handloop::device::wire {
namespace {

struct FreeMac {
  void operator()(EVP_MAC* mac) const { EVP_MAC_free(mac); }
  void operator()(EVP_MAC_CTX* context) const { EVP_MAC_CTX_free(context); }
};

const unsigned char* raw(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

}  // namespace

struct Authenticator::Impl {
  std::unique_ptr<EVP_MAC, FreeMac> mac;
  std::unique_ptr<EVP_MAC_CTX, FreeMac> context;
};

Authenticator::Authenticator(std::string_view key) : impl_(std::make_unique<Impl>()) {
  if (key.size() < kSmallestKeyBytes) {
    throw InputError("the key has " + std::to_string(key.size()) + " bytes; at least " +
                     std::to_string(kSmallestKeyBytes) + " are needed");
  }
  impl_->mac.reset(EVP_MAC_fetch(nullptr, "HMAC", nullptr));
  if (impl_->mac) impl_->context.reset(EVP_MAC_CTX_new(impl_->mac.get()));
  char digest[] = "SHA256";
  const OSSL_PARAM parameters[] = {OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_DIGEST, digest, 0),
                                   OSSL_PARAM_construct_end()};
  if (!impl_->context || EVP_MAC_init(impl_->context.get(), reinterpret_cast<const unsigned char*>(key.data()),
                                      key.size(), parameters) != 1) {
    throw std::runtime_error("OpenSSL offers no HMAC-SHA256");
  }
}

Authenticator::~Authenticator() = default;
Authenticator::Authenticator(Authenticator&&) noexcept = default;

Tag Authenticator::tag(std::span<const std::byte> bytes) const noexcept {
  Tag result{};
  std::size_t length = 0;
  EVP_MAC_CTX* context = impl_->context.get();
  // Begun again without a key the context keeps the one it has.
  const bool done =
      EVP_MAC_init(context, nullptr, 0, nullptr) == 1 && EVP_MAC_update(context, raw(bytes), bytes.size()) == 1 &&
      EVP_MAC_final(context, reinterpret_cast<unsigned char*>(result.data()), &length, result.size()) == 1;
  // A tag that could not be made must not be one that anybody can guess.
  if (!done || length != kTagBytes) RAND_bytes(reinterpret_cast<unsigned char*>(result.data()), kTagBytes);
  return result;
}

bool Authenticator::verify(std::span<const std::byte> bytes, std::span<const std::byte> given) const noexcept {
  if (given.size() != kTagBytes) return false;
  const Tag right = tag(bytes);
  return CRYPTO_memcmp(right.data(), given.data(), kTagBytes) == 0;
}

Authenticator read_key_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string() + ": cannot read the key");
  std::string key{std::istreambuf_iterator<char>(file), {}};
  while (!key.empty() && (key.back() == '\n' || key.back() == '\r')) key.pop_back();
  try {
    return Authenticator(key);
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

std::uint64_t text_hash(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("OpenSSL offers no SHA-256");
  }
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < 8; ++i) hash = hash << 8 | digest[i];
  return hash;
}

std::uint64_t random_number() {
  std::uint64_t number = 0;
  while (number == 0) {
    if (RAND_bytes(reinterpret_cast<unsigned char*>(&number), sizeof number) != 1) {
      throw std::runtime_error("the system gives no random numbers");
    }
  }
  return number;
}

}  // namespace handloop::device::wire
