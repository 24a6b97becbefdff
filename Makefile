# `make demo` and `make test` set up what they need. Everything lives in .venv; PYTHON chooses another Python.
VENV := .venv
PYTHON ?= python3.11
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed# what `peopleboy` needs
READY := $(VENV)/.ready# and what its development does
PIP := $(BIN)/uv pip install --quiet --python $(BIN)/python --constraint constraints.txt

# Bytecode that is kept saves each of the processes that tests start some of its start.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test test-pages test-heavy test-install fuzz kill-tests soak lint format bench peers rl pages docs dist lock audit docker forget-kernels clean

demo: $(INSTALLED)
	$(BIN)/peopleboy run sunny_hall --out runs/demo --overwrite

# A file's tests in one process: what they share is made, and compiled, once. `make test SLOW=1` runs whole runs,
# lessons and reports, too, a second or more each; `make test THOROUGH=1` besides does with all what tests do with a
# few: scenarios of the library, long films, whole studies.
OTHERS_OUT := not heavy and not install and not pages
test: $(READY)
	$(BIN)/python -m pytest -n 2 --dist loadfile $(if $(THOROUGH),-m '$(OTHERS_OUT)',$(if $(SLOW),-m '$(OTHERS_OUT) and not thorough'))

# Run every command and code block of the README, the tutorials and the how-to guides.
test-pages: $(READY)
	$(BIN)/python -m pytest -n 2 -m pages

# Random inputs for everything that reads what users write: about 20 000.
fuzz: $(READY)
	FUZZ_EXAMPLES=2400 $(BIN)/python -m pytest -n 2 tests/test_fuzz.py tests/test_refused_inputs.py

# Kill commands at random moments, check what they leave, and resume them.
kill-tests: $(READY)
	$(BIN)/python -m benchmarks.reliability.kills

# Hours of simulated time and thousands of environments in one process.
soak: $(READY)
	$(BIN)/python -m benchmarks.reliability.soak

test-heavy: $(READY)
	$(BIN)/python -m pytest -m heavy

# A wheel in empty environments, with and without PyBullet. Needs a package index, and Python 3.12 or 3.13 beside 3.11.
test-install: $(READY)
	$(BIN)/python -m pytest -m install

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(READY)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(READY)
	$(BIN)/python -m benchmarks $(if $(COMPARE),--compare $(COMPARE))

peers: $(READY)
	$(BIN)/python -m benchmarks.peers

# For examples/learning/ppo.py. PyPI's torch would bring gigabytes of CUDA along.
rl: $(READY)
	$(PIP) --no-deps --index-url https://download.pytorch.org/whl/cpu torch
	$(PIP) --editable '.[rl,viewer]'

# The parts of pages that are made from the code, and from the figures in docs/results.yaml.
pages: $(READY)
	$(BIN)/python -m docs.generate

# Strictly: a warning is an error. Leaves build/docs/index.html, which needs no server and no network.
# Its pictures are drawn by `python -m docs.generate.pictures`, and kept.
docs: $(READY)
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet

# Leaves dist/: an sdist and the wheel that is made from it, both looked at as PyPI would.
dist: $(READY)
	rm -rf dist
	$(BIN)/uv build --quiet --python $(BIN)/python
	$(BIN)/python -m twine check --strict dist/*

# The newest versions that fit together: uv.lock for uv, and the same as constraints for pip.
lock: $(INSTALLED)
	$(BIN)/uv lock --quiet --upgrade
	.ci/constraints > constraints.txt

# What looks at workflows, Dockerfile and metadata.
audit: $(READY)
	$(PIP) --group audit
	.ci/audit

# An image in which `peopleboy` is the command.
docker:
	docker build --tag peopleboy .

# numba looks only at a kernel's own file: after a pull, or after editing one that others inline, throw its cache away.
forget-kernels:
	find . -name '*.nb[ic]' -delete

clean: forget-kernels
	rm -rf $(VENV) runs build/docs dist

$(INSTALLED): pyproject.toml constraints.txt
	@set -e; \
	if [ ! -x $(BIN)/python ]; then \
	  for python in "$(PYTHON)" python3.11 python3.12 python3.13 python3; do \
	    if "$$python" -c 'import ensurepip, sys, venv; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null; then \
	      "$$python" -m venv $(VENV); break; \
	    fi; \
	  done; \
	fi; \
	if [ ! -x $(BIN)/python ]; then \
	  if command -v uv >/dev/null 2>&1; then uv venv --quiet --seed --python 3.11 $(VENV); \
	  else echo "PeopleBoy needs Python 3.11, 3.12 or 3.13 with its venv module, or uv (https://docs.astral.sh/uv)" >&2; exit 2; \
	  fi; \
	fi
	# uv installs all the rest in a fifth of pip's time.
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --upgrade pip setuptools uv
	$(PIP) --editable '.[viewer]'
	@touch $(INSTALLED)

$(READY): $(INSTALLED)
	$(PIP) --editable '.[dev]'
	@touch $(READY)
