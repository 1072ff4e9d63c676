"""Sentences of refusal that the page says too: `python -m tools.generate` writes them for it.

Each is a template of what stands behind the name of a file or a port, and `format` fills it in.
"""

# A TOML file.
NOT_UTF8 = "byte {at} is not UTF-8; TOML files must be UTF-8 text."
TOO_LONG = "{count} characters; a TOML file of greywhale has at most {most}."
TOO_DEEP = "nested more than {most} deep; no file of greywhale is."
NO_TOML = "not valid TOML: {why}."
CSV_IN_ITS_PLACE = "this is a log or a motion (CSV), but a TOML file is needed here."
NO_TOML_LINE = "not valid TOML: line {line} is neither KEY = VALUE nor a [TABLE]; is this a file of greywhale?"
EMPTY = "it is empty; choose another file."
COMMENTS_ALONE = "it is empty, but for comments; choose another file."
DATE = "{key} is a date or a time, but no file of greywhale holds one."
BEYOND_ANY_RANGE = "{key} is {value}, which is out of any range."
NOT_FINITE = "{key} is {value}; it must be a finite number."
OTHER_KIND = "this is {kind}, but {needed} is needed here ({taker} takes {kind})."

# A key of a TOML file; the file's sentence ends behind the first of these.
UNKNOWN_KEY = "unknown key {key}; {advice}"
PERHAPS = "perhaps {key} is meant"
CHECK_SPELLING = "remove it or check its spelling"
MISSING_KEY = "{key} is missing"
WRONG_VALUE = "{key} is {value}, but {rule}"
WRONG_TABLE = "{key}: {rule}"
WITHIN = "it must be {bounds}"
COUNT_OF_TABLES = "{count} [[{key}]] where there must be exactly {exactly}"
COUNT_OF_VALUES = "{count} values of {key} where there must be exactly {exactly}"
MORE = " (and {count} more in this file)"

# A parameter of a board; values have their units.
CHOOSE = "choose a value from {least} to {most}."
CHOOSE_BUT_0 = "choose a value from {least} to {most}, other than 0."
PARAMETER_NOT_FINITE = "{name} is {value}, but it must be a finite number; {advice}"
OUT_OF_RANGE = "{name} is {value}, which is out of range; {advice}"
NOT_WHOLE = "{name} is {value}, but it must be a whole number."
TOO_SMALL = "{name} is {value}, which the board would store as 0; choose 0, or a size from {least}."
NOT_BELOW = "{name} is {value} and {other} is {most}; choose {name} below {other}."
MISSING_PARAMETER = "{name} is missing; a parameter file holds all of them."
NO_NUMBER = "{name} is {value}, but it must be a number."
TOO_SMALL_IN_FILE = "{key} is {value}, which the board would store as 0; give 0, or at least {least}."

# A firmware image.
NO_HEX_RECORD = "this is no Intel HEX record; give the .hex that PlatformIO built."
ENDS_TOO_EARLY = "the file ends too early; copy or build it again."
NO_DATA = "the file holds no data; give the .hex that PlatformIO built."
BEYOND_ANY_BOARD = "data at address {address}; no board has as much memory."
OTHER_BOARD = "this image is for {meant}, but the board on {port} is an {board}; choose another file."
NO_ROOM = "the image reaches up to byte {end}, but an {board} has room for {space}; choose another file."

# A bootloader.
NO_BOOTLOADER = (
    "no bootloader answers at {bauds} baud; check that the board's reset works, or burn a bootloader with a programmer."
)
SILENT = "the bootloader stopped answering while {doing} at address {address}; check the cable and try again."
OTHER_CHIP = "the chip has {signature}; greywhale runs on {known} only."
WRONG_BYTE = "the board holds {found} at address {address} instead of {wanted}; flash it again."
