#pragma once

#include <compare>
#include <cstddef>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace mallow {

/// A list in order whose items stay where they are in memory: taking one out moves pointers, however large
/// an item is, and a pointer to an item holds until that item goes.
template <typename T>
class StableList {
 public:
  /// Item is T or const T.
  template <typename Item>
  class Iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = Item*;
    using reference = Item&;

    Iterator() = default;
    explicit Iterator(const std::unique_ptr<T>* at) : at_(at) {}
    operator Iterator<const T>() const requires(!std::is_const_v<Item>) { return Iterator<const T>(at_); }

    Item& operator*() const { return **at_; }
    Item* operator->() const { return at_->get(); }
    Item& operator[](std::ptrdiff_t by) const { return *at_[by]; }
    Iterator& operator++() { return *this += 1; }
    Iterator& operator--() { return *this += -1; }
    Iterator operator++(int) { return std::exchange(*this, *this + 1); }
    Iterator operator--(int) { return std::exchange(*this, *this - 1); }
    Iterator& operator+=(std::ptrdiff_t by) {
      at_ += by;
      return *this;
    }
    Iterator& operator-=(std::ptrdiff_t by) { return *this += -by; }
    friend Iterator operator+(Iterator from, std::ptrdiff_t by) { return from += by; }
    friend Iterator operator+(std::ptrdiff_t by, Iterator from) { return from += by; }
    friend Iterator operator-(Iterator from, std::ptrdiff_t by) { return from -= by; }
    friend std::ptrdiff_t operator-(Iterator a, Iterator b) { return a.at_ - b.at_; }
    friend bool operator==(Iterator, Iterator) = default;
    friend auto operator<=>(Iterator, Iterator) = default;

   private:
    const std::unique_ptr<T>* at_ = nullptr;
  };

  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  T& operator[](std::size_t place) { return *items_[place]; }
  const T& operator[](std::size_t place) const { return *items_[place]; }
  T& front() { return *items_.front(); }
  const T& front() const { return *items_.front(); }
  T& back() { return *items_.back(); }
  const T& back() const { return *items_.back(); }
  Iterator<T> begin() { return Iterator<T>(items_.data()); }
  Iterator<T> end() { return begin() + static_cast<std::ptrdiff_t>(size()); }
  Iterator<const T> begin() const { return Iterator<const T>(items_.data()); }
  Iterator<const T> end() const { return begin() + static_cast<std::ptrdiff_t>(size()); }

  void push_back(T item) { items_.push_back(std::make_unique<T>(std::move(item))); }
  void insert(std::size_t place, T item) {
    items_.insert(items_.begin() + static_cast<std::ptrdiff_t>(place), std::make_unique<T>(std::move(item)));
  }
  void erase_if(auto goes) {
    std::erase_if(items_, [&](const std::unique_ptr<T>& item) { return goes(std::as_const(*item)); });
  }
  void resize(std::size_t count) {
    const std::size_t kept = items_.size();
    items_.resize(count);
    for (std::size_t place = kept; place < count; ++place) items_[place] = std::make_unique<T>();
  }

 private:
  std::vector<std::unique_ptr<T>> items_;
};

}  // namespace mallow
