.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
JOBS ?= 1
PARALLEL ?= --numprocesses 2 --dist loadfile
# Tests start many processes, which share the compiled bytecode.
unexport PYTHONDONTWRITEBYTECODE
# More threads than cores: a waiting thread yields its core at once.
test test-all: export GOMP_SPINCOUNT = 0

help:            ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## +/\t/' | expand -t 14

$(READY): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $(READY)

install: $(READY) ## create .venv and install mpmcol with its development tools

demo: $(READY)   ## run cases/quickstart.toml and draw its charts in runs/demo
	$(BIN)/mpmcol run cases/quickstart.toml --out runs/demo --fresh
	$(BIN)/mpmcol plot runs/demo

kernels: $(READY) ## compile the kernels of the default tests in two processes
	printf '%s\n' first second | xargs -P 2 -n 1 $(BIN)/python -m tests.support.kernels

test: kernels    ## run the tests except the slow ones, in two processes
	$(BIN)/python -m pytest $(PARALLEL)

test-all: kernels ## run all tests, also the slow ones
	$(BIN)/python -m pytest $(PARALLEL) -m 'slow or not slow'

soak: $(READY)   ## run the trials of tests/soak for hours and write tests/soak/record.md; make soak HOURS=2 JOBS=4
	$(BIN)/python -m tests.soak --table tests/soak/record.md --jobs $(JOBS) $(if $(HOURS),--hours $(HOURS))

check: $(READY)  ## check style, format, types and import layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/mypy --platform win32 --cache-dir .mypy_cache/windows
	$(BIN)/lint-imports

browser:         ## install Chromium (Debian, as root), in which the tests show reports
	command -v chromium || (apt-get update --quiet && apt-get install --quiet --yes chromium)

bench: $(READY)  ## measure the time per point and step of every kernel
	$(BIN)/mpmcol bench

clean:           ## remove .venv, caches and built files
	rm -rf $(VENV) runs/demo build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache

.PHONY: help install demo kernels test test-all soak check browser bench clean
