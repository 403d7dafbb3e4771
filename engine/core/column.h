#pragma once

#include <algorithm>
#include <cstddef>
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

/// One quantity of all particles: an array on cache line boundaries whose capacity is a whole number of lane
/// blocks. What lies between size() and the end of its last block is zero, so that kernels need no tail; the
/// cache line behind may be read, so that they may load lanes from any value on.
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

  /// Keeps the values that fit; new ones are zero. Memory only grows: see release().
  void resize(std::size_t size) {
    if (padded(size) > capacity_) grow(padded(size));
    if (padded(size) > size_)
      std::memset(static_cast<void*>(data_ + size_), 0, (padded(size) - size_) * sizeof(T));
    if (size < size_) std::memset(static_cast<void*>(data_ + size), 0, (padded(size) - size) * sizeof(T));
    size_ = size;
  }
  /// Keeps nothing: values are whatever they are, only the padding is zero. For columns that are written whole
  /// next, so that the threads that write them touch them first.
  void resize_unset(std::size_t size) {
    if (padded(size) > capacity_) {
      release();
      grow(padded(size));
    }
    std::memset(static_cast<void*>(data_ + size), 0, (padded(size) - size) * sizeof(T));
    size_ = size;
  }
  /// For what gets longer as a body spreads: a quarter more memory than is asked for whenever it grows, or it
  /// would be allocated anew in every other step.
  void resize_with_room(std::size_t size) {
    if (padded(size) > capacity_) grow(padded(size + size / 4));
    resize(size);
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

  void grow(std::size_t capacity) {
    T* data = static_cast<T*>(allocate_column(allocated(capacity)));
    std::memset(static_cast<void*>(data + capacity), 0, k_read_ahead);
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

  void resize(std::size_t size) {
    if (size == size_) return;
    VectorColumn old(std::move(*this));
    stride_ = padded(size);
    values_.resize(3 * stride_);
    size_ = size;
    const std::size_t kept = std::min(size, old.size_);
    for (std::size_t axis = 0; axis < 3 && kept > 0; ++axis)
      std::copy_n(old.axis(axis), kept, this->axis(axis));
  }
  /// Keeps nothing: see Column::resize_unset.
  void resize_unset(std::size_t size) {
    stride_ = padded(size);
    size_ = size;
    values_.resize_unset(3 * stride_);
    for (std::size_t axis = 0; axis < 3; ++axis)
      std::fill(this->axis(axis) + size, this->axis(axis) + stride_, 0.0f);
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
