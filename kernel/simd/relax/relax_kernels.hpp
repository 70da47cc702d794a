#pragma once

#include <array>
#include <cstdint>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/settings.hpp"
#include "simd/relax/contacts/line_kernels.hpp"

/// The innermost loops, one body per instruction set, and the table they are called through.
///
/// All bodies do the same operations (+ - * / max, never fused) in the same order on the
/// same logical vectors (16 floats or 8 doubles). So all give the same bits. `relax_scalar.cpp` is written
/// for reading and is the oracle of the others, which share `relax_lanes.hpp`.
namespace plumb::simd {

/// Fields per rod in BlockView::rod and BlockView::weight: logical vectors for each vector of rods.
inline constexpr std::uint32_t rod_fields = 4;     ///< 2(x_b - x_a) as x, y, z; |x_b - x_a|^2 - L^2
inline constexpr std::uint32_t weight_fields = 4;  ///< L^2; k_a; k_b; 1/L^2 (0 for padding)
inline constexpr std::uint32_t moved_fields = 3;   ///< of BlockView::moved: x, y, z

template <class T>
inline constexpr std::uint32_t logical_width = layouts::lane_width<T>;

/// What a kernel needs of a block. Positions in m, displacements in m per substep, lengths squared in m^2.
/// The shares are k = omega/4 * w/(w_a + w_b). One half of omega is there as the correction of |d|^2 - L^2 =
/// C along d is C/2. Another is there because directions are kept as twice themselves.
template <class T>
struct BlockView {
  const T* x;  ///< Positions at the start of the substep.
  T* p;        ///< Displacements from x, which sweeps correct.
  T* out;      ///< Where corrections are added: p (Gauss–Seidel) or an accumulator (Jacobi).
  std::uint32_t component_stride;
  T* rod;           ///< rod_fields vectors per vector of rods, made by prepare.
  const T* weight;  ///< weight_fields vectors per vector of rods; not read for uniform ranges.
  const std::uint32_t* address_a;
  const std::uint32_t* address_b;
  T uniform_length2;  ///< Squared length of rods in uniform ranges, in m^2.
  T uniform_share;    ///< Shares k_a = k_b of rods in uniform ranges.
  T uniform_inverse_length2;
  T* moved = nullptr;  ///< Counting sweeps add their corrections here, before shares.
};

/// A range of vectors of rods.
struct Range {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  bool uniform = false;
};

/// Fields per rod that gives, or that lies in an island with one that does (plumb::RodLaw). A rod's pull is
/// kept as the length by which it shortens the rod. Stiffness and damping are then multiplied by what the
/// rod's ends give, w = w_a + w_b in 1/kg, and have no unit of mass.
namespace law_fields {
/// Numbers that never change: L in m; stiffness w in 1/s^2; damping w in 1/s; how many times as much as w the
/// shares are of (Jacobi, else 1); 1 if it is rigid; 1 if it is one-sided.
inline constexpr std::uint32_t rod = 6;
/// Numbers of a substep, see LawStart.
inline constexpr std::uint32_t start = 5;
/// By how much the rod has been moved in the substep, as a vector in m.
inline constexpr std::uint32_t shift = 3;
}  // namespace law_fields

/// These factors of a substep are the same for all rods. Forces act on its displacement by kick (s^2).
template <class T>
struct LawTerms {
  T damping;      ///< Multiplies damping, in s.
  T share;        ///< Of an elastic pull, so much is by the length at the end.
  T kick;         ///< Of the rod's own pull in this substep, in s^2.
  T kick_before;  ///< Of the half of a pull that the last substep has left (gradient old), in s.
  T keep;         ///< Makes of a rod's own pull the half that is left for the next substep, in 1/s.
  T substep;      ///< In s with gradient old, else 0.
};

/// What kernels need of a block whose rods give. Shares are w_a/w and w_b/w, without omega.
template <class T>
struct LawView : BlockView<T> {
  const T* law;  ///< law_fields::rod vectors per vector of rods.
  T* start;      ///< law_fields::start, made by prepare.
  T* shift;      ///< law_fields::shift.
  T* half_kick;  ///< What gradient old keeps of a pull from one substep to the next, in m/s.
  LawTerms<T> terms;
  T omega;
};

/// Loops over rods that give. A visit finds how a rod would pull if its ends were moved by nobody else, and
/// replaces by that what the rod has moved them before. Once nothing changes any more, all rods pull as their
/// laws say, whatever the number and the order of visits (Macklin, Mueller, Chentanez 2016, "XPBD").
/// `violation` is twice the largest move of another visit, in lengths of the rod. For rigid rods that is
/// nearly |C|/L^2. `finish` keeps what gradient old leaves for the next substep.
template <class T>
struct LawKernels {
  void (*prepare)(const LawView<T>&, Range);
  void (*sweep[3])(const LawView<T>&, const Range*, std::uint32_t count);  ///< by Gradient
  T (*violation[3])(const LawView<T>&, Range);                             ///< by Gradient
  void (*finish)(const LawView<T>&, Range);
};

/// Loops for one way of addressing rods. `sweep` projects every rod of each range, range after range; rods of
/// one range share no movable particle. `violation` is the largest |C|/L^2 of a range. It passes over what is
/// not a number, so that a broken island does not keep the others of its block sweeping.
template <class T>
struct AccessKernels {
  void (*prepare)(const BlockView<T>&, Range);
  void (*sweep[3])(const BlockView<T>&, const Range*, std::uint32_t count);  ///< by Gradient
  T (*violation)(const BlockView<T>&, Range);
  /// Sweeps likewise, and adds up in BlockView::moved what they do.
  void (*count[3])(const BlockView<T>&, const Range*, std::uint32_t count);
  LawKernels<T> laws;
};

/// Fields per end of a shape that ground may hold, in vectors for each vector of ends.
namespace end_fields {
inline constexpr std::uint32_t normal = 0;    ///< x, y, z of a unit vector out of the ground
inline constexpr std::uint32_t gap = 3;       ///< m, what may be lost along it
inline constexpr std::uint32_t push = 4;      ///< kg m, as x, y, z: along the normal and against sliding
inline constexpr std::uint32_t friction = 7;  ///< Coulomb's coefficient
inline constexpr std::uint32_t over = 8;      ///< kg, what moves it by a metre; 0 where nothing touches
inline constexpr std::uint32_t moves = 9;     ///< 1/kg, what a push of one moves it by
inline constexpr std::uint32_t mass = 10;     ///< kg; 0 for padding
inline constexpr std::uint32_t radius = 11;   ///< m
inline constexpr std::uint32_t force = 12;    ///< N, as x, y, z: what held it in the last substep
inline constexpr std::uint32_t count = 15;
}  // namespace end_fields

/// What kernels need of ends. Each is a particle with its position and its displacement (m).
template <class T>
struct EndView {
  const T* x;
  T* p;
  T* fields;                ///< end_fields::count vectors per vector of ends.
  const std::uint32_t* at;  ///< Where x of their particles are: of a vector's first in rows, else of each.
  std::uint32_t component_stride = 1;
};

/// This is what a range of ends may touch: a plane, or all that is within a radius of a line.
template <class T>
struct EndGround {
  bool is_plane;
  T place[3];  ///< The plane's normal, or where the line starts, m.
  T along[3];  ///< The line's way, m.
  T inverse;   ///< Of the square of its length, 1/m²; 0 for a point.
  T far;       ///< m, the plane's offset or the radius.
};

/// Says which ends touch in a substep, all lengths in m, and which gaps they keep.
template <class T>
struct EndRules {
  T margin;  ///< What comes nearer touches.
  T spread;  ///< So does what comes nearer by this share of its own displacement.
  T passes;  ///< What moves farther than the margin and this share of its radius touches only within those.
  T slop;    ///< This overlap is left as it is.
  T share;   ///< Of an overlap beyond the slop, so much is taken back.
  T square;  ///< s², makes pushes of forces.
};

/// Loops over ends. No two of a range are the same particle. Those of one vector are visited at once.
template <class T>
struct EndKernels {
  /// Finds which ends of a range touch, with the pushes of last forces. Writes whether any of a vector does.
  void (*find)(const EndView<T>&, Range, const EndGround<T>&, const EndRules<T>&, std::uint8_t* touched);
  /// Lets those touch that did not, and go deeper than `most` (m) beyond what they may. Returns whether any
  /// does, and marks its vector.
  bool (*watch)(const EndView<T>&, Range, T most, std::uint8_t* touched);
  /// Moves the ends of `count` vectors as their pushes do.
  void (*start)(const EndView<T>&, const std::uint32_t* vectors, std::uint32_t count);
  /// Visits those ends once.
  void (*sweep)(const EndView<T>&, const std::uint32_t* vectors, std::uint32_t count);
  /// Does so. Returns the largest change of a place, m.
  T (*measure)(const EndView<T>&, const std::uint32_t* vectors, std::uint32_t count);
  /// Makes forces of the pushes of a range; `over` (1/s²) is what makes them so.
  void (*keep)(const EndView<T>&, Range, T over);
};

/// Fields per contact of places, each a weighted sum of particles, in vectors for each vector of contacts.
namespace contact_fields {
inline constexpr std::uint32_t most_terms = 4;
inline constexpr std::uint32_t normal = 0;    ///< x, y, z of the unit vector along which a gap is kept open
inline constexpr std::uint32_t gap = 3;       ///< m, what may be lost along it
inline constexpr std::uint32_t push = 4;      ///< kg m, as x, y, z: along the normal and against sliding
inline constexpr std::uint32_t friction = 7;  ///< Coulomb's coefficient
inline constexpr std::uint32_t over = 8;      ///< kg, what moves the places by a metre; 0 for padding
inline constexpr std::uint32_t moves = 9;     ///< 1/kg, what a push of one moves them by
inline constexpr std::uint32_t carried = 10;  ///< m, as x, y, z: how far moving ground goes
inline constexpr std::uint32_t weight = 13;   ///< of each term
inline constexpr std::uint32_t move = weight + most_terms;  ///< 1/kg, what a push of one moves each term by
inline constexpr std::uint32_t count = move + most_terms;
}  // namespace contact_fields

/// What kernels need of contacts. Their particles have displacements (m).
template <class T>
struct ContactView {
  T* p;
  T* fields;                ///< contact_fields::count vectors per vector of contacts.
  const std::uint32_t* at;  ///< contact_fields::most_terms vectors likewise: where x of the terms are.
  std::uint32_t component_stride = 1;
};

/// A range of vectors of contacts with at most so many terms. No two of one range move the same particle.
struct ContactRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t terms = contact_fields::most_terms;  ///< two or four
};

