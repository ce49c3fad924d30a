#include "ngs/scene/evidence.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "ngs/core/check.h"

namespace ngs {
namespace {

std::uint64_t quantised(double unit) { return std::uint64_t(std::llround(unit * 0x1p32)); }

/// False if object k has neither weight nor pixels: then all pixels are background and r = 1.
bool has_evidence(const double* sum, std::size_t k) { return sum[2 + 2 * k] != 0 || sum[3 + 2 * k] != 0; }

/// The share of object k in one view.
ObjectShare share_of(const double* sum, std::size_t k) {
  const double w = sum[0], count = sum[1], object_w = sum[2 + 2 * k], object_count = sum[3 + 2 * k];
  ObjectShare of;
  of.weight = ExactSum::of(object_w);
  of.pixels = std::uint64_t(object_count);
  of.add_signal(object_w / w);
  of.one_minus_contrast_sum = quantised(1) - quantised(std::abs(2 * object_count - count) / count);
  return of;
}

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

void ObjectShare::add(const ObjectShare& other) {
  weight.add(other.weight);
  pixels += other.pixels;
  signal_sum += other.signal_sum;
  signal_square_sum.add(other.signal_square_sum);
  one_minus_contrast_sum += other.one_minus_contrast_sum;
}

void ObjectShare::add_signal(double m) {
  const std::uint64_t units = quantised(m);
  __extension__ using Wide = unsigned __int128;
  const Wide square = Wide(units) * units;
  signal_sum += units;
  signal_square_sum.add({std::uint64_t(square >> 64), std::uint64_t(square)});
}

Evidence::Evidence(std::int64_t n, int k)
    : gaussians(n), objects(k), pixels(std::size_t(n)), views(std::size_t(n)), share(std::size_t(n), std::size_t(k)) {
  weight.resize(std::size_t(n));
}

void Evidence::add(const Evidence& other) {
  NGS_CHECK(gaussians == other.gaussians && objects == other.objects, "evidence of different models");
  for (std::size_t i = 0; i < std::size_t(gaussians); ++i) {
    weight.add(i, other.weight.at(i));
    pixels[i] += other.pixels[i];
    views[i] += other.views[i];
    other.share.for_each_in(i, [&](std::size_t k, const ObjectShare& of) { share.touch(i, k).add(of); });
  }
}

void Evidence::add(std::size_t gaussian, const double* sum, DeferredInserts& deferred_inserts) {
  add_background(gaussian, sum[0], sum[1]);
  for (std::size_t k = 0; k < std::size_t(objects); ++k)
    if (has_evidence(sum, k)) share.add(gaussian, k, share_of(sum, k), deferred_inserts);
}

void Evidence::add(std::size_t gaussian, const double* sum) {
  DeferredInserts deferred_inserts;
  add(gaussian, sum, deferred_inserts);
  share.add(deferred_inserts);
}

std::vector<float> Evidence::weights() const {
  std::vector<float> all(weight.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = float(weight.value(i));
  return all;
}

double between_views_variance(const ObjectShare& of, std::uint32_t views) {
  if (views < 2) return 0.0;
  __extension__ using Wide = unsigned __int128;  // V Σm² < 2^32 · 2^32 · 2^64 / V: fits for V < 2^32
  const Wide squares = (Wide(of.signal_square_sum.whole) << 64) | of.signal_square_sum.fraction;
  const Wide sum = of.signal_sum;
  const Wide numerator = squares * views - sum * sum;
  return 4.0 * (double(numerator) * 0x1p-64) / (double(views) * double(views));
}

void ViewWeights::add(std::size_t part, std::uint32_t gaussian, const double* sum) {
  auto& [bytes, last] = part_[part];
  std::size_t some = 0, one = 0;
  for (std::size_t k = 0; k < objects_; ++k)
    if (sum[2 + 2 * k] != 0) ++some, one = k;
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

const std::uint8_t* ViewWeights::next(const std::uint8_t* at, std::uint32_t& gaussian, double* weight) const {
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

std::size_t ViewWeights::bytes() const {
  std::size_t sum = 0;
  for (const Part& part : part_) sum += part.bytes.size();
  return sum;
}

}  // namespace ngs
