// The frame codec against a published value and the golden vectors, and at its ends. What it makes of any bytes is
// judged in tests/protocol (beside the host's codec) and in firmware/test/attack (by definition).
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "expect.h"
#include "golden.h"
#include "link/crc16.h"
#include "link/frame.h"

namespace {

using Bytes = std::vector<uint8_t>;

struct Received {
  uint8_t type;
  uint8_t seq;
  Bytes payload;
};

std::vector<Received> feed(wire::Decoder& decoder, const Bytes& bytes) {
  std::vector<Received> frames;
  for (const uint8_t byte : bytes) {
    if (decoder.push(byte)) {
      const uint8_t* payload = decoder.payload();
      frames.push_back({decoder.type(), decoder.seq(), Bytes(payload, payload + decoder.payload_size())});
    }
  }
  return frames;
}

Bytes frame_of(uint8_t type, uint8_t seq, const Bytes& payload) {
  wire::Encoder encoder;
  std::copy(payload.begin(), payload.end(), encoder.payload());
  encoder.finish(type, seq, static_cast<uint8_t>(payload.size()));
  return Bytes(encoder.data(), encoder.data() + encoder.size());
}

}  // namespace

TEST_CASE("crc has the published check value") {
  const std::string text = "123456789";
  CHECK(wire::crc_over(reinterpret_cast<const uint8_t*>(text.data()), 9) == 0x29B1);
  CHECK(wire::crc_over(nullptr, 0) == 0xFFFF);
}

namespace {

struct CheckVector {
  int& count;
  template <class Message>
  void operator()(const char* name, int seq, const Message& message, const golden::Bytes& golden_payload,
                  const golden::Bytes& frame) {
    INFO(name);
    ++count;
    const Bytes expected(frame.data, frame.data + frame.size);
    const uint8_t* payload = golden_payload.data;
    const uint8_t size = Message::size;
    REQUIRE(size == golden_payload.size);

    wire::Encoder encoder;
    encoder.encode(static_cast<uint8_t>(seq), message);
    CHECK(Bytes(encoder.data(), encoder.data() + encoder.size()) == expected);

    Message decoded{};
    REQUIRE(Message::decode(payload, size, decoded));
    uint8_t again[wire::max_payload] = {};
    decoded.encode(again);
    CHECK(Bytes(again, again + size) == Bytes(payload, payload + size));
    CHECK_FALSE(Message::decode(payload, static_cast<uint8_t>(size + 1), decoded));

    wire::Decoder decoder;
    const auto frames = feed(decoder, expected);
    REQUIRE(frames.size() == 1);
    const uint8_t type = Message::type;
    CHECK(frames[0].type == type);
    CHECK(frames[0].seq == seq);
    CHECK(frames[0].payload == Bytes(payload, payload + size));
  }
};

}  // namespace

TEST_CASE("every message has the golden bytes, both ways") {
  int count = 0;
  golden::for_each(CheckVector{count});
  CHECK(count == golden::vector_count);
}

TEST_CASE("an endless frame does not write past the buffer") {
  wire::Decoder decoder;
  CHECK(feed(decoder, Bytes(100000, 0xFF)).empty());
  CHECK(feed(decoder, Bytes(100000, 0x01)).empty());
  CHECK(feed(decoder, {0}).empty());
  CHECK(decoder.bad() == 1);
  CHECK(feed(decoder, frame_of(1, 1, {})).size() == 1);
}

TEST_CASE("a frame one byte too long is refused, though its CRC is right") {
  Bytes body(wire::max_frame + 1 - 2, 0x55);
  const uint16_t crc = wire::crc_over(body.data(), static_cast<uint8_t>(body.size()));
  body.push_back(static_cast<uint8_t>(crc & 0xFF));
  body.push_back(static_cast<uint8_t>(crc >> 8));
  EXPECT(std::count(body.begin(), body.end(), uint8_t{0}) == 0);
  body.insert(body.begin(), static_cast<uint8_t>(body.size() + 1));
  body.push_back(0);
  wire::Decoder decoder;
  CHECK(feed(decoder, body).empty());
  CHECK(decoder.bad() == 1);
}

TEST_CASE("the count of bad frames stops at its end") {
  wire::Decoder decoder;
  for (int i = 0; i < 70000; ++i) feed(decoder, {5, 0});
  CHECK(decoder.bad() == 65535);
}
