#!/bin/sh
# Builds libsimavr 1.6 as a static library for wheels, where no Debian package is at hand: build_simavr.sh PREFIX.
# Only the two chips of the bench are in it, and no ELF loader: the bench has its own.
set -eu
prefix=$1
archive=simavr_1.6+dfsg.orig.tar.xz
sum=794a599eced5dd678d088ca3f5f340d557b68af122d4a9777c87573729bda618
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

curl --fail --silent --show-error --location --output "$archive" \
  "https://deb.debian.org/debian/pool/main/s/simavr/$archive"
echo "$sum  $archive" | sha256sum --check --quiet
tar --extract --file "$archive"
cd simavr-1.6/simavr

cat > sim_core_config.h <<'END'
#define CONFIG_SIMAVR_VERSION "1.6"
#define CONFIG_MEGA2560 1
#define CONFIG_MEGA328 1
END
cat > sim_core_decl.h <<'END'
#include "sim_core_config.h"
extern avr_kind_t mega2560, mega328;
extern avr_kind_t *avr_kind[];
#ifdef AVR_KIND_DECL
avr_kind_t *avr_kind[] = {&mega2560, &mega328, NULL};
#endif
END
rm sim/run_avr.c sim/sim_elf.c
compile="${CC:-cc} -std=gnu99 -O2 -fPIC -DNDEBUG -w -Isim -I. -Icores -c"
$compile sim/*.c
$compile -DAVR_CORE=1 cores/sim_mega2560.c cores/sim_mega328.c cores/sim_megax8.c
ar rcs libsimavr.a ./*.o

mkdir -p "$prefix/include/simavr/avr" "$prefix/lib"
cp sim/*.h sim_core_*.h "$prefix/include/simavr/"
cp sim/avr/*.h "$prefix/include/simavr/avr/"
cp libsimavr.a "$prefix/lib/"
