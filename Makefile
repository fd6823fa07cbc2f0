# The commands of a day's work; 'make help' lists them. CMake does the building: this file only saves the typing.
#
# Variables: PRESET       release, debug or asan (CMakePresets.json)
#            CMAKE_FLAGS  more for CMake's configuration, such as -DQUINTET_WERROR=ON
#            CTEST_FLAGS  more for CTest, such as '-R scene'
#            JOBS         how many compilers and tests at a time

PRESET      ?= release
CMAKE_FLAGS ?=
CTEST_FLAGS ?=
JOBS        ?= $(shell nproc 2>/dev/null || echo 2)

BUILD := build/$(PRESET)
DEMO  := build/demo
SCENES := build/scenes

# How the demo is rendered: 50 seconds, as many samples as fit.
RENDER_FLAGS ?= --size 800x450 --time 50
BENCH_FLAGS  ?=
# --only NAME, --fast, --list
MUTATION_FLAGS ?=
# --fix
LINT_FLAGS ?=

.DEFAULT_GOAL := build
.PHONY: demo test build setup bench lessons reference mutation lint clean help configure
# One step after the other; each of them runs in parallel by itself.
.NOTPARALLEL:

demo: build ## Set up, build, make the demo scene, render it
	@$(BUILD)/bin/quintet_make_demo $(DEMO)
	@$(BUILD)/bin/quintet render $(DEMO)/demo.glb --env $(DEMO)/sky.hdr -o $(DEMO)/demo.png $(RENDER_FLAGS)
	@echo "The picture: $(DEMO)/demo.png"

test: build ## Set up, build, run every test
	@ctest --preset $(PRESET) --output-on-failure --no-tests=error -j $(JOBS) $(CTEST_FLAGS)

build: configure ## Set up and build
	@cmake --build --preset $(PRESET) -j $(JOBS)

configure: setup
	@cmake --preset $(PRESET) $(CMAKE_FLAGS)

setup: ## Install the packages that are missing (scripts/setup.sh --plan: only say which)
	@bash scripts/setup.sh

bench: build ## Measure rays per second against the device's own ceiling (BENCH_FLAGS)
	@$(BUILD)/bin/quintet_make_scenes $(SCENES)
	@$(BUILD)/bin/quintet bench $(SCENES)/bench.glb $(BENCH_FLAGS)

lessons: build ## Render the picture of every lesson's page (docs/lessons)
	@bash scripts/lessons.sh $(BUILD)/bin/quintet

reference: build ## Compare with the reference images and values (tests/reference/run)
	@QUINTET=$(CURDIR)/$(BUILD)/bin/quintet tests/reference/run

mutation: build ## Seed bugs one at a time and see that the tests notice (tests/mutation/run)
	@tests/mutation/run $(BUILD)/bin --jobs $(JOBS) $(MUTATION_FLAGS)

lint: ## Check the layout of C++ and the scripts (LINT_FLAGS=--fix: lay out the C++)
	@bash scripts/lint.sh $(LINT_FLAGS)

clean: ## Remove everything that was built
	@rm -rf build

help: ## Say what there is
	@sed -n 's/^\([a-z]*\):.* ## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 20
