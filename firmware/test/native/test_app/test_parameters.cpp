// Staging, applying, saving and what a power cycle finds.
#include "bench.h"

using bench::Bench;
using bench::board;
using bench::Booted;
using bench::Following;

namespace {

params::Table changed() {
  params::Table table = bench::defaults();
  table.supply_mv = 12000;
  table.joint[2].kp = 70000;
  table.leader[1].zero = 8000;
  return table;
}

std::int32_t value_of(Bench& arm, std::uint16_t index) {
  return arm.get<wire::ParamGetReply>(wire::ParamGetRequest{index}).value;
}

}  // namespace

TEST_CASE("a set is staged piece by piece, runs once it is applied, and is gone after a power cycle without a save") {
  Booted arm;
  CHECK(value_of(arm, 1) == 15000);
  arm.get<wire::ParamSetReply>(wire::ParamSetRequest{1, 12000});
  CHECK(value_of(arm, 1) == 15000);
  arm.apply_ok(changed());
  CHECK(value_of(arm, 1) == 12000);
  const auto crc = params::crc(changed());
  CHECK(arm.get<wire::HelloReply>(wire::HelloRequest{}).param_crc == crc);
  CHECK(arm.get<wire::ParamApplyReply>(wire::ParamApplyRequest{crc}).param_crc == crc);  // repeated
  arm.power_on();
  arm.boot();
  CHECK(value_of(arm, 1) == 15000);
}

TEST_CASE("apply is refused while the motors are on, and the running set stays") {
  Following arm;
  arm.get<wire::ParamSetReply>(wire::ParamSetRequest{1, 12000});  // staging is harmless
  const wire::Nack nack = arm.refused(wire::ParamApplyRequest{0});
  CHECK(nack.code == wire::NackCode::not_disabled);
  CHECK(nack.detail == static_cast<int>(wire::State::following));
  CHECK(value_of(arm, 1) == 15000);
  CHECK(board.drivers);
}

TEST_CASE("a set chooses the motor drivers when it is applied, and after a power cycle") {
  Booted arm;
  CHECK(board.driver == hal::Driver::pwm_direction);
  params::Table table = changed();
  table.driver = static_cast<std::uint8_t>(hal::Driver::two_pwm_high);
  arm.apply_ok(table);
  CHECK(board.driver == hal::Driver::two_pwm_high);
  arm.get<wire::ParamSaveReply>(wire::ParamSaveRequest{});
  arm.run(2000);
  arm.power_on();
  CHECK(board.driver == hal::Driver::two_pwm_high);
}

TEST_CASE("motor drivers that the board has no pins for are refused") {
  Booted arm;
  params::Table table = changed();
  table.driver = static_cast<std::uint8_t>(hal::Driver::two_pwm_low);
  board.last_driver = hal::Driver::pwm_direction;  // a Nano
  CHECK(arm.apply(table).type == 0xff);
  const wire::Nack nack = arm.refused(wire::ParamApplyRequest{params::crc(table)});
  CHECK(nack.code == wire::NackCode::no_pins);
  CHECK(nack.detail == static_cast<int>(hal::Driver::two_pwm_low));
  CHECK(board.driver == hal::Driver::pwm_direction);
  CHECK(value_of(arm, 1) == 15000);  // nothing of it runs
}

TEST_CASE("apply is refused for another CRC, for contradictions and for a set that cannot run") {
  Booted arm;
  params::Table table = bench::defaults();
  CHECK(arm.refused(wire::ParamApplyRequest{static_cast<std::uint16_t>(params::crc(table) + 1)}).code ==
        wire::NackCode::crc_mismatch);

  table.joint[1].limit_min = 2000;
  table.joint[1].limit_max = 2000;
  CHECK(arm.apply(table).type == 0xff);
  wire::Nack nack = arm.refused(wire::ParamApplyRequest{params::crc(table)});
  CHECK(nack.code == wire::NackCode::inconsistent);
  CHECK(nack.detail == params::first_inconsistent(table));

  table = bench::defaults();
  table.joint[3].ze_c = 10;  // narrower than 0.01
  table.supply_mv = 9000;
  CHECK(arm.apply(table).type == 0xff);
  nack = arm.refused(wire::ParamApplyRequest{params::crc(table)});
  CHECK(nack.code == wire::NackCode::set_refused);
  CHECK(nack.detail == (3 << 8 | static_cast<int>(wire::Refusal::width)));
  CHECK(value_of(arm, 1) == 15000);  // nothing of it runs
  CHECK(arm.enable() == wire::State::soft_start);
}

