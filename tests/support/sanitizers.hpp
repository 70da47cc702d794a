#pragma once

/// What this program was built with, for tests that take too long or make no sense under it.
namespace plumb::test {

#if defined(__has_feature)
#define PLUMB_HAS_FEATURE(x) __has_feature(x)
#else
#define PLUMB_HAS_FEATURE(x) 0
#endif

#if defined(__SANITIZE_THREAD__) || PLUMB_HAS_FEATURE(thread_sanitizer)
inline constexpr bool kThreadSanitizer = true;
#else
inline constexpr bool kThreadSanitizer = false;
#endif

#if defined(__SANITIZE_ADDRESS__) || PLUMB_HAS_FEATURE(address_sanitizer)
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif

inline constexpr bool kSanitized = kThreadSanitizer || kAddressSanitizer;

/// `n` repetitions, or a twentieth under a sanitizer, which looks at accesses rather than at numbers and is
/// slow.
constexpr int scaled(int n) {
  return kSanitized ? (n + 19) / 20 : n;
}

}  // namespace plumb::test
