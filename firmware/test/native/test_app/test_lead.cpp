// The host leads: where the reference goes, what is refused, and that the leader arm has it back afterwards.
#include "bench.h"

using bench::Bench;
using bench::board;

namespace {

constexpr int piece = 16;  // ticks from point to point

struct Led : Bench {
  using Bench::Bench;
  wire::LeadReply lead(std::uint16_t lease_ms = 60000) { return get<wire::LeadReply>(wire::LeadRequest{lease_ms}); }

  wire::LeadPointReply send(std::uint8_t number, int step) {
    return get<wire::LeadPointReply>(wire::LeadPointRequest{number, {static_cast<std::int8_t>(step), 0, 0, 0}});
  }
  template <class Request>
  wire::LeadRefusal why(const Request& request) {
    const wire::Nack nack = refused(request);
    CHECK(nack.code == wire::NackCode::lead_refused);
    where = nack.detail >> 8;
    return static_cast<wire::LeadRefusal>(nack.detail & 0xff);
  }
  // The reference of joint 0 after the next tick, q12 rad
  int reference() {
    samples.clear();
    tick();
    REQUIRE(samples.size() == 1);
    return samples[0].leader[0];
  }
  Led& sampling() {
    get<wire::TelemetryReply>(wire::TelemetryRequest{1});
    return *this;
  }
  int where = -1;
};

// Steps of a motion that speeds up to the fastest there is, turns round and stops.
std::vector<int> motion() {
  std::vector<int> steps;
  for (int k = 1; k <= 60; ++k) steps.push_back(static_cast<int>(std::lround(127.0 * std::sin(k * 0.1047))));
  steps[10] = -128;
  steps[11] = 127;
  return steps;
}

}  // namespace

TEST_CASE("the reference starts at the follower's pose, wherever the leader arm is") {
  Led arm;
  arm.set_leader(0, 2.0);
  arm.set_follower(0, -0.5);
  arm.boot();
  arm.sampling();
  CHECK(arm.refused(wire::EnableRequest{0}).code == wire::NackCode::error_too_large);
  const wire::LeadReply reply = arm.lead();
  CHECK(reply.state == wire::State::soft_start);
  CHECK(board.drivers);
  CHECK(reply.reference[0] == doctest::Approx(-0.5 * 4096).epsilon(0.01));
  for (int i = 0; i < 100; ++i) CHECK(arm.reference() == reply.reference[0]);
  CHECK(bench::joint_max(board.duty) == 0);  // nothing to do
}

TEST_CASE("the reference is the B-spline of the points to the last bit, and rests at the last point") {
  params::Table table = bench::unwatched();
  table.tracking_limit = 0;  // this follower stays where it is
  Led arm(table);
  arm.sampling();
  const wire::LeadReply begun = arm.lead();
  const int base = begun.reference[0];
  const std::vector<int> steps = motion();
  std::vector<double> control(2, base);
  std::size_t sent = 0;
  std::vector<int> seen;
  for (int ms = 0; ms < 1200; ++ms) {
    for (; sent < steps.size(); ++sent) {  // as many as there is room for
      const auto number = static_cast<std::uint8_t>(begun.next + sent);
      if (arm.send(number, steps[sent]).next == number) break;
      control.push_back(control.back() + 4 * steps[sent]);
    }
    seen.push_back(arm.reference());
  }
  CHECK(sent == steps.size());
  control.push_back(control.back());
  std::vector<int> wanted;
  for (std::size_t k = 1; k + 1 < control.size(); ++k) {
    const double before = control[k] - control[k - 1], after = control[k + 1] - control[k];
    const double middle = (control[k - 1] + control[k]) / 2;
    for (int i = 1; i <= piece; ++i) {
      wanted.push_back(static_cast<int>(std::floor(middle + before * i / 16 + (after - before) * i * i / 512 + 0.5)));
    }
  }
  const auto moved = [base](int angle) { return angle != base; };
  const auto start = (std::find_if(seen.begin(), seen.end(), moved) - seen.begin()) -
                     (std::find_if(wanted.begin(), wanted.end(), moved) - wanted.begin());
  REQUIRE(start >= 0);
  const auto first = static_cast<std::size_t>(start);
  REQUIRE(first + wanted.size() < seen.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) wrong += seen[first + i] != wanted[i];
  CHECK(wrong == 0);
  CHECK(wanted.size() > 900);
  for (std::size_t i = first + wanted.size(); i < seen.size(); ++i) CHECK(seen[i] == control.back());
}

TEST_CASE("while the host leads its lease cannot be taken away, and the leader arm cannot take over") {
  Led arm;
  arm.set_leader(0, 2.0);
  arm.boot();
  arm.lead(300);
  CHECK(arm.why(wire::RenewRequest{0}) == wire::LeadRefusal::no_lease);
  CHECK(arm.refused(wire::EnableRequest{0}).code == wire::NackCode::not_disabled);
  CHECK(arm.refused(wire::EnableRequest{500}).code == wire::NackCode::not_disabled);
  CHECK(board.drivers);
  arm.run(300);
  CHECK(!board.drivers);  // none of it renewed the lease
}

