// What an image says about itself. Tools find this record in the .hex: they tell by it for which chip the image is,
// which version it is, and from which sources it was built. The host reads it in board/flash/images.py.
#include <avr/chip_signature.h>
#include <avr/pgmspace.h>
#include <link/schema.h>
#include <version.h>

namespace {

struct ImageRecord {
  char magic[16];
  uint8_t layout;        // of what follows
  uint8_t signature[3];  // of the chip, as its bootloader tells it
  uint8_t version[3];
  uint32_t schema_hash;  // little endian
  char sources[17];      // see source_digest.py
};

}  // namespace

extern "C" {

extern const ImageRecord image_record;
__attribute__((used, externally_visible)) const ImageRecord image_record PROGMEM = {
    "greywhale image",
    1,
    {hal::chip_signature[0], hal::chip_signature[1], hal::chip_signature[2]},
    {app::version_major, app::version_minor, app::version_patch},
    wire::schema_hash,
    GREYWHALE_SOURCE_DIGEST,
};
}
