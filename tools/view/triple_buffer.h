#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace mallow::view {

/// Hands the newest value from one thread to another; neither ever waits. The writer fills back() and
/// publishes it, the reader takes what was published last. Three places: one is the writer's, one the
/// reader's, and one lies between, whose number is the only thing that both touch. Exchanging that number
/// releases what the writer wrote to whoever acquires it, so that no place is ever seen by both.
template <class T>
class TripleBuffer {
 public:
  /// The writer's, to fill: it holds what was there two hand-overs ago, so that memory is used again.
  T& back() { return places_[back_]; }
  /// The writer's place becomes the newest value.
  void publish() { back_ = between_.exchange(back_ | k_fresh, std::memory_order_acq_rel) & k_place; }
  /// Whether the reader has taken what was published last.
  bool is_taken() const { return (between_.load(std::memory_order_acquire) & k_fresh) == 0; }

  /// The reader takes the newest value; false where there is none since the last time.
  bool take() {
    if (is_taken()) return false;
    front_ = between_.exchange(front_, std::memory_order_acq_rel) & k_place;
    return true;
  }
  /// The reader's.
  T& front() { return places_[front_]; }

 private:
  static constexpr std::uint32_t k_fresh = 4, k_place = 3;
  std::array<T, 3> places_;
  std::uint32_t back_ = 0, front_ = 1;
  std::atomic<std::uint32_t> between_{2};
};

}  // namespace mallow::view
