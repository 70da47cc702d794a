#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace plumb::detail {

/// Makes numbers below the normal range (1e-38 in float) count as zero on this thread while it lives.
///
/// Corrections halve from rod to rod away from where they start, so long chains are full of such numbers. A
/// processor takes a hundred times as long for each. All instruction sets run under it, so bits stay the
/// same.
class FlushDenormals {
 public:
  FlushDenormals() {
#if defined(__SSE__)
    saved_ = _mm_getcsr();
    _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero);
#endif
  }
  ~FlushDenormals() {
#if defined(__SSE__)
    _mm_setcsr(saved_);
#endif
  }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__SSE__)
  static constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
  unsigned saved_ = 0;
#endif
};

}  // namespace plumb::detail
