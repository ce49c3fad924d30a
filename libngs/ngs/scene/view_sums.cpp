#include "ngs/scene/view_sums.h"

#include <algorithm>
#include <cstring>

namespace ngs {
namespace {

// Format per Gaussian: a byte of flags, the difference to the previous index, W, the shares of objects.
constexpr std::uint8_t kDouble = 1;                // W needs a double; a Gaussian in one tile only has a float W
constexpr std::uint8_t kOneHasAll = 2, kSome = 4;  // one object has W1 = W; some objects have W1 > 0; neither: none

using Bytes = std::vector<std::uint8_t>;

/// Varint (LEB128): 7 bits per byte, lowest first; the highest bit is set if more bytes follow.
void put_count(Bytes& to, std::uint64_t value) {
  for (; value >= 128; value >>= 7) to.push_back(std::uint8_t(value | 128));
  to.push_back(std::uint8_t(value));
}

std::uint64_t take_count(const std::uint8_t*& at) {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    const std::uint8_t byte = *at++;
    value |= std::uint64_t(byte & 127) << shift;
    if (byte < 128) return value;
  }
}

template <class T>
void put_bits(Bytes& to, T value) {
  const std::size_t size = to.size();
  to.resize(size + sizeof value);
  std::memcpy(to.data() + size, &value, sizeof value);
}

/// ZigZag encoding: 0, -1, 1, -2, 2 ... become 0, 1, 2, 3, 4 ...
std::uint64_t folded_sign(std::int64_t value) { return std::uint64_t(value) << 1 ^ std::uint64_t(value < 0 ? -1 : 0); }
std::int64_t unfolded_sign(std::uint64_t count) { return std::int64_t(count >> 1) ^ -std::int64_t(count & 1); }

bool is_float(double value) { return double(float(value)) == value; }

void put_value(Bytes& to, double value, bool as_double) {
  if (as_double)
    put_bits(to, value);
  else
    put_bits(to, float(value));
}

template <class T>
double take_bits(const std::uint8_t*& at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return double(value);
}

double take_value(const std::uint8_t*& at, bool as_double) {
  return as_double ? take_bits<double>(at) : take_bits<float>(at);
}

}  // namespace

ViewSums ViewSums::positive(std::size_t column) const {
  ViewSums some{0, false, {}, {}};
  for (std::size_t v = 0; v < size(); ++v)
    if (const double* const weight = at(v) + column; *weight > 0) some.add(row[v], weight);
  return some;
}

void PackedSums::add(std::size_t part, std::uint32_t gaussian, const double* sum) {
  auto& [bytes, last] = part_[part];
  std::size_t some = 0, one = 0;
  for (std::size_t k = 0; k < objects_; ++k)
    if (sum[2 + 2 * k] != 0) {
      ++some;
      one = k;
    }
  const bool has_all = some == 1 && sum[2 + 2 * one] == sum[0], wide = !is_float(sum[0]);
  bytes.push_back(std::uint8_t((wide ? kDouble : 0) | (has_all ? kOneHasAll : some > 0 ? kSome : 0)));
  put_count(bytes, folded_sign(std::int64_t(gaussian) - std::int64_t(last)));
  put_value(bytes, sum[0], wide);
  last = gaussian;
  if (has_all) return put_count(bytes, one);
  if (some == 0) return;
  put_count(bytes, some);
  for (std::size_t k = 0; k < objects_; ++k) {
    const double weight = sum[2 + 2 * k];
    if (weight == 0) continue;
    put_count(bytes, k << 1 | std::size_t(!is_float(weight)));
    put_value(bytes, weight, !is_float(weight));
  }
}

const std::uint8_t* PackedSums::next(const std::uint8_t* at, std::uint32_t& gaussian, double* weight) const {
  const std::uint8_t flags = *at++;
  gaussian += std::uint32_t(unfolded_sign(take_count(at)));
  weight[0] = take_value(at, (flags & kDouble) != 0);
  std::fill_n(weight + 1, objects_, 0.0);
  if ((flags & kOneHasAll) != 0) weight[1 + take_count(at)] = weight[0];
  if ((flags & kSome) == 0) return at;
  for (std::uint64_t left = take_count(at); left > 0; --left) {
    const std::uint64_t head = take_count(at);
    weight[1 + (head >> 1)] = take_value(at, (head & 1) != 0);
  }
  return at;
}

std::size_t PackedSums::bytes() const {
  std::size_t sum = 0;
  for (const Part& part : part_) sum += part.bytes.size();
  return sum;
}

}  // namespace ngs
