// What must hold of the whole firmware, whatever comes: seen from outside, through the line, the pins and the EEPROM.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "law.h"
#include "machine.h"

namespace attack {

class Watcher {
 public:
  explicit Watcher(Machine& machine) : machine_(machine) {}

  // Before the power goes, and after it has come: only a set that was saved runs then. `damaged`: the EEPROM was.
  void before_cut();
  void after_boot(bool damaged);
  void tick();     // does one, and judges it
  bool service();  // does one piece, and judges it; false when there is nothing more to do
  void at_end();   // reads the running set once more

  const params::Table& staged() const { return staged_; }
  std::uint8_t next_point() const { return next_point_; }

 private:
  void hear(const Piece& piece);
  void hear_set(const Frame& request);
  void hear_motors(const Frame& request, const Piece& piece);
  void hear_save();
  void read(const Frame& sent);
  void read_sample(const wire::Sample& sample);
  void judge_reference(const wire::Sample& sample);
  void applied(std::uint16_t crc);
  void follow_drivers(const Piece& piece);
  void went_on(const Piece& piece);
  void went_off(bool by_host);
  bool restarts_by_itself(const wire::StatusReply& status) const;
  void judge_memory(const wire::StatusReply& status) const;
  bool at_rail(std::uint8_t pot) const;
  bool estop_pressed() const;
  void note_rails();

  Machine& machine_;
  Law law_;
  params::Table running_ = {}, staged_ = {};
  std::vector<params::Table> stored_;  // one of these is what a boot must find
  params::Table saving_ = {};
  bool save_asked_ = false;
  bool may_have_lost_ = false;  // a save was cut, or the EEPROM was damaged
  bool applying_ = false;
  std::uint16_t apply_crc_ = 0;
  std::uint16_t lease_ = 0;  // ticks, 0 = until stop
  bool leading_ = false;
  bool safe_begun_ = false;      // the board has staged the safe set by itself, and may start the motors once
  bool safe_used_ = false;       // not again before an apply
  bool just_granted_ = false;    // by enable, no tick since
  bool pressed_ = false;         // the emergency stop, in the last tick
  std::uint8_t short_stop_ = 0;  // ticks that are left of one
  std::array<std::uint8_t, 8> ticks_at_rail_ = {};
  std::array<std::int16_t, 4> reference_ = {};
  std::uint32_t reference_tick_ = 0;
  bool reference_known_ = false;
  std::uint8_t next_point_ = 0;
};

}  // namespace attack
