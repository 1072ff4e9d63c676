// Timed events: which method of which model to call at which cycle. Few wait at a time, so they stand in an array, the
// next one last, and nothing is allocated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace board {

class Events {
 public:
  using Handler = void (*)(void* model, uint64_t cycle);
  static constexpr uint64_t never = UINT64_MAX;

  // The cycle of the next event.
  uint64_t next() const { return count_ ? waiting_[count_ - 1].cycle : never; }

  // Moves the event if it waits already. Of events at the same cycle, the one that was set first comes first.
  void set(uint64_t cycle, Handler handler, void* model) {
    cancel(handler, model);
    size_t place = count_++;
    for (; place > 0 && waiting_[place - 1].cycle <= cycle; --place) waiting_[place] = waiting_[place - 1];
    waiting_[place] = {cycle, handler, model};
  }

  void cancel(Handler handler, void* model) {
    for (size_t place = count_; place-- > 0;) {
      if (waiting_[place].handler != handler || waiting_[place].model != model) continue;
      for (--count_; place < count_; ++place) waiting_[place] = waiting_[place + 1];
      return;
    }
  }

  // Calls what is due by now, and what that makes due.
  void run(uint64_t now) {
    while (count_ && waiting_[count_ - 1].cycle <= now) {
      const Event due = waiting_[--count_];
      due.handler(due.model, due.cycle);
    }
  }

  void clear() { count_ = 0; }

 private:
  struct Event {
    uint64_t cycle;
    Handler handler;
    void* model;
  };
  std::array<Event, 32> waiting_;  // all models together have 17 methods that may wait
  size_t count_ = 0;
};

}  // namespace board
