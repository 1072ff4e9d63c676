// The frame codec against published values, golden vectors, and garbage.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
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

Bytes random_payload(std::mt19937& random, size_t size) {
  Bytes payload(size);
  for (uint8_t& byte : payload) byte = static_cast<uint8_t>(random() % 4 == 0 ? 0 : random());
  return payload;
}

}  // namespace

TEST_CASE("crc has the published check value") {
  const std::string text = "123456789";
  CHECK(wire::crc_over(reinterpret_cast<const uint8_t*>(text.data()), 9) == 0x29B1);
  CHECK(wire::crc_over(nullptr, 0) == 0xFFFF);
}

TEST_CASE("crc equals the bitwise definition for every high byte and data byte") {
  int pairs = 0;
  for (unsigned high = 0; high < 256; ++high) {
    for (unsigned data = 0; data < 256; ++data) {
      // The first byte steers the high byte of the CRC through all values, the second is the data.
      const uint8_t bytes[2] = {static_cast<uint8_t>(high), static_cast<uint8_t>(data)};
      uint16_t expected = 0xFFFF;
      for (const uint8_t byte : bytes) {
        expected = static_cast<uint16_t>(expected ^ (byte << 8));
        for (int bit = 0; bit < 8; ++bit) {
          expected = static_cast<uint16_t>((expected << 1) ^ ((expected & 0x8000) != 0 ? 0x1021 : 0));
        }
      }
      EXPECT(wire::crc_over(bytes, 2) == expected);
      ++pairs;
    }
  }
  CHECK(pairs == 65536);
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

TEST_CASE("every payload size from empty to the largest survives") {
  std::mt19937 random(1);
  wire::Decoder decoder;
  for (size_t size = 0; size <= wire::max_payload; ++size) {
    for (int trial = 0; trial < 200; ++trial) {
      const Bytes payload = random_payload(random, size);
      const Bytes wire_bytes = frame_of(0x40, static_cast<uint8_t>(trial), payload);
      EXPECT(std::count(wire_bytes.begin(), wire_bytes.end(), uint8_t{0}) == 1);
      const auto frames = feed(decoder, wire_bytes);
      EXPECT(frames.size() == 1);
      EXPECT(frames[0].payload == payload);
    }
  }
  CHECK(decoder.bad() == 0);
}

TEST_CASE("any single changed byte is noticed") {
  std::mt19937 random(2);
  size_t changes = 0;
  for (const size_t size : {size_t{0}, size_t{6}, size_t{30}, size_t{wire::max_payload}}) {
    const Bytes payload = random_payload(random, size);
    const Bytes good = frame_of(0x04, 9, payload);
    for (size_t at = 0; at < good.size(); ++at) {
      for (unsigned change = 1; change < 256; ++change) {
        Bytes wire_bytes = good;
        wire_bytes[at] = static_cast<uint8_t>(wire_bytes[at] ^ change);
        wire_bytes.push_back(0);
        wire::Decoder decoder;
        EXPECT(feed(decoder, wire_bytes).empty());
        EXPECT(decoder.bad() >= 1);
        // and the frame after it arrives
        EXPECT(feed(decoder, good).size() == 1);
        ++changes;
      }
    }
  }
  CHECK(changes == 255 * (6 + 12 + 36 + 54));
}

TEST_CASE("garbage of any kind is survived, counted and left behind") {
  std::mt19937 random(3);
  const Bytes good = frame_of(0x02, 1, {1, 2, 0, 3});
  wire::Decoder decoder;
  // Noise passes for a frame with a chance of about 1 in 65,536; this seed has no such piece.
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes noise(1 + random() % 200);
    for (uint8_t& byte : noise) byte = static_cast<uint8_t>(random() % 255 + 1);
    noise.push_back(0);
    EXPECT(feed(decoder, noise).empty());
    EXPECT(decoder.bad() == trial + 1);
    EXPECT(feed(decoder, good).size() == 1);
  }
  CHECK(decoder.bad() == 20000);
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

TEST_CASE("zeros between frames mean nothing") {
  Bytes stream = {0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    const Bytes one = frame_of(9, static_cast<uint8_t>(i), {});
    stream.insert(stream.end(), one.begin(), one.end());
    stream.push_back(0);
  }
  wire::Decoder decoder;
  CHECK(feed(decoder, stream).size() == 3);
  CHECK(decoder.bad() == 0);
}

TEST_CASE("lost bytes spoil the frame they belong to and no other") {
  const Bytes good = frame_of(7, 7, {7, 7, 7});
  wire::Decoder decoder;
  feed(decoder, Bytes(good.begin(), good.begin() + 4));
  CHECK(feed(decoder, Bytes(good.begin() + 6, good.end())).empty());
  CHECK(decoder.bad() == 1);
  CHECK(feed(decoder, good).size() == 1);
}

TEST_CASE("the count of bad frames stops at its end") {
  wire::Decoder decoder;
  for (int i = 0; i < 70000; ++i) feed(decoder, {5, 0});
  CHECK(decoder.bad() == 65535);
}
