# Two commands matter: `make demo` and `make test`. Each makes its own virtual environment first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= demo_out

.PHONY: demo test test-all lint types contracts pytest bench evaluate docs figures hashes clean

demo: $(VENV)/.installed
	$(BIN)/irb2400 demo --out $(OUT)

test: lint types contracts pytest

lint: $(VENV)/.installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.installed-test
	$(BIN)/mypy

contracts: $(VENV)/.installed-test
	$(BIN)/lint-imports

# a file's tests stay on one core, which makes what they share once
ALL_CORES := -n auto --dist loadfile --no-loadscope-reorder

pytest: $(VENV)/.installed-test
	$(BIN)/python -m pytest $(ALL_CORES) $(PYTEST_ARGS)

# everything: also the tests marked slow, the readers on many more drawn files, the searches for a
# bound below the truth and for a sound log that is refused, on seeds that are drawn anew and
# printed, and the branches of 100,000 poses of every arm
DRAWS ?= 100
test-all: lint types contracts $(VENV)/.installed-test
	IRB2400_EXAMPLES=1000 $(BIN)/python -m pytest $(ALL_CORES) -m "slow or not slow" $(PYTEST_ARGS)
	$(BIN)/python benchmarks/file_bounds.py $(DRAWS)
	$(BIN)/python benchmarks/corrupted_logs.py sound --count $(DRAWS)
	$(BIN)/python benchmarks/corrupted_logs.py sound --count $(DRAWS) --other-arms
	$(BIN)/python benchmarks/inverse_kinematics.py 100000
	$(BIN)/python benchmarks/inverse_kinematics.py 100000 --newton

bench: $(VENV)/.installed-test
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt 'mujoco>=3.2,<4'
	$(BIN)/python benchmarks/run.py

# COUNT arms of every suite, drawn from SEED; the full evaluation is COUNT=300 and takes hours
COUNT ?= 12
SEED ?= 900
evaluate: $(VENV)/.installed-test
	mkdir -p build/evaluation
	for suite in clean single pairs outside short idle_axis switched traps; do \
	    $(BIN)/python benchmarks/evaluate.py run build/evaluation/$$suite.jsonl --suite $$suite --count $(COUNT) --seed $(SEED) || exit 1; \
	done
	$(BIN)/python benchmarks/evaluate.py table build/evaluation/*.jsonl > build/evaluation/evaluation.md
	cat build/evaluation/evaluation.md

# the site: build/docs/index.html
docs: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[docs]'
	$(BIN)/python -m sphinx -W --keep-going -q docs build/docs

figures: $(VENV)/.installed
	$(BIN)/python docs/figures.py

clean:
	rm -rf $(VENV) demo_out build *.egg-info

$(VENV)/bin/python:
	$(PYTHON) -c 'import sys; sys.exit("found Python %d.%d, need 3.11 or newer: make PYTHON=python3.12" % sys.version_info[:2] if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)

# what is never imported is never compiled
PIP := $(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check
# where the listed files are known to be enough; elsewhere, and with HASHES=no, versions alone are pinned
HASHES ?= $(shell $(PYTHON) -c 'import platform as p, sys; print("yes" if sys.version_info >= (3, 11) and \
    (p.system(), p.machine(), p.libc_ver()[0]) == ("Linux", "x86_64", "glibc") else "no")')

$(VENV)/.installed: pyproject.toml constraints.txt hashes/demo.txt | $(VENV)/bin/python
ifeq ($(HASHES), yes)
	$(PIP) --require-hashes -r hashes/demo.txt
	$(PIP) --no-deps --no-build-isolation -e .
else
	$(PIP) -c constraints.txt 'setuptools>=77' wheel
	$(PIP) -c constraints.txt -e .
endif
	touch $@

$(VENV)/.installed-test: pyproject.toml constraints.txt hashes/test.txt | $(VENV)/bin/python
ifeq ($(HASHES), yes)
	$(PIP) --require-hashes -r hashes/test.txt
	$(PIP) --no-deps --no-build-isolation -e .
else
	$(PIP) -c constraints.txt 'setuptools>=77' wheel
	$(PIP) -c constraints.txt -e '.[test]'
endif
	touch $@ $(VENV)/.installed

# the lists of hashes anew, from constraints.txt
UV := $(BIN)/uv pip compile - pyproject.toml -c constraints.txt --universal --python-version 3.11 \
    --generate-hashes --no-header --no-annotate --quiet
hashes: $(VENV)/.installed-test
	$(PIP) uv
	printf 'setuptools>=77\nwheel\n' | $(UV) -o hashes/demo.txt
	printf 'setuptools>=77\nwheel\n' | $(UV) --extra test -o hashes/test.txt
