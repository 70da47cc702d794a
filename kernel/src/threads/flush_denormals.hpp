#pragma once

#if defined(__x86_64__) || defined(__i386__)
#include <xmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
#endif

namespace plumb::detail {

/// Makes numbers below the normal range (1e-38 in float) count as zero on this thread while it lives.
///
/// Corrections halve from rod to rod away from where they start, so long chains are full of such numbers. A
/// processor takes a hundred times as long for each. All instruction sets run under it, so bits stay the
/// same. WebAssembly has no such mode and keeps these numbers.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(read()) { write(saved_ | flush); }
  ~FlushDenormals() { write(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__x86_64__) || defined(__i386__)
  using Word = unsigned;
  static constexpr Word flush = 0x8000 | 0x0040;  // results, and operands
  static Word read() {
    return _mm_getcsr();
  }
  static void write(Word word) {
    _mm_setcsr(word);
  }
#elif defined(__aarch64__)
  using Word = std::uint64_t;
  static constexpr Word flush = 1 << 24;  // results and operands
  static Word read() {
    Word word;
    asm volatile("mrs %0, fpcr" : "=r"(word));
    return word;
  }
  static void write(Word word) {
    asm volatile("msr fpcr, %0" : : "r"(word));
  }
#else
  using Word = unsigned;
  static constexpr Word flush = 0;
  static Word read() {
    return 0;
  }
  static void write(Word) {}
#endif

  Word saved_;
};

}  // namespace plumb::detail
