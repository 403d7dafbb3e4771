#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "core/column_memory.h"
#include "core/raw_columns.h"
#include "mallow/vec3.h"

namespace mallow {

constexpr std::size_t padded(std::size_t n) {
  return (n + k_lanes - 1) / k_lanes * k_lanes;
}

/// Moves values[at, size) up by `count` places, and puts zeros in between.
template <class T>
void open_gap(T* values, std::size_t size, std::size_t at, std::size_t count) {
  std::copy_backward(values + at, values + size, values + size + count);
  std::fill_n(values + at, count, T{});
}
/// Moves the values that are not at one of `places`, ascending, to the front.
template <class T>
void close_gaps(T* values, std::size_t size, std::span<const std::uint32_t> places) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::size_t end = k + 1 < places.size() ? places[k + 1] : size;
    std::copy(values + places[k] + 1, values + end, values + places[k] - k);
  }
}

/// One quantity of all particles: an array on cache line boundaries whose capacity is a whole number of lane
/// blocks. What lies between size() and the end of its last block is zero, so that lanes need no tail; so is
/// the cache line behind, so that they may load lanes from any value on.
template <class T>
class Column {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Column() = default;
  explicit Column(std::size_t size) { resize(size); }
  Column(const Column&) = delete;
  Column& operator=(const Column&) = delete;
  Column(Column&& other) noexcept { swap(other); }
  Column& operator=(Column&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Column() { release(); }

  void swap(Column& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  /// Keeps the values that fit; new ones are zero. Memory only grows, and by a quarter at least once there is
  /// any, or what gets a little longer in every step would be allocated anew in every step: see release().
  void resize(std::size_t size) {
    if (padded(size) > capacity_) grow(with_room(padded(size)));
    clear(std::min(size, size_), size);
    size_ = size;
  }
  /// Keeps nothing: values are whatever they are, only the padding is zero. For columns that are written
  /// whole next, so that the threads that write them touch them first.
  void resize_unset(std::size_t size) {
    if (padded(size) > capacity_) {
      const std::size_t capacity = with_room(padded(size));
      release();
      grow(capacity);
    }
    clear(size, size);
    size_ = size;
  }
  /// Opens a gap of `count` zeros before the value `at`.
  void insert(std::size_t at, std::size_t count) {
    const std::size_t old = size_;
    resize(old + count);
    open_gap(data_, old, at, count);
  }
  /// Takes the values out whose numbers are in `places`, ascending; what is behind them moves up.
  void erase(std::span<const std::uint32_t> places) {
    close_gaps(data_, size_, places);
    resize(size_ - places.size());
  }
  void release() {
    if (data_) free_column(data_, allocated(capacity_));
    data_ = nullptr;
    size_ = capacity_ = 0;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t bytes() const { return capacity_ * sizeof(T); }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  std::span<const T> span() const { return {data_, size_}; }
  std::span<T> span() { return {data_, size_}; }

 private:
  static constexpr std::size_t k_read_ahead = 64;
  static std::size_t allocated(std::size_t capacity) { return capacity * sizeof(T) + k_read_ahead; }
  std::size_t with_room(std::size_t capacity) const {
    return std::max(capacity, padded(capacity_ + capacity_ / 4));
  }

  /// Zeros from the value `first` to the end of what lanes may read of `size` values.
  void clear(std::size_t first, std::size_t size) {
    // An empty column may have no memory at all, which memset may not be given.
    if (data_)
      std::memset(static_cast<void*>(data_ + first), 0, (padded(size) - first) * sizeof(T) + k_read_ahead);
  }
  void grow(std::size_t capacity) {
    T* data = static_cast<T*>(allocate_column(allocated(capacity)));
    if (size_ > 0) std::memcpy(static_cast<void*>(data), data_, size_ * sizeof(T));
    const std::size_t size = size_;
    release();
    data_ = data;
    size_ = size;
    capacity_ = capacity;
  }

  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// x, y and z of all particles: three columns in one allocation, `stride` floats apart.
class VectorColumn {
 public:
  VectorColumn() = default;
  explicit VectorColumn(std::size_t size) { resize(size); }

  /// As Column::resize.
  void resize(std::size_t size) {
    if (padded(size) > stride_) grow(std::max(padded(size), padded(stride_ + stride_ / 4)));
    for (std::size_t axis = 0; axis < 3 && stride_ > 0; ++axis)
      std::fill(this->axis(axis) + std::min(size, size_),
                this->axis(axis) + std::min(stride_, padded(std::max(size, size_)) + k_lanes), 0.0f);
    size_ = size;
  }
  /// Keeps nothing: see Column::resize_unset.
  void resize_unset(std::size_t size) {
    stride_ = padded(size);
    size_ = size;
    values_.resize_unset(3 * stride_);
    for (std::size_t axis = 0; axis < 3; ++axis)
      std::fill(this->axis(axis) + size, this->axis(axis) + stride_, 0.0f);
  }
  void insert(std::size_t at, std::size_t count) {
    const std::size_t old = size_;
    resize(old + count);
    for (std::size_t axis = 0; axis < 3; ++axis) open_gap(this->axis(axis), old, at, count);
  }
  void erase(std::span<const std::uint32_t> places) {
    for (std::size_t axis = 0; axis < 3; ++axis) close_gaps(this->axis(axis), size_, places);
    resize(size_ - places.size());
  }
  void release() {
    values_.release();
    size_ = stride_ = 0;
  }

  std::size_t size() const { return size_; }
  std::size_t stride() const { return stride_; }
  std::size_t bytes() const { return values_.bytes(); }
  float* axis(std::size_t a) { return values_.data() + a * stride_; }
  const float* axis(std::size_t a) const { return values_.data() + a * stride_; }
  float* x() { return axis(0); }
  float* y() { return axis(1); }
  float* z() { return axis(2); }
  const float* x() const { return axis(0); }
  const float* y() const { return axis(1); }
  const float* z() const { return axis(2); }
  Vec3 get(std::size_t i) const { return {x()[i], y()[i], z()[i]}; }
  void set(std::size_t i, const Vec3& value) {
    for (std::size_t a = 0; a < 3; ++a) axis(a)[i] = value[static_cast<Eigen::Index>(a)];
  }
  void swap(VectorColumn& other) noexcept {
    values_.swap(other.values_);
    std::swap(size_, other.size_);
    std::swap(stride_, other.stride_);
  }

 private:
  void grow(std::size_t stride) {
    Column<float> values;
    values.resize_unset(3 * stride);
    for (std::size_t axis = 0; axis < 3; ++axis)
      std::copy_n(this->axis(axis), size_, values.data() + axis * stride);
    values_.swap(values);
    stride_ = stride;
  }

  Column<float> values_;
  std::size_t size_ = 0;
  std::size_t stride_ = 0;
};

inline ConstVectors raw(const VectorColumn& column) {
  return {column.x(), column.y(), column.z()};
}
inline Vectors raw(VectorColumn& column) {
  return {column.x(), column.y(), column.z()};
}

}  // namespace mallow
