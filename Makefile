# Every target makes itself ready first; repeating one costs seconds. `make` alone lists them.

PYTHON := .venv/bin/python
export PATH := $(CURDIR)/.venv/bin:$(PATH)

CPPCHECK := cppcheck --quiet --error-exitcode=1 --inline-suppr --enable=warning,performance,portability -j2
PORTABLE := $(shell find firmware/lib -name '*.cpp' -not -path '*/hal/src/*')
FIRMWARE_ROOMS := $(patsubst %,-Ifirmware/lib/%/src,$(notdir $(wildcard firmware/lib/*)))

.DEFAULT_GOAL := help
.PHONY: help setup build firmware demo test lint oracles bench docs dist lock clean

help: ## list the targets
	@sed -n 's/^\([a-z]*\):[^#]*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 12

setup: ## install and build everything that is missing (Debian packages, .venv, extensions, firmware)
	@python3 -m tools.setup

build: setup ## the same, under the name people look for

firmware: setup ## build the firmware for both boards, show its size, check its tick and its stack
	@$(PYTHON) -m tools.firmware_gate
	@$(PYTHON) -m tools.gates

demo: setup ## the whole story on the simulated bench; options in ARGS, e.g. ARGS="--leader motion.csv"
	@$(PYTHON) -m greywhale demo --out build/demo $(ARGS)

lint: setup ## ruff, mypy --strict, cppcheck, clang-tidy, generated files
	ruff check
	ruff format --check
	mypy
	$(CPPCHECK) --std=c++14 '-DISR(vector,...)=void vector()' firmware/lib firmware/src
	$(CPPCHECK) --std=c++17 --suppress=assignBoolToPointer:sim/board/binding.cpp sim host/native
	clang-tidy --quiet $(PORTABLE) -- -std=gnu++14 $(FIRMWARE_ROOMS) 2>build/clang-tidy.log || { cat build/clang-tidy.log; exit 1; }
	$(PYTHON) -m tools.generate_link --check

test: lint ## everything: lint, unit tests here and on the simulated board, gates on size, tick and stack, pytest
	$(PYTHON) -m tools.firmware_tests native
	$(PYTHON) -m tools.firmware_tests sim
	$(PYTHON) -m tools.firmware_gate
	$(PYTHON) -m tools.gates
	$(PYTHON) -m pytest $(ARGS)

oracles: setup ## tests against heavy outside references (installs them first)
	@python3 -m tools.oracles
	$(PYTHON) -m pytest tests/oracles $(ARGS)

bench: setup ## measure the figures of the design beside others; a table here, JSON in build/bench.json
	@python3 -m tools.oracles
	@$(PYTHON) -m tools.bench $(ARGS)

docs: setup ## write the generated files (link schema, reference page, copies of the version) again
	$(PYTHON) -m tools.generate_link
	$(PYTHON) -m tools.version

dist: setup ## build source distributions and wheels of both packages for this machine, in build/dist
	$(PYTHON) -m tools.dist $(ARGS)

lock: ## resolve and pin the Python packages anew
	python3 -m tools.lock

clean: ## remove everything that was built; .venv stays
	rm -rf build firmware/.pio host/src/greywhale/_native.pyi sim/bench/greywhale_sim/_board.pyi