TEST_CASE("an enable on the heels of an apply is judged by the new calibration") {
  Booted arm;
  params::Table table = bench::defaults();
  table.leader[0].zero = 8184 - 6100;  // the leader now stands 1.95 rad away from the follower
  for (std::uint8_t i = 0; i < params::count; ++i) {
    std::int32_t value = 0;
    REQUIRE(params::get(table, i, value) == params::Access::ok);
    arm.get<wire::ParamSetReply>(wire::ParamSetRequest{i, value});
  }
  // Both in one go, and all the time the board wants before the next tick.
  arm.frames.clear();
  arm.send_raw(Bench::frame(wire::ParamApplyRequest{params::crc(table)}, 201));
  arm.send_raw(Bench::frame(wire::EnableRequest{0}, 202));
  arm.service();
  CHECK_FALSE(board.drivers);
  for (int i = 0; i < 20; ++i) {
    arm.tick();
    CHECK_FALSE(board.drivers);
  }
  REQUIRE(arm.frames.size() == 2);
  CHECK(arm.frames[0].type == 0x85);
  CHECK(arm.frames[1].seq == 202);
  wire::Nack nack{};
  REQUIRE(unsigned(arm.frames[1].type) == 0xff);
  REQUIRE(
      wire::Nack::decode(arm.frames[1].payload.data(), static_cast<std::uint8_t>(arm.frames[1].payload.size()), nack));
  CHECK(nack.code == wire::NackCode::error_too_large);
  CHECK(unsigned(nack.detail) < 256);  // joint 0
  CHECK(nack.detail / 32.0 == doctest::Approx(1.95).epsilon(0.02));
}

TEST_CASE("after an apply no enable works before potentiometers were read") {
  Booted arm;
  arm.apply_ok(changed());
  board.samples_ready = false;  // ticks without samples
  CHECK(arm.refused(wire::EnableRequest{0}).code == wire::NackCode::error_too_large);
  CHECK_FALSE(board.drivers);
  board.samples_ready = true;
  arm.tick();
  CHECK(arm.enable() == wire::State::soft_start);
}

TEST_CASE("a saved set survives a power cycle; ticks go on and motors may run meanwhile") {
  Booted arm;
  arm.apply(changed());
  CHECK(arm.status().save_state == wire::SaveState::idle);
  arm.enable();
  CHECK(arm.get<wire::ParamSaveReply>(wire::ParamSaveRequest{}).param_crc == params::crc(changed()));
  CHECK(arm.status().save_state == wire::SaveState::saving);
  arm.stop();
  CHECK(arm.refused(wire::ParamApplyRequest{params::crc(changed())}).code == wire::NackCode::busy_saving);
  unsigned waited = 0;
  while (arm.status().save_state == wire::SaveState::saving && waited < 2000) {
    arm.tick();
    ++waited;
  }
  CHECK(arm.status().save_state == wire::SaveState::saved);
  CHECK(board.eeprom_misuse == 0);
  CHECK(board.eeprom_writes > 100);

  arm.power_on();
  arm.boot();
  CHECK(value_of(arm, 1) == 12000);
  const auto hello = arm.get<wire::HelloReply>(wire::HelloRequest{});
  CHECK(hello.param_source != wire::ParamSource::defaults);
  CHECK(hello.param_crc == params::crc(changed()));
}

TEST_CASE("a stored set that cannot run: defaults, a fault, and a way out") {
  Bench arm;
  params::Table table = changed();
  table.joint[0].ne_c = 0;  // within its range, but the controller refuses it
  app::HalEeprom eeprom;
  params::Store<app::HalEeprom> store(eeprom);
  params::Table found;
  store.load(found);
  store.save(table);
  for (int i = 0; i < 5000 && store.state() == wire::SaveState::saving; ++i) {
    store.poll();
    hal::fake::start_tick();
  }
  REQUIRE(store.state() == wire::SaveState::saved);

  arm.power_on();
  arm.boot();
  CHECK(arm.status().fault == wire::Fault::params);
  CHECK(value_of(arm, 1) == 15000);
  CHECK(arm.refused(wire::EnableRequest{0}).code == wire::NackCode::in_fault);
  CHECK(arm.refused(wire::ClearFaultRequest{}).code == wire::NackCode::set_refused);
  arm.apply_ok(changed());
  CHECK(arm.clear_fault() == wire::State::disabled);
  CHECK(arm.enable() == wire::State::soft_start);
}
