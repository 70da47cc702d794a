// One number after the other: the oracle of the vector bodies.
namespace plumb::simd {
namespace {

template <class V>
inline V load(const double* from) {
  return *from;
}
template <class V>
inline V broadcast(double value) {
  return value;
}
inline void store(double value, double* to) {
  *to = value;
}

}  // namespace
}  // namespace plumb::simd
