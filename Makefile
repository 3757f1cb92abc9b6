# make demo | make test | make test-all: each sets up what it needs in $(VENV) first.
VENV ?= .venv
PYTHON ?= python3
BIN = $(VENV)/bin
TORCH ?= torch==2.13.0
PYTEST = $(BIN)/python -m pytest --numprocesses auto --maxprocesses 4

.PHONY: demo test test-all lint clean

demo: $(VENV)/.installed
	$(BIN)/motionseek demo

test: $(VENV)/.installed-test
	$(PYTEST) -m "not slow"

test-all: $(VENV)/.installed-train
	$(PYTEST)

lint: $(VENV)/.installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

$(BIN)/python:
	$(PYTHON) -m venv $(VENV) || { echo "python3 -m venv failed; on Debian and Ubuntu: apt-get install python3-venv" >&2; exit 1; }

$(VENV)/.installed: $(BIN)/python pyproject.toml
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[serve]'
	touch $@

$(VENV)/.installed-test: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test,lint]'
	touch $@

# The CPU build of torch comes first: asked for by another package, pip would take the one with CUDA.
$(VENV)/.installed-train: $(VENV)/.installed-test
	$(BIN)/python -m pip install --quiet --disable-pip-version-check $(TORCH)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test,lint,train,milvus,objects]'
	touch $@

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache
