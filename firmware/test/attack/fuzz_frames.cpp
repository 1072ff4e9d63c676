// libFuzzer over the frame codec: any bytes, judged by the firmware's decoder and by one written from the definition.
#include <link/frame.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "definition.h"
#include "must.h"

namespace attack {
namespace {

using Bytes = std::vector<std::uint8_t>;

// COBS as its paper has it; false when the codes do not end where the bytes end.
bool unstuff(const Bytes& in, Bytes& out) {
  for (std::size_t at = 0; at < in.size();) {
    const std::size_t code = in[at];
    if (at + code > in.size()) return false;
    out.insert(out.end(), in.begin() + static_cast<std::ptrdiff_t>(at + 1),
               in.begin() + static_cast<std::ptrdiff_t>(at + code));
    at += code;
    if (at < in.size()) out.push_back(0);
  }
  return true;
}

bool is_frame(const Bytes& piece, Bytes& body) {
  if (!unstuff(piece, body) || body.size() < wire::frame_overhead || body.size() > wire::max_frame) return false;
  const std::uint16_t crc = crc_by_definition(body.data(), body.size() - 2);
  return body[body.size() - 2] == (crc & 0xFF) && body.back() == crc >> 8;
}

void judge_stream(const std::uint8_t* data, std::size_t size) {
  wire::Decoder decoder;
  Bytes piece;
  unsigned bad = 0;
  for (std::size_t i = 0; i <= size; ++i) {
    const std::uint8_t byte = i < size ? data[i] : std::uint8_t{0};
    const bool heard = decoder.push(byte);
    if (byte != 0) {
      must(!heard, "a frame ends with a zero");
      piece.push_back(byte);
      continue;
    }
    Bytes body;
    const bool expected = !piece.empty() && is_frame(piece, body);
    bad += !piece.empty() && !expected;
    must(heard == expected, "both decoders know the same frames");
    must(decoder.bad() == bad, "both decoders count the same damage");
    if (heard) {
      must(decoder.type() == body[0] && decoder.seq() == body[1], "both decoders read the same head");
      must(decoder.payload_size() == body.size() - wire::frame_overhead &&
               std::equal(body.begin() + 2, body.end() - 2, decoder.payload()),
           "both decoders read the same payload");
    }
    piece.clear();
  }
}

void judge_frame(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return;
  const auto count = static_cast<std::uint8_t>(std::min<std::size_t>(size - 2, wire::max_payload));
  wire::Encoder encoder;
  std::copy(data + 2, data + 2 + count, encoder.payload());
  encoder.finish(data[0], data[1], count);
  const Bytes bytes(encoder.data(), encoder.data() + encoder.size());
  must(std::find(bytes.begin(), bytes.end(), 0) == bytes.end() - 1, "a frame holds one zero, its last byte");
  Bytes body;
  must(is_frame(Bytes(bytes.begin(), bytes.end() - 1), body), "what is sent is a frame by definition");
  must(body.size() == count + std::size_t{wire::frame_overhead} && body[0] == data[0] && body[1] == data[1] &&
           std::equal(data + 2, data + 2 + count, body.begin() + 2),
       "a frame says what it was made of");
}

}  // namespace
}  // namespace attack

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  attack::judge_frame(data, size);
  attack::judge_stream(data, size);
  return 0;
}
