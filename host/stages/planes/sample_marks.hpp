#pragma once
#include <cstdint>
#include <utility>
#include <vector>

namespace hybrid::stages {

// A number per sample, 0 where none was given: an open-addressed table that holds a few samples of many,
// cleared in no time and used again by the next flood of the same thread. Sixteen samples in a row lie side
// by side, as floods ask for them.
class SampleMarks {
 public:
  void clear() {
    used_ = 0;
    if (++epoch_ == 0) {  // after 4 billion floods the stamps of old ones would look like new
      slots_.assign(slots_.size(), Slot());
      epoch_ = 1;
    }
  }
  std::uint32_t& of(std::uint32_t sample) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    Slot& slot = find(sample);
    if (slot.epoch != epoch_) {
      slot = {sample, 0, epoch_};
      ++used_;
    }
    return slot.value;
  }

 private:
  struct Slot {
    std::uint32_t sample = 0, value = 0, epoch = 0;
  };
  // From row to row, and one further each: a step without a factor of 2 comes by every slot, of which half
  // are free, whatever column the samples are of.
  Slot& find(std::uint32_t sample) {
    constexpr std::size_t kRow = 16, kStep = kRow + 1;
    const std::size_t mask = slots_.size() - 1;
    const std::size_t row = (sample / kRow * 0x9e3779b97f4a7c15ull) >> 32;
    std::size_t at = (row * kRow + sample % kRow) & mask;
    while (slots_[at].epoch == epoch_ && slots_[at].sample != sample) at = (at + kStep) & mask;
    return slots_[at];
  }
  void grow() {
    const std::vector<Slot> old = std::exchange(slots_, std::vector<Slot>(2 * slots_.size()));
    for (const Slot& slot : old)
      if (slot.epoch == epoch_) find(slot.sample) = slot;
  }

  std::vector<Slot> slots_ = std::vector<Slot>(1 << 12);
  std::size_t used_ = 0;
  std::uint32_t epoch_ = 1;
};

}  // namespace hybrid::stages
