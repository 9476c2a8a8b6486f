# Two commands for a new user: `make demo` and `make test`. Both work offline once installed.
# `make test` runs what a change can break, `make test-all` everything; tests/README.md says more.
PYTHON ?= python3
BIN := .venv/bin
INSTALLED := .venv/.installed

# Compiled sources are kept, whatever the caller's environment says: every worker and every command
# that a test starts would compile the package anew.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test test-all compiled check typed linted derived lock benchmark reports campaign tutorial nightly package oldest newest clean

demo: $(INSTALLED)
	$(BIN)/meso-robust plan --out reports/demo

# A worker that dies (a test that waits for ever, a crash) ends the run by that test's name: xdist would
# start another, and with whole files for workers then waits for ever itself.
test: compiled
	$(BIN)/python -m pytest -q -n auto --dist loadfile --no-loadscope-reorder --max-worker-restart=0 --fast $(ALSO)

test-all: compiled
	$(BIN)/python -m pytest -q -n auto --dist loadfile --no-loadscope-reorder --max-worker-restart=0

# Kernels are compiled once, before several workers would each compile them: that of events by one process,
# those that `plan` and `track` call by another (and `simulator.ahead`).
compiled: $(INSTALLED)
	@$(BIN)/python -c "from tests.compiled import compile_events; compile_events()" & other=$$!; folder=$$(mktemp -d) && \
	$(BIN)/meso-robust plan --quiet --samples 10 --out "$$folder/plan" && \
	$(BIN)/meso-robust example "$$folder/latch" > /dev/null && \
	$(BIN)/meso-robust track "$$folder/latch/videos/push_5.mp4" --commands "$$folder/latch/videos" --task "$$folder/latch/task.toml" \
	  --grid "$$folder/latch/grid.png" --pitch-um 200 --tip-radius-um 12.5 --start ",,0" --no-overlay --quiet --out "$$folder/set" > /dev/null && rm -r "$$folder" && wait $$other

# mypy keeps one core busy, derivations another.
check: $(INSTALLED)
	$(MAKE) --jobs 2 typed linted derived

typed: $(INSTALLED)
	$(BIN)/mypy

linted: $(INSTALLED)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

derived: $(INSTALLED)
	$(BIN)/meso-robust derive --check

# The peers live in a folder of their own, seen by this target alone.
benchmark: PEERS := .venv/peers
benchmark: $(INSTALLED)
	test -d $(PEERS)/codac || $(BIN)/uv pip install --quiet --no-deps --require-hashes \
	  --python $(BIN)/python --target $(PEERS) --requirement reports/benchmarks/requirements.lock
	PYTHONPATH=$(PEERS) $(BIN)/python -m reports.benchmarks --peers --out reports/benchmarks/simulator.md
	PYTHONPATH=$(PEERS) $(BIN)/python -m reports.benchmarks.bounds --out reports/benchmarks/bounds.md
	$(BIN)/python -m reports.benchmarks.executions --out reports/benchmarks/executions.md
	$(BIN)/python -m reports.benchmarks.campaigns --out reports/benchmarks/campaigns.md
	$(BIN)/python -m reports.benchmarks.waits --out reports/benchmarks/waits.md

$(INSTALLED): pyproject.toml requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "meso-robust needs Python 3.11 or newer; $(PYTHON) is older. Use: make PYTHON=python3.11 $(MAKECMDGOALS)"; exit 2; }
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -c 'import uv' 2>/dev/null || $(BIN)/pip install --quiet "$$(grep -o '^uv==[0-9.]*' requirements.lock)"
	$(BIN)/uv pip install --quiet --python $(BIN)/python --require-hashes --requirement requirements.lock
	$(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps --no-build-isolation --editable .
	touch $@

reports: $(INSTALLED)
	$(BIN)/meso-robust derive
	$(BIN)/meso-robust plan --maps --out reports/paper_task
	$(BIN)/python -m reports.paper_task.picture reports/paper_task/report.html --out reports/paper_task/report.png
	$(BIN)/python -m reports.tasks.start_sweep --out reports/tasks
	$(BIN)/python -m reports.tasks.adhesion --out reports/tasks
	$(BIN)/python -m reports.policy.campaign --runs 2000
	$(BIN)/python -m reports.simulator.convergence --out reports/simulator/convergence.md
	$(BIN)/python -m reports.simulator.jam_thresholds --out reports/simulator/jam_thresholds.md
	$(BIN)/python -m reports.simulator.inertia_report --out reports/simulator
	$(BIN)/python -m reports.simulator.effects_report --out reports/simulator/effects.md
	$(BIN)/python -m reports.dry_support.report --out reports/dry_support
	$(BIN)/python -m reports.identification.sensitivity_report --out reports/identification
	$(BIN)/meso-robust reproduce --out reports/reproduction
	$(BIN)/python -m reports.reproduction.table

# A new clone, its demo and the tutorial in a new folder, every command with its time.
tutorial: $(INSTALLED)
	$(BIN)/python -m reports.tutorial.walk --clone . --out reports/tutorial/times.md

# The full forms of the campaigns: hours on two cores. Those of the verb go on where they stand.
campaign: $(INSTALLED)
	$(BIN)/python -m reports.campaigns.refuted
	for name in falsify mutation properties; do \
	  $(BIN)/meso-robust campaign reports/campaigns/$$name.toml --out reports/campaigns/$$name --resume || exit 1; \
	done
	$(BIN)/python -m reports.tracking.accuracy --films 60 --film 14 --seed 5077 --jobs 2 --out reports/tracking/accuracy.md
	$(BIN)/python -m reports.identification.recovery
	$(BIN)/python -m reports.identification.design_report --sets 80 --out reports/identification
	$(BIN)/python -m reports.blind.campaign --workers 2 --quick-diagnosis --out reports/blind/next_trial
	$(BIN)/python -m reports.simulator.campaign --runs 100000 --out reports/simulator/campaign.md
	$(BIN)/python -m reports.foreign_plant.campaign

# What takes too long for every change.
nightly: $(INSTALLED)
	MESO_NIGHTLY=1 $(BIN)/python -m pytest -q -n auto --dist loadfile --no-loadscope-reorder --max-worker-restart=0

# Wheel and sdist, each in a clean environment of its own: plan, certificate, check.
package: $(INSTALLED)
	$(BIN)/python -m reports.release.clean

# The fast tests on the oldest and on the newest dependencies; ON names another interpreter.
ON ?= $(shell $(BIN)/python -c 'import platform; print(platform.python_version())')
oldest newest: $(INSTALLED)
	$(BIN)/python -m reports.release.compatibility $@ --python $(ON)

lock:
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --extra dev --generate-hashes \
	  --no-header --no-annotate --no-emit-index-url pyproject.toml --output-file requirements.lock

clean:
	rm -rf .venv reports/demo .mypy_cache .ruff_cache .pytest_cache .hypothesis
