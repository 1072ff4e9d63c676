// Walks the generated descriptors. Loops subtract instead of dividing: the boards have no divider, and the tables are
// short.
#include "params/params.h"

#include "link/bytes.h"
#include "link/crc16.h"
#include "params/flash.h"

namespace params {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the table in RAM must be the packed table");

namespace {

const uint8_t* bytes_of(const Table& table) { return reinterpret_cast<const uint8_t*>(&table); }

int32_t read(const uint8_t* at, Kind kind) {
  switch (kind) {
    case Kind::u8: return at[0];
    case Kind::i8: return static_cast<int8_t>(at[0]);
    case Kind::u16: return wire::get_u16(at);
    case Kind::i16: return static_cast<int16_t>(wire::get_u16(at));
    case Kind::u32:
    case Kind::i32: break;
  }
  return static_cast<int32_t>(wire::get_u32(at));
}

void write(uint8_t* at, Kind kind, int32_t value) {
  const uint32_t bits = static_cast<uint32_t>(value);
  switch (kind) {
    case Kind::u8:
    case Kind::i8: wire::put_u8(at, static_cast<uint8_t>(bits & 0xFF)); break;
    case Kind::u16:
    case Kind::i16: wire::put_u16(at, static_cast<uint16_t>(bits & 0xFFFF)); break;
    case Kind::u32:
    case Kind::i32: wire::put_u32(at, bits); break;
  }
}

bool in_range(const Field& field, int32_t value) {
  return value >= field.minimum && value <= field.maximum && !(field.nonzero && value == 0);
}

// Descriptor and byte offset of a flat index.
bool locate(uint16_t index, Field& field, uint8_t& offset) {
  for (uint8_t g = 0; g < group_count; ++g) {
    Group group;
    read_flash(group, groups[g]);
    offset = group.offset;
    for (uint8_t element = 0; element < group.elements; ++element) {
      if (index < group.fields) {
        read_flash(field, fields[group.first_field + index]);
        offset = static_cast<uint8_t>(offset + field.offset);
        return true;
      }
      index = static_cast<uint16_t>(index - group.fields);
      offset = static_cast<uint8_t>(offset + group.element_size);
    }
  }
  return false;
}

// A damaged table may hold a u32 above INT32_MAX. It reads as a negative number, which is below every u32's minimum.
bool holds(const uint8_t* element, const Group& group, const Field& field, bool ranges) {
  if (!ranges && field.below == no_field) return true;
  const int32_t value = read(element + field.offset, field.kind);
  if (ranges && !in_range(field, value)) return false;
  if (field.below == no_field) return true;
  Field other;
  read_flash(other, fields[group.first_field + field.below]);
  return value < read(element + other.offset, other.kind);
}

uint8_t first_bad(const Table& table, bool ranges) {
  uint8_t index = 0;
  for (uint8_t g = 0; g < group_count; ++g) {
    Group group;
    read_flash(group, groups[g]);
    const uint8_t* element = bytes_of(table) + group.offset;
    for (uint8_t e = 0; e < group.elements; ++e, element += group.element_size) {
      for (uint8_t f = 0; f < group.fields; ++f, ++index) {
        Field field;
        read_flash(field, fields[group.first_field + f]);
        if (!holds(element, group, field, ranges)) return index;
      }
    }
  }
  return none;
}

}  // namespace

Access get(const Table& table, uint16_t index, int32_t& value) {
  Field field;
  uint8_t offset;
  if (!locate(index, field, offset)) return Access::bad_index;
  value = read(bytes_of(table) + offset, field.kind);
  return Access::ok;
}

Access set(Table& table, uint16_t index, int32_t value) {
  Field field;
  uint8_t offset;
  if (!locate(index, field, offset)) return Access::bad_index;
  if (!in_range(field, value)) return Access::out_of_range;
  write(reinterpret_cast<uint8_t*>(&table) + offset, field.kind, value);
  return Access::ok;
}

void load_defaults(Table& table) { read_flash(table, default_table); }

void make_safe(Table& table, uint8_t joint) {
  JointParameters& own = table.joint[joint];
  JointParameters safe;
  read_flash(safe, default_table.joint[joint]);
  if (own.kp < safe.kp) safe.kp = own.kp;
  if (own.kd < safe.kd) safe.kd = own.kd;
  if (own.ki < safe.ki) safe.ki = own.ki;
  if (own.ku_mv < safe.ku_mv) safe.ku_mv = own.ku_mv;
  safe.motor_sign = own.motor_sign;
  safe.limit_min = own.limit_min;
  safe.limit_max = own.limit_max;
  own = safe;
  read_flash(table.change[joint], default_table.change[joint]);
}

uint16_t crc(const Table& table) { return wire::crc_over(bytes_of(table), static_cast<uint8_t>(table_size)); }

uint8_t first_inconsistent(const Table& table) { return first_bad(table, false); }

uint8_t first_invalid(const Table& table) { return first_bad(table, true); }

void Sets::begin(const Table& table) {
  staged_ = table;
  apply();
}

void Sets::apply() {
  running_ = staged_;
  running_crc_ = crc(running_);
}

}  // namespace params
