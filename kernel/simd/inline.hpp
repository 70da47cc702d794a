#pragma once

/// Loops of vectors are one function to the compiler, since no vector may cross a call.
#define PLUMB_INLINE inline __attribute__((always_inline))
