/// What a test must know of a build under a sanitizer.
#pragma once

namespace handloop::tests {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif
#if defined(__SANITIZE_THREAD__)
inline constexpr bool kThreadSanitizer = true;
#else
inline constexpr bool kThreadSanitizer = false;
#endif
/// How much longer a test has to wait for the program under test.
inline constexpr int kSlower = kAddressSanitizer || kThreadSanitizer ? 5 : 1;

}  // namespace handloop::tests