TEST_CASE("a point is taken once, in its turn, and while there is room") {
  Led arm;
  arm.boot();
  const wire::LeadReply begun = arm.lead();
  const auto number = [&begun](int i) { return static_cast<std::uint8_t>(begun.next + i); };
  CHECK(arm.send(number(1), 0).next == number(0));  // one is missing
  CHECK(arm.send(number(0), 10).next == number(1));
  CHECK(arm.send(number(0), 99).waiting == 1);  // sent again: the answer was lost
  CHECK(arm.lead().reference[0] == begun.reference[0] + 40);
  CHECK(arm.lead().next == number(1));
  for (int i = 1; i < 12; ++i) CHECK(arm.send(number(i), 0).waiting == i + 1);
  CHECK(arm.send(number(12), 0).next == number(12));
  arm.run(2 * piece);
  CHECK(arm.send(number(12), 0).next == number(13));
}

TEST_CASE("a point beyond a limit is refused, names the joint and changes nothing") {
  params::Table table = bench::defaults();
  table.joint[3].limit_max = 300;
  table.joint[1].limit_min = -200;
  Led arm(table);
  const wire::LeadReply begun = arm.lead();
  const int up = (300 - begun.reference[3]) / 4, down = (-200 - begun.reference[1]) / 4;
  const auto to = [&begun](int one, int three) {
    return wire::LeadPointRequest{begun.next, {0, static_cast<std::int8_t>(one), 0, static_cast<std::int8_t>(three)}};
  };
  CHECK(arm.why(to(down, up + 1)) == wire::LeadRefusal::limit);
  CHECK(arm.where == 3);
  CHECK(arm.why(to(down - 1, up)) == wire::LeadRefusal::limit);
  CHECK(arm.where == 1);
  CHECK(arm.lead().next == begun.next);
  CHECK(arm.get<wire::LeadPointReply>(to(down, up)).waiting == 1);
  CHECK(arm.state() == wire::State::soft_start);
}

TEST_CASE("only a host that leads may send points, and a host leads only with a lease and from motors that are off") {
  Led arm;
  arm.boot();
  CHECK(arm.why(wire::LeadPointRequest{}) == wire::LeadRefusal::not_leading);
  const wire::Nack endless = arm.refused(wire::LeadRequest{0});
  CHECK(endless.detail == static_cast<int>(wire::LeadRefusal::no_lease));
  CHECK_FALSE(board.drivers);
  arm.enable();
  CHECK(arm.refused(wire::LeadRequest{500}).code == wire::NackCode::not_disabled);
  CHECK(arm.why(wire::LeadPointRequest{}) == wire::LeadRefusal::not_leading);
  CHECK(arm.state() == wire::State::soft_start);
}

TEST_CASE("whatever turns the motors off, the leader arm leads again before any request is taken") {
  Led arm;
  arm.speed = 3.0;
  arm.set_leader(0, 1.5);
  arm.boot();
  const auto led = [&arm] {
    arm.sampling();
    const wire::LeadReply begun = arm.lead(300);
    CHECK(arm.reference() == begun.reference[0]);
  };
  const auto back = [&arm] {
    CHECK(arm.why(wire::LeadPointRequest{}) == wire::LeadRefusal::not_leading);
    const wire::Nack nack = arm.refused(wire::EnableRequest{0});  // the leader arm is far away, and that counts
    CHECK(nack.code == wire::NackCode::error_too_large);
    CHECK((nack.detail >> 8) == 0);
    CHECK(arm.reference() == doctest::Approx(1.5 * 4096).epsilon(0.01));
  };
  led();
  arm.send_raw(Bench::frame(wire::StopRequest{}, 1));  // and an enable right behind it, in the same tick
  arm.send_raw(Bench::frame(wire::EnableRequest{0}, 2));
  arm.service();
  CHECK_FALSE(board.drivers);
  arm.run(5);
  CHECK_FALSE(board.drivers);
  arm.frames.clear();
  back();
  led();
  arm.run(301);  // nobody renews the lease
  CHECK(arm.status().stop_reason == wire::StopReason::lease);
  back();
  led();
  const std::uint16_t whole = arm.counts[2];
  arm.set_count(2, 0);  // a leader pot counts while the host leads as well
  arm.run(5);
  CHECK(arm.status().fault == wire::Fault::pot_low);
  arm.set_count(2, whole);
  arm.run(50);
  arm.get<wire::ClearFaultReply>(wire::ClearFaultRequest{});
  back();
  led();
}

TEST_CASE("a follower beyond its limits is led back to the limit, or not at all from too far") {
  params::Table table = bench::defaults();
  table.joint[0].limit_max = 1024;
  Led arm(table);
  arm.set_follower(0, 0.6);
  arm.run(30);
  CHECK(arm.lead().reference[0] == 1024);
  arm.stop();
  arm.set_follower(0, 1.2);
  arm.run(30);
  CHECK(arm.refused(wire::LeadRequest{500}).code == wire::NackCode::error_too_large);
  CHECK_FALSE(board.drivers);
}