/// Loops over ranges of contacts, range after range.
template <class T>
struct ContactKernels {
  /// Visits all contacts once.
  void (*sweep)(const ContactView<T>&, const ContactRange*, std::uint32_t count);
  /// Does so. Returns the largest change of a place, m.
  T (*measure)(const ContactView<T>&, const ContactRange*, std::uint32_t count);
};

/// Fields per contact of two lines, in vectors for each vector of contacts. A line joins two particles.
namespace line_contact_fields {
inline constexpr std::uint32_t normal = 0;  ///< x, y, z of the unit vector from the second line to the first
inline constexpr std::uint32_t gap = 3;     ///< m, what may be lost along it
inline constexpr std::uint32_t push = 4;    ///< kg m, as x, y, z: along the normal and against sliding
inline constexpr std::uint32_t friction = 7;    ///< Coulomb's coefficient
inline constexpr std::uint32_t over = 8;        ///< kg, what moves both places by a metre; 0 for padding
inline constexpr std::uint32_t a = 9, b = 10;   ///< places on both lines, from 0 to 1
inline constexpr std::uint32_t over_mass = 11;  ///< 1/kg, of the four ends; not there if all are alike
inline constexpr std::uint32_t ends = 4;
inline constexpr std::uint32_t count = over_mass + ends, count_if_alike = over_mass;
}  // namespace line_contact_fields

