.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
JOBS ?= 1

help:            ## this list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## +/\t/' | expand -t 14

$(READY): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $(READY)

install: $(READY) ## make .venv and install mpmcol with its tools into it

demo: $(READY)   ## install, run cases/quickstart.toml, draw its charts
	$(BIN)/mpmcol run cases/quickstart.toml --out runs/demo --fresh
	$(BIN)/mpmcol plot runs/demo

test: $(READY)   ## the tests: five minutes on two cores, kernels compiled anew
	$(BIN)/python -m pytest

test-all: $(READY) ## all tests, the slow ones too
	$(BIN)/python -m pytest -m 'slow or not slow'

soak: $(READY)   ## every promise of tests/soak put to the test for hours, into tests/soak/record.md; make soak HOURS=2 JOBS=4
	$(BIN)/python -m tests.soak --table tests/soak/record.md --jobs $(JOBS) $(if $(HOURS),--hours $(HOURS))

check: $(READY)  ## ruff, mypy, import layers
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(READY)  ## time per point and step of every kernel
	$(BIN)/mpmcol bench

clean:           ## remove what was made here
	rm -rf $(VENV) runs/demo build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache

.PHONY: help install demo test test-all soak check bench clean
