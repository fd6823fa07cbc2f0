# SPDX-License-Identifier: Apache-2.0
# Shortcuts for frequent commands; 'make help' lists them. CMake does the actual build.
#
# Variables: PRESET       release or debug (CMakePresets.json)
#            SANITIZER    asan (default) or tsan, for `make sanitize`
#            CMAKE_FLAGS  additional options of the CMake configuration, such as -DQUINTET_WERROR=ON
#            CTEST_FLAGS  additional options of CTest, such as '-R scene'
#            SUITES       tests that `make test` runs: short (default), long or all
#            JOBS         number of parallel compilers and tests

PRESET      ?= release
CMAKE_FLAGS ?=
CTEST_FLAGS ?=
SUITES      ?= short
SANITIZER   ?= asan
JOBS        ?= $(shell nproc 2>/dev/null || echo 2)

BUILD := build/$(PRESET)
DEMO  := build/demo
SCENES := build/scenes

# Render options of the demo: as many samples as possible in 40 seconds.
RENDER_FLAGS ?= --size 800x450 --time 40
BENCH_FLAGS  ?=
# --only NAME, --fast, --list
MUTATION_FLAGS ?=
# --seconds N, --runs N, --seed S, names of targets
FUZZ_FLAGS ?=
# --fix
LINT_FLAGS ?=

.DEFAULT_GOAL := build
.PHONY: demo test check-fast build setup bench lessons reference mutation sanitize fuzz docs lint tidy clean help configure
# Targets run one by one; each of them is parallel.
.NOTPARALLEL:

# Does not build or install what only the tests require. The tests stay configured if they are.
demo: ## Install packages, build, create the demo scene and render it
	@bash scripts/setup.sh build
	@cmake --preset $(PRESET) $$(test -e $(BUILD)/build.ninja || echo -DQUINTET_TESTS=OFF) $(CMAKE_FLAGS)
	@cmake --build --preset $(PRESET) -j $(JOBS) --target quintet quintet_make_demo
	@$(BUILD)/bin/quintet_make_demo $(DEMO)
	@$(BUILD)/bin/quintet render $(DEMO)/demo.glb --env $(DEMO)/sky.hdr -o $(DEMO)/demo.png $(RENDER_FLAGS)
	@echo "Image: $(DEMO)/demo.png"

# Inserting bugs, building the examples against the installed package, and the longest suites take half of the time: `make test
# SUITES=long`, which CI runs, too. `ctest --preset release -L nightly` takes another hour: it compiles each header alone and the
# library inside a second project, checks all tasks of the lessons in the browser, and runs a few suites of minutes each.
SUITE_FLAGS_short := -LE '^(mutation|long|nightly)$$'
SUITE_FLAGS_long  := -L '^(mutation|long)$$'
SUITE_FLAGS_all   := -LE '^nightly$$'
$(if $(SUITE_FLAGS_$(SUITES)),,$(error SUITES is '$(SUITES)' instead of short, long or all))

test: build ## Install packages, build and run the tests (SUITES)
	@ctest --preset $(PRESET) --output-on-failure --no-tests=error -j $(JOBS) $(SUITE_FLAGS_$(SUITES)) $(CTEST_FLAGS)

check-fast: ## Check style and layers, and run the unit tests of the layers that differ from HEAD
	@bash scripts/check_fast.sh

build: configure ## Install packages and build
	@cmake --build --preset $(PRESET) -j $(JOBS)

configure: setup
	@cmake --preset $(PRESET) -DQUINTET_TESTS=ON $(CMAKE_FLAGS)

setup: ## Install missing packages (scripts/setup.sh --plan only lists them)
	@bash scripts/setup.sh build viewer lab test

bench: build ## Measure rays per second relative to the limit of the device (BENCH_FLAGS)
	@$(BUILD)/bin/quintet_make_scenes $(SCENES)
	@$(BUILD)/bin/quintet bench $(SCENES)/bench.glb $(BENCH_FLAGS)

lessons: build ## Copy the excerpts into the lesson pages (docs/lessons) and render their images
	@bash scripts/excerpts.sh
	@bash scripts/lessons.sh $(BUILD)/bin/quintet

reference: build ## Compare with the reference images, and run the tests of ../shared (tests/reference/run)
	@QUINTET=$(CURDIR)/$(BUILD)/bin/quintet tests/reference/run

mutation: build ## Insert bugs one by one and check that the tests detect them (tests/mutation/run)
	@tests/mutation/run $(BUILD)/bin --jobs $(JOBS) $(MUTATION_FLAGS)

# Errors of memory, undefined behavior and leaks: all unit tests and the window, which is missing if it is not built.
SANITIZE_TARGETS_asan := quintet_unit_tests quintet_all_window_tests
SANITIZE_TESTS_asan   := -LE '^nightly$$' -L '^(unit|window)$$'
# Data races: the unit tests and whatever runs in several threads, which are sessions, several devices, the lab and the layer.
SANITIZE_TARGETS_tsan := quintet_unit_tests quintet_gpu_tests quintet_api_tests quintet_lab_tests quintet_layer_tests \
                         quintet_layer_parts_tests
SANITIZE_TESTS_tsan   := -LE '^nightly$$' -R '^((unit|api|lab|layer)\.|gpu\.(Session|.*Job|ProgramDraft|EarlyPipelines|SampleSearch))'
$(if $(SANITIZE_TARGETS_$(SANITIZER)),,$(error SANITIZER is '$(SANITIZER)' instead of asan or tsan))

sanitize: setup ## Build with ASan and UBSan, and run the unit tests and the window; SANITIZER=tsan finds data races
	@cmake --preset $(SANITIZER) -DQUINTET_TESTS=ON $(CMAKE_FLAGS)
	@cmake --build --preset $(SANITIZER) -j $(JOBS) --target $(SANITIZE_TARGETS_$(SANITIZER))
	@ctest --preset $(SANITIZER) $(SANITIZE_TESTS_$(SANITIZER)) --no-tests=error -j $(JOBS) $(CTEST_FLAGS)

fuzz: ## Install Clang, and run the readers of all file formats with random inputs (FUZZ_FLAGS, build/fuzz)
	@bash scripts/setup.sh build fuzz
	@cmake --preset fuzz $(CMAKE_FLAGS)
	@cmake --build --preset fuzz -j $(JOBS)
	@tests/fuzz/targets/run --jobs $(JOBS) $(FUZZ_FLAGS)

docs: ## Install Doxygen and build the reference of the C++ API (build/docs/html/index.html)
	@bash scripts/setup.sh docs
	@bash scripts/docs.sh

lint: ## Install the tools and check the format of C++ and the scripts (LINT_FLAGS=--fix formats the C++ files)
	@bash scripts/setup.sh lint
	@bash scripts/lint.sh $(LINT_FLAGS)

tidy: configure ## Install clang-tidy and check the C++ sources (takes an hour on two cores)
	@bash scripts/setup.sh tidy
	@bash scripts/lint.sh --tidy

clean: ## Remove all build results
	@rm -rf build

help: ## List all targets
	@sed -n 's/^\([a-z-]*\):.* ## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 20