/// What kernels need of contacts of lines. Their particles have displacements (m). What is alike of all need
/// not be read of each, and sweeps wait for memory more than for anything else.
template <class T>
struct LineContactView {
  T* p;
  T* fields;  ///< line_contact_fields, vectors per vector of contacts.
  const std::uint32_t*
      at;  ///< Four vectors likewise: where x of the ends are, those of the first line first.
  std::uint32_t component_stride = 1;
  T over_mass = 0;  ///< 1/kg, of all ends; 0 if they differ.
};

/// Loops over ranges of contacts of lines, range after range.
template <class T>
struct LineContactKernels {
  /// Moves ends as pushes do.
  void (*start)(const LineContactView<T>&, const ContactRange*, std::uint32_t count);
  /// Visits all contacts once.
  void (*sweep)(const LineContactView<T>&, const ContactRange*, std::uint32_t count);
  /// Does so. Returns the largest change of a place, m.
  T (*measure)(const LineContactView<T>&, const ContactRange*, std::uint32_t count);
};

/// Loops over particle numbers, whatever the layout. Lengths are multiples of the logical width.
template <class T>
struct ParticleKernels {
  /// Predicts: p = decay * u + kick.
  void (*predict)(T* p, const T* u, const T* kick, T decay, std::uint32_t n);
  /// Adds what a Jacobi sweep summed: p += acc; acc = 0.
  void (*accumulate)(T* p, T* acc, std::uint32_t n);
  /// Says whether every x + p is finite.
  bool (*all_finite)(const T* x, const T* p, std::uint32_t n);
  /// Moves particles: x += p.
  void (*advance)(T* x, const T* p, std::uint32_t n);
  /// Moves particles with gradient mid: x += p; p = decay * (2p - decay * u). That is the velocity at the end
  /// of a step whose mean velocity is p.
  void (*advance_mid)(T* x, T* p, const T* u, T decay, std::uint32_t n);
  /// The same, damped, for a p that is not converged: x += p; p = decay * (p + kick).
  void (*advance_mid_guarded)(T* x, T* p, const T* kick, T decay, std::uint32_t n);
};

