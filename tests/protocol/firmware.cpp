// The firmware's own link and params code behind a C interface, for the tests in this folder.
#include <string.h>

#include "link/frame.h"
#include "messages.h"
#include "params/params.h"

namespace {

// Passes a payload through the generated struct of that name.
struct Reencode {
  const char* name;
  const uint8_t* in;
  uint8_t size;
  uint8_t* out;
  int result;

  template <class Message>
  void operator()(const char* candidate, const Message&) {
    if (strcmp(name, candidate) != 0) return;
    Message message{};
    if (!Message::decode(in, size, message)) {
      result = -1;
      return;
    }
    message.encode(out);
    result = Message::size;
  }
};

}  // namespace

extern "C" {

int gw_encode(uint8_t type, uint8_t seq, const uint8_t* payload, uint8_t size, uint8_t* out) {
  wire::Encoder encoder;
  memcpy(encoder.payload(), payload, size);
  encoder.finish(type, seq, size);
  memcpy(out, encoder.data(), encoder.size());
  return encoder.size();
}

// Writes type, seq, size and payload of every frame one after another; the result is how many bytes.
int gw_decode(const uint8_t* data, int size, uint8_t* out, uint16_t* bad) {
  wire::Decoder decoder;
  int used = 0;
  for (int i = 0; i < size; ++i) {
    if (!decoder.push(data[i])) continue;
    out[used++] = decoder.type();
    out[used++] = decoder.seq();
    out[used++] = decoder.payload_size();
    memcpy(out + used, decoder.payload(), decoder.payload_size());
    used += decoder.payload_size();
  }
  *bad = decoder.bad();
  return used;
}

// -2 when no message has the name, -1 when the length is refused, else the size.
int gw_reencode(const char* name, const uint8_t* in, uint8_t size, uint8_t* out) {
  Reencode visit{name, in, size, out, -2};
  wire::for_each_message<Reencode&>(visit);
  return visit.result;
}

uint32_t gw_schema_hash() { return wire::schema_hash; }
int gw_table_size() { return params::table_size; }
void gw_defaults(params::Table* table) { params::load_defaults(*table); }
int gw_set(params::Table* table, uint16_t index, int32_t value) {
  return static_cast<int>(params::set(*table, index, value));
}
int gw_get(const params::Table* table, uint16_t index, int32_t* value) {
  return static_cast<int>(params::get(*table, index, *value));
}
uint16_t gw_crc(const params::Table* table) { return params::crc(*table); }
int gw_first_invalid(const params::Table* table) { return params::first_invalid(*table); }
}
