#pragma once

/// What this program was built with, for tests that take too long or make no sense under it.
namespace plumb::test {

#if defined(__has_feature)
#define PLUMB_HAS_FEATURE(x) __has_feature(x)
#else
#define PLUMB_HAS_FEATURE(x) 0
#endif

#if defined(__SANITIZE_THREAD__) || PLUMB_HAS_FEATURE(thread_sanitizer)
inline constexpr bool thread_sanitizer = true;
#else
inline constexpr bool thread_sanitizer = false;
#endif

#if defined(__SANITIZE_ADDRESS__) || PLUMB_HAS_FEATURE(address_sanitizer)
inline constexpr bool address_sanitizer = true;
#else
inline constexpr bool address_sanitizer = false;
#endif

inline constexpr bool sanitized = thread_sanitizer || address_sanitizer;

/// `n` repetitions, or a twentieth under a sanitizer, which looks at accesses rather than at numbers and is
/// slow.
constexpr int scaled(int n) {
  return sanitized ? (n + 19) / 20 : n;
}

}  // namespace plumb::test
