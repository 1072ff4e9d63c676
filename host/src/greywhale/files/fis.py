"""Reads a MATLAB .fis file as it is: sets, rules and methods, each with its line; what is odd in it becomes a remark.

Nothing is mended and nothing guessed: a value that is needed and cannot be read is an error that names its line.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from greywhale.base.errors import UserError, counted, os_reason
from greywhale.base.formats.whole import refuse_devices

LONGEST_TEXT = 1 << 20  # bytes; 7 x 7 rules take 3000
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_SECTION = re.compile(r"\[\s*(System|Input(?P<input>\d{1,3})|Output(?P<output>\d{1,3})|Rules)\s*\]", re.IGNORECASE)
_SET = re.compile(r"(?P<name>[^:]*):(?P<kind>[^,]*),\s*\[(?P<numbers>[^\]]*)\]?\s*")
_RULE = re.compile(r"(?P<ifs>[^,]*),(?P<thens>[^(]*)\((?P<weight>[^)]*)\)\s*:\s*(?P<link>[12])\s*")
_COMMENT = ("%", "#", "//")
AND = 1  # a rule's link; 2 is or


@dataclass(frozen=True)
class Set:
    """One membership function: its kind as MATLAB names it (trimf, gaussmf, ...) and its numbers."""

    name: str
    kind: str
    numbers: tuple[float, ...]
    line: int


@dataclass(frozen=True)
class Variable:
    """An input or an output: its range and its sets, in the file's order."""

    name: str
    low: float
    high: float
    sets: tuple[Set, ...]
    line: int


@dataclass(frozen=True)
class Rule:
    """One rule: for each variable the number of its set from 1, 0 where it does not matter, negative for `not`."""

    ifs: tuple[float, ...]
    thens: tuple[float, ...]
    weight: float
    link: int
    line: int


@dataclass(frozen=True)
class Fis:
    """A whole file. `system` has the keys of [System] in small letters, each with its value and line."""

    system: Mapping[str, tuple[str, int]]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    rules: tuple[Rule, ...]
    remarks: tuple[str, ...]

    def method(self, key: str, default: str) -> tuple[str, int]:
        """A value of [System] in small letters and its line; the default and 1 where the file says nothing."""
        value, line = self.system.get(key, (default, 1))
        return value.lower(), line

    @property
    def name(self) -> str:
        return self.system.get("name", ("", 1))[0]


def load(path: str | Path) -> Fis:
    """Read and check a file; UserError names the line of what cannot be read."""
    try:
        refuse_devices(path)
        with open(path, "rb") as file:
            data = file.read(LONGEST_TEXT + 1)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {os_reason(error)}.") from None
    if len(data) > LONGEST_TEXT:
        raise UserError(f"{path}: longer than {LONGEST_TEXT} bytes; no .fis is.")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")  # MATLAB's before 2020, where a comment or a name has such letters
    return parse(text, str(path))


def parse(text: str, name: str = "fis") -> Fis:
    """The file's text as `load` takes it; `name` stands in its errors."""
    return _Reader(name).read(text)