/// Says which particles are fast and near ground.
template <class T>
struct FastRules {
  std::array<T, 3> low, high;  ///< m, of a box around ground
  T least2;                    ///< m², the square of the displacement beyond which a particle is fast
};

/// Loops over `n` numbers of a crowd's particles.
template <class T>
struct CrowdKernels {
  /// Predicts: p = keep * v + by * a.
  void (*predict)(T* p, const T* v, const T* a, T keep, T by, std::uint32_t n);
  /// Moves particles, and finds their velocities: x += p; v = over * p.
  void (*advance)(T* x, T* v, const T* p, T over, std::uint32_t n);
  /// Adds up squares of numbers, each multiplied by a mass.
  double (*weigh_squares)(const double* mass, const T* of, std::uint32_t n);
  /// Returns the square of how far (m) the particle is displaced that is displaced most.
  T (*farthest)(const T* p, std::uint32_t n);
  /// Lists places of fast particles near ground, ascending. Returns how many there are.
  std::uint32_t (*list_fast)(const T* x, const T* p, const FastRules<T>&, std::uint32_t n, std::uint32_t* to);
};

template <class T>
struct Kernels {
  ParticleKernels<T> particles;
  CrowdKernels<T> crowds, row_crowds;  ///< of records, and of rows
  AccessKernels<T> access[3];          ///< by layouts::Access
  EndKernels<T> ends, row_ends;        ///< likewise
  ContactKernels<T> contacts, row_contacts;
  LineKernels lines;
  LineContactKernels<T> line_contacts, row_line_contacts;
};

// What a processor must have for an instruction set (`cpu` is xsimd's list), unless CMake's PLUMB_ISAS leaves
// it out. WebAssembly is asked for vectors when it is compiled, and then has them wherever it runs.
#if (defined(__x86_64__) || defined(__i386__)) && !defined(PLUMB_WITHOUT_SSE2)
#define PLUMB_SSE2(row) row(sse2, cpu.sse2)
#else
#define PLUMB_SSE2(row)
#endif
#if (defined(__x86_64__) || defined(__i386__)) && !defined(PLUMB_WITHOUT_AVX2)
#define PLUMB_AVX2(row) row(avx2, cpu.avx2&& cpu.fma3_avx2)
#else
#define PLUMB_AVX2(row)
#endif
#if (defined(__x86_64__) || defined(__i386__)) && !defined(PLUMB_WITHOUT_AVX512)
#define PLUMB_AVX512(row) \
  row(avx512, cpu.avx512bw&& cpu.avx512dq&& cpu.avx512cd&& __builtin_cpu_supports("avx512vl"))
#else
#define PLUMB_AVX512(row)
#endif
#if defined(__aarch64__) && !defined(PLUMB_WITHOUT_NEON)
#define PLUMB_NEON(row) row(neon, true)
#else
#define PLUMB_NEON(row)
#endif
#if defined(__wasm_simd128__) && !defined(PLUMB_WITHOUT_SIMD128)
#define PLUMB_SIMD128(row) row(simd128, true)
#else
#define PLUMB_SIMD128(row)
#endif

/// Every instruction set of this build, slowest first. The files of that name define its tables, and
/// CMakeLists.txt gives those files its flags; Isa names it.
#define PLUMB_FOR_EACH_ISA(row) \
  row(scalar, true) PLUMB_SSE2(row) PLUMB_AVX2(row) PLUMB_AVX512(row) PLUMB_NEON(row) PLUMB_SIMD128(row)

#define PLUMB_DECLARE_TABLES(isa, supported)       \
  extern const Kernels<float> relax_##isa##_float; \
  extern const Kernels<double> relax_##isa##_double;
PLUMB_FOR_EACH_ISA(PLUMB_DECLARE_TABLES)
#undef PLUMB_DECLARE_TABLES

/// The table for an instruction set that is_supported(). Defined in dispatch.cpp.
template <class T>
const Kernels<T>& kernels(Isa isa);

}  // namespace plumb::simd
