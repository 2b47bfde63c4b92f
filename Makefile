# Two commands matter: `make run` shows the package at work, `make test` checks all of it.
# Everything is installed into .venv; a stamp file there keeps a second call from installing again.

VENV ?= .venv
BIN := $(VENV)/bin
MADE := $(VENV)/.made
RUN := $(VENV)/.installed-run
DEV := $(VENV)/.installed-dev
BENCH := $(VENV)/.installed-bench
INPUTS := pyproject.toml constraints.txt

# Every process of the tests reads our sources: they are not to be translated anew each time.
unexport PYTHONDONTWRITEBYTECODE

# On all processors; tests of a file share what they have computed, so that only the last ones move.
PARALLEL := -n logical --dist worksteal

# What runs compiled code by itself. With every index checked its sums are taken in another order, and
# the bound on round-off of one test is too tight for it.
CORE := $(patsubst %,tests/analysis/observables/test_%.py,shape_sums sample_sums harmonic_sums decay_sums turning_sums) \
	$(patsubst %,tests/analysis/solvers/test_%.py,along spinning flapping periodic_orbits held_bodies) \
	$(patsubst %,tests/analysis/states/test_%.py,branches) \
	$(patsubst %,tests/jit/test_%.py,sizes) \
	$(patsubst %,tests/models/test_%.py,rod_equations rod_matrix rod_flow framed_rod winding planar_steps chain) \
	$(patsubst %,tests/numerics/test_%.py,banded integrate tangents flow orbits) \
	$(patsubst %,tests/physics/test_%.py,curved_filament) \
	--deselect "tests/models/test_framed_rod.py::test_the_matrix_needs_no_pivoting[paper]"

# The first interpreter that starts and is new enough. A name on the PATH may be an empty shim.
CANDIDATES := python3.11 python3 python3.12 python3.13
FIND_PYTHON = for p in $(CANDIDATES); do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$p; break; }; done

.PHONY: help run quick test tests kernels test-slow lint docs bench clean
.DEFAULT_GOAL := help

help:
	@echo "make run        install, then run examples/spinning.toml into results/spinning"
	@echo "make test       install all that is needed, then every check and the tests"
	@echo "make quick      style, and the tests of what differs from origin/main"
	@echo "make test-slow  the tests that take minutes"
	@echo "make lint       style, types and import rules"
	@echo "make docs       build the documentation into site/"
	@echo "make bench      cost of steps, periods, states and points, and all beside other solvers (an hour)"
	@echo "make clean      remove what the other commands made, results excepted"

run: $(RUN)
	$(BIN)/undula run examples/spinning.toml --out results/spinning --overwrite

# Side by side: the checks are done while kernels are compiled.
test: $(DEV)
	$(MAKE) --no-print-directory --jobs=3 lint docs tests

tests: kernels
	$(BIN)/python -m pytest $(PARALLEL)

kernels: $(DEV)
	$(BIN)/python tests/support/kernels.py

quick: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	tests=$$($(BIN)/python tests/support/changed.py) && \
		if [ -n "$$tests" ]; then $(BIN)/python -m pytest $(PARALLEL) $$tests; fi

test-slow: $(DEV)
	$(BIN)/python -m pytest $(PARALLEL) -m slow
	NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=$(CURDIR)/$(VENV)/boundscheck $(BIN)/python -m pytest $(PARALLEL) $(CORE)

lint: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

docs: $(DEV)
	NO_MKDOCS_2_WARNING=true $(BIN)/mkdocs build --strict --quiet

bench: $(BENCH)
	$(BIN)/python benchmarks/step_cost.py
	$(BIN)/python benchmarks/step_profile.py
	$(BIN)/python benchmarks/state_cost.py
	$(BIN)/python benchmarks/points.py
	$(BIN)/python benchmarks/contest.py
	$(BIN)/python benchmarks/cost_and_size.py
	$(BIN)/python benchmarks/work_precision.py

clean:
	rm -rf $(VENV) site build dist .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
	find src tests benchmarks examples -name __pycache__ -type d -prune -exec rm -rf {} + 2>/dev/null || true

$(MADE):
	@python=$$($(FIND_PYTHON)); \
	if [ -z "$$python" ]; then \
		echo "undula needs Python 3.11 or newer and finds none: run 'apt-get install python3 python3-venv', then try again." >&2; exit 1; \
	fi; \
	if ! $$python -c 'import ensurepip, venv' 2>/dev/null; then \
		echo "$$python cannot make a virtual environment: run 'apt-get install python3-venv', then try again." >&2; exit 1; \
	fi; \
	$$python -m venv $(VENV)
	@touch $@

$(RUN): $(MADE) $(INPUTS)
	$(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt -e .
	@touch $@

$(DEV): $(MADE) $(INPUTS)
	$(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt -e '.[dev,docs]'
	@touch $(RUN) $@

$(BENCH): $(MADE) $(INPUTS)
	$(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt -e '.[bench]'
	@touch $(RUN) $@