class _Reader:
    """Takes a file line by line."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._remarks: list[str] = []
        self._sections: dict[tuple[str, int], dict[str, tuple[str, int]]] = {}
        self._lines: dict[tuple[str, int], int] = {}
        self._rules: list[tuple[str, int]] = []

    def read(self, text: str) -> Fis:
        self._collect(text)
        if ("system", 0) not in self._sections:
            raise UserError(f"{self._name}: no [System] in it; a .fis begins with that.")
        inputs, outputs = self._variables("input"), self._variables("output")
        rules = tuple(self._rule(text, line, inputs, outputs) for text, line in self._rules)
        system = self._sections["system", 0]
        self._compare(system, "numinputs", len(inputs), "input")
        self._compare(system, "numoutputs", len(outputs), "output")
        self._compare(system, "numrules", len(rules), "rule")
        return Fis(system, inputs, outputs, rules, tuple(self._remarks))

    def _collect(self, text: str) -> None:
        here: tuple[str, int] | None = None
        for line, raw in enumerate(re.split(r"\r\n|\r|\n", text), start=1):
            content = raw.strip()
            if not content or content.startswith(_COMMENT):
                continue
            if section := _SECTION.fullmatch(content):
                number = section["input"] or section["output"]
                here = (section[1].lower().rstrip("0123456789"), int(number or 0))
                if here in self._sections:
                    raise self._error(line, f"{content} is there twice")
                self._sections[here], self._lines[here] = {}, line
            elif here is None:
                raise self._error(line, f"{content[:40]!r} stands before [System]; this is no .fis")
            elif here[0] == "rules":
                self._rules.append((content, line))
            else:
                self._take(here, content, line)

    def _take(self, here: tuple[str, int], content: str, line: int) -> None:
        key, equals, value = content.partition("=")
        if not equals:
            raise self._error(line, f"{content[:40]!r} is neither a section, a key nor a comment")
        value = value.strip()
        if value.count("'") % 2:
            self._remarks.append(f"line {line}: a quote is missing in {content[:40]!r}")
        key = key.strip().lower()
        if key in self._sections[here]:
            raise self._error(line, f"{key!r} is there twice")
        self._sections[here][key] = (value if key.startswith("mf") else value.strip("'\""), line)

    def _variables(self, kind: str) -> tuple[Variable, ...]:
        numbers = sorted(number for found, number in self._sections if found == kind)
        if numbers != list(range(1, len(numbers) + 1)) or not numbers:
            raise UserError(f"{self._name}: its {kind}s must be [{kind.title()}1], [{kind.title()}2] and so on.")
        return tuple(self._variable(kind, number) for number in numbers)

    def _variable(self, kind: str, number: int) -> Variable:
        here = (kind, number)
        found, line = self._sections[here], self._lines[here]
        text, at = found.get("range", ("", line))
        ends = self._numbers(text.strip("[]"), at)
        if len(ends) != 2 or not ends[0] < ends[1]:
            raise self._error(at, f"[{kind.title()}{number}] needs Range=[low high], low below high")
        sets = [self._set(key, *found[key]) for key in found if re.fullmatch(r"mf\d{1,4}", key)]
        if [order for order, _ in sorted(sets, key=lambda pair: pair[0])] != list(range(1, len(sets) + 1)):
            raise self._error(line, f"the sets of [{kind.title()}{number}] must be MF1, MF2 and so on")
        ordered = tuple(one for _, one in sorted(sets, key=lambda pair: pair[0]))
        self._compare(found, "nummfs", len(ordered), "set")
        return Variable(found.get("name", ("", line))[0], ends[0], ends[1], ordered, line)

    def _set(self, key: str, value: str, line: int) -> tuple[int, Set]:
        match = _SET.fullmatch(value)
        if match is None:
            raise self._error(line, f"{value[:40]!r} is no set; one is 'NAME':'trimf',[1 2 3]")
        name, kind = (match[part].strip().strip("'\"") for part in ("name", "kind"))
        return int(key[2:]), Set(name, kind.lower(), self._numbers(match["numbers"], line), line)

    def _rule(self, text: str, line: int, inputs: tuple[Variable, ...], outputs: tuple[Variable, ...]) -> Rule:
        match = _RULE.fullmatch(text)
        if match is None:
            raise self._error(line, f"{text[:40]!r} is no rule; one is '1 2, 3 (1) : 1'")
        ifs, thens = self._numbers(match["ifs"], line), self._numbers(match["thens"], line)
        for terms, variables, kind in ((ifs, inputs, "input"), (thens, outputs, "output")):
            if len(terms) != len(variables):
                told = f"{counted(len(terms), kind)} where the file has {len(variables)}"
                raise self._error(line, f"the rule {text[:40]!r} names {told}")
            for term, variable in zip(terms, variables, strict=True):
                if abs(term) >= len(variable.sets) + 1:
                    raise self._error(line, f"set {term:g} of {variable.name!r}, which has {len(variable.sets)}")
        (weight,) = self._numbers(match["weight"], line, 1)
        return Rule(ifs, thens, weight, int(match["link"]), line)

    def _numbers(self, text: str, line: int, wanted: int = 0) -> tuple[float, ...]:
        words = re.split(r"[\s,;]+", text.strip(" \t,;")) if text.strip(" \t,;") else []
        for word in words:
            if not _NUMBER.fullmatch(word) or not math.isfinite(float(word)):
                raise self._error(line, f"{word[:40]!r} is not a number")
        if wanted and len(words) != wanted:
            raise self._error(line, f"{text[:40]!r} must be {counted(wanted, 'number')}")
        return tuple(float(word) for word in words)

    def _compare(self, found: Mapping[str, tuple[str, int]], key: str, number: int, thing: str) -> None:
        value, line = found.get(key, (str(number), 1))
        if value != str(number):
            self._remarks.append(f"line {line}: it says {value[:20]}, and there are {counted(number, thing)}")

    def _error(self, line: int, words: str) -> UserError:
        return UserError(f"{self._name}: line {line}: {words}.")
