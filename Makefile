# Every target makes itself ready first; repeating one costs seconds. `make` alone lists them.
# READY= leaves that out: for what runs inside another target or before a commit.

PYTHON := .venv/bin/python
# The set-up runs with the system's Python: one in a .venv that is half made may not even start.
OUTSIDE ?= $(PATH)
export OUTSIDE := $(OUTSIDE)
export PATH := $(CURDIR)/.venv/bin:$(PATH)
SETUP = PATH="$$OUTSIDE" python3 -m tools.setup
# Tests start hundreds of Python processes; without bytecode each would compile all that it imports.
unexport PYTHONDONTWRITEBYTECODE
# And each would start threads for linear algebra, which take longer than all that it works out.
export OPENBLAS_NUM_THREADS := 1
READY := setup

CPPCHECK := cppcheck --quiet --error-exitcode=1 --inline-suppr --enable=warning,performance,portability -j2
PORTABLE := $(shell find firmware/lib -name '*.cpp' -not -path '*/hal/src/*')
TIDY := $(PORTABLE:%=build/tidy/%.ok)
FIRMWARE_SOURCES := $(shell find firmware/lib -name '*.h' -o -name '*.inc')
FIRMWARE_ROOMS := $(patsubst %,-Ifirmware/lib/%/src,$(notdir $(wildcard firmware/lib/*)))

# mypy keeps what it reads to the end: to look for garbage takes a fifth of its time and finds none. mypy would turn that
# on again by itself, so enable() is replaced, too.
MYPY := $(PYTHON) -c 'import gc; gc.disable(); gc.enable = gc.disable; from mypy.__main__ import console_entry as run; run()'
NEAR_THE_SYSTEM := $(addprefix host/src/greywhale/,__main__.py base protocol files board dashboard cli)

CXX_FILES := $(shell find firmware/lib firmware/src firmware/test host/native sim tests tools -path sim/bootloaders -prune -o \( -name '*.cpp' -o -name '*.h' \) -print)

# Parts of the targets below, the longest first. They run side by side on all cores, and what one says stays together.
LINT := mypy mypy-win32 mypy-darwin clang-tidy cppcheck-host cppcheck-firmware ruff ruff-format clang-format generated
UNIT_TESTS := firmware-tests-native
IMAGES := firmware-tests-sim gates
SIDE_BY_SIDE := $(MAKE) READY= --no-print-directory --jobs=$(shell nproc) --output-sync=target
PYTEST := $(PYTHON) -m pytest -n auto

.DEFAULT_GOAL := help
.PHONY: help setup ready build firmware demo dashboard report check quick test pytest lint oracles benchmarks attack docs site dist format lock hooks clean aside $(LINT) $(UNIT_TESTS) $(IMAGES)

help: ## list the targets
	@sed -n 's/^\([a-z]*\):[^#]*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 12

setup: ## install and build everything that is missing (Debian packages, .venv, extensions, firmware)
	@$(SETUP)

build: setup ## the same, under the name people look for

firmware: gates ## build the firmware for both boards, show its size, check its tick and its stack

ready: # what it takes to build and run, without checks and tests
	@$(SETUP) run

demo: ready ## the whole story on the simulated bench; options in ARGS, e.g. ARGS="--leader motion.csv"
	@$(PYTHON) -m greywhale demo --out build/demo --prove $(ARGS)

dashboard: ## the page on the simulated bench, in the browser, its files in build/dashboard; options in ARGS, e.g. ARGS=--no-browser
	@$(SETUP) page
	@mkdir -p build/dashboard
	@$(PYTHON) -m greywhale dashboard --sim --folder build/dashboard $(ARGS)

report: ready ## the paper from end to end, in build/report/report.html and .pdf; options in ARGS, e.g. ARGS=--quick
	@$(PYTHON) -m greywhale reproduce --out build/report $(ARGS)

lint: $(READY) ## ruff, mypy --strict, cppcheck, clang-tidy, generated files; all that fails at once
	@$(SIDE_BY_SIDE) --keep-going $(LINT)

check: $(READY) ## before each commit: lint, unit tests, gates, the short way through the simulated bench; pytest without what is slow
	@$(SIDE_BY_SIDE) --keep-going $(LINT) $(UNIT_TESTS) gates
	$(PYTEST) -m 'not slow' $(ARGS)

quick: $(READY) ## unit tests and quick tests, without lint: what runs on every system and Python
	@$(SIDE_BY_SIDE) $(UNIT_TESTS)
	$(PYTEST) -m 'not slow' $(ARGS)

test: $(READY) ## everything: lint, unit tests here and on the simulated board, gates on size, tick and stack, pytest
	@$(SIDE_BY_SIDE) pytest aside

# With the plus, make shows what it says as it says it.
pytest: $(READY)
	+$(PYTEST) $(ARGS)

# With what the tests leave of the cores. Any lower, and it would starve where other programs are busy.
aside: $(READY)
	+@nice -n 10 $(MAKE) $(UNIT_TESTS) $(IMAGES) $(LINT)

ruff: $(READY)
	ruff check

ruff-format: $(READY)
	ruff format --check

clang-format: $(READY)
	@echo clang-format
	@clang-format --dry-run --Werror $(CXX_FILES)

mypy: $(READY)
	@echo mypy
	@$(MYPY)

# The branches of base/system.py and sockets.py that no test runs here. Windows lacks much that rooms beside might use by mistake,
# macOS nothing. A cache each: mypy keeps none for two systems.
mypy-win32: $(READY)
	@echo mypy for Windows
	@$(MYPY) --platform win32 --follow-imports silent --cache-dir .mypy_cache/win32 $(NEAR_THE_SYSTEM)

mypy-darwin: $(READY)
	@echo mypy for macOS
	@$(MYPY) --platform darwin --cache-dir .mypy_cache/darwin $(addprefix host/src/greywhale/base/,system.py sockets.py)

cppcheck-firmware: $(READY)
	$(CPPCHECK) --std=c++14 '-DISR(vector,...)=void vector()' firmware/lib firmware/src

cppcheck-host: $(READY)
	$(CPPCHECK) -i sim/bootloaders --std=c++17 --suppress=assignBoolToPointer:sim/bind/board.cpp sim host/native

clang-tidy: $(TIDY)

build/tidy/%.ok: % $(FIRMWARE_SOURCES) .clang-tidy Makefile | $(READY)
	@mkdir -p $(@D)
	@echo clang-tidy $<
	@clang-tidy --quiet $< -- -std=gnu++14 $(FIRMWARE_ROOMS) 2>$@.log || { cat $@.log; exit 1; }
	@touch $@

generated: $(READY)
	$(PYTHON) -m tools.generate --check

firmware-tests-native firmware-tests-sim: firmware-tests-%: $(READY)
	$(PYTHON) -m tools.firmware_tests $*

gates: $(READY)
	@$(PYTHON) -m tools.gates

oracles: setup ## tests against heavy outside references (installs them first)
	@python3 -m tools.oracles
	$(PYTEST) tests/oracles $(ARGS)

benchmarks: setup ## measure the figures of the design beside others; a table here, JSON in build/benchmarks.json
	@python3 -m tools.oracles
	@$(PYTHON) -m tools.benchmarks $(ARGS)

attack: setup firmware ## attack everything at full size and write docs/reliability.md; goes on where it stopped
	@$(PYTHON) -m tools.attack --publish $(ARGS)

docs: setup ## write the generated files again (link schema, reference page, schemas), and build the site in build/site
	$(PYTHON) -m tools.generate
	$(PYTHON) -m tools.docs

site: ## the page with firmware and arm inside, and the documentation: one folder for any web server, in build/try
	@$(SETUP) site
	$(PYTHON) -m tools.site

dist: setup ## build source distributions and wheels of both packages for this machine, in build/dist
	$(PYTHON) -m tools.dist $(ARGS)

format: setup ## write all Python and C++ in the project's style
	ruff format
	clang-format -i $(CXX_FILES)

lock: ## resolve and pin the Python packages anew
	python3 -m tools.lock

hooks: setup ## let git run `make lint` before each commit (pre-commit uninstall takes that back)
	pre-commit install

clean: ## remove everything that was built; .venv stays
	rm -rf build firmware/.pio host/src/greywhale/_native.pyi
