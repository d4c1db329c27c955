# vitral. `make help` lists the targets.
#
#   config=release|debug|asan|tsan   what is built, under out/<config>      (release)
#   CXX=g++|clang++                  the compiler
#   STB_INCLUDE=DIR                  a folder that holds stb_image.h, instead of the system's
#   PREFIX=DIR                       where `make install` puts things       (/usr/local)

ifeq ($(origin CXX),default)
  CXX := g++
endif
config  ?= release
PREFIX  ?= /usr/local
DESTDIR ?=
comma   := ,

FLAGS_release := -O3
FLAGS_debug   := -O0 -g
FLAGS_asan    := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
FLAGS_tsan    := -O1 -g -fsanitize=thread
ifeq ($(FLAGS_$(config)),)
  $(error config=$(config) is not one of release, debug, asan, tsan)
endif

# The picture is the same set of bytes on every machine: no contraction to fused multiply-add, no
# fast-math. -Wno-psabi: vectors wider than the baseline's registers never cross a function call.
CXXFLAGS_ALL := -std=c++20 $(FLAGS_$(config)) -ffp-contract=off -fno-math-errno -pthread \
                -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-psabi \
                -Iinclude -Isrc -MMD -MP $(CXXFLAGS)
ifeq ($(findstring clang,$(CXX)),)
  # GCC 12 sees overlapping copies inside std::string's operator+ where there are none (GCC PR 105651).
  CXXFLAGS_ALL += -Wno-restrict
endif
LDFLAGS_ALL  := $(FLAGS_$(config)) -pthread $(LDFLAGS)
ifneq ($(STB_INCLUDE),)
  STB_FLAGS := -isystem $(STB_INCLUDE)
else
  STB_FLAGS := -isystem /usr/include/stb
endif

# One list of instruction sets: every file of src/kernels is compiled once for each. ISAS="scalar avx512" builds
# these only.
ifneq ($(filter x86_64 amd64,$(shell uname -m)),)
  ISAS := scalar v2 avx2 avx512
else
  ISAS := scalar
endif
ISA_scalar := -DLANES=1
ISA_v2     := -DLANES=4 -march=x86-64-v2
ISA_avx2   := -DLANES=8 -march=x86-64-v3
ISA_avx512 := -DLANES=16 -march=x86-64-v4 -mprefer-vector-width=512

CXXFLAGS_ALL += '-DVITRAL_FOR_EACH_ISA(X)=$(foreach isa,$(ISAS),X($(isa)))'

OUT     := out/$(config)
KERNELS := $(foreach isa,$(ISAS),$(patsubst src/kernels/%.cpp,$(OUT)/obj/kernels/$(isa)/%.o,$(wildcard src/kernels/*.cpp)))
LIBRARY := $(patsubst src/%.cpp,$(OUT)/obj/%.o,$(filter-out src/app/main.cpp src/kernels/%,$(wildcard src/*/*.cpp)))
TESTS   := $(patsubst tests/%.cpp,$(OUT)/obj/tests/%.o,$(wildcard tests/*.cpp))
PLAZA   := $(patsubst scenes/%.cpp,$(OUT)/obj/scenes/%.o,$(wildcard scenes/plaza/*.cpp))
FOREST  := $(patsubst scenes/%.cpp,$(OUT)/obj/scenes/%.o,$(wildcard scenes/forest/*.cpp))

.DEFAULT_GOAL := all
.PHONY: all demo test golden figures check-isa bench install uninstall clean help plaza forest FORCE
.DELETE_ON_ERROR:

all: $(OUT)/vitral out/plaza/plaza.obj

help:
	@echo 'make [TARGET] [config=release|debug|asan|tsan] [CXX=g++|clang++]'
	@echo '  all        build out/<config>/vitral and generate the plaza (the default)'
	@echo '  demo       render the plaza with all effects to out/final.png'
	@echo '  plaza      generate the plaza: out/plaza/{plaza.obj,plaza.mtl,*.png}'
	@echo '  forest     generate a forest of 10,000 trees, 10^8 triangles: out/forest/forest.xml'
	@echo '  test       build and run all tests, unit and golden'
	@echo '  golden     rewrite the golden images, then fail so that it cannot be left on'
	@echo '  figures    render every project of scenes/ to out/figures'
	@echo '  check-isa  prove that no kernel shares code with another instruction set'
	@echo '  bench      time every pass on the plaza, and print the tables of effects and samples'
	@echo '  install    copy vitral to $$(DESTDIR)$$(PREFIX)/bin; uninstall removes it'
	@echo '  clean      remove everything under out/'

# --- the program -------------------------------------------------------------------------------

$(OUT)/vitral: $(OUT)/obj/app/main.o $(LIBRARY) $(KERNELS)
	$(CXX) $(LDFLAGS_ALL) $^ -o $@

# Objects depend on this file, which changes only when the compiler or the flags do.
$(OUT)/flags: FORCE
	@mkdir -p $(@D)
	@echo "$(CXX) $(CXXFLAGS_ALL) $(STB_FLAGS) $(LDFLAGS_ALL) $(foreach isa,$(ISAS),$(ISA_$(isa)))" | cmp -s - $@ || \
	  echo "$(CXX) $(CXXFLAGS_ALL) $(STB_FLAGS) $(LDFLAGS_ALL) $(foreach isa,$(ISAS),$(ISA_$(isa)))" > $@

# What the build needs is asked for once, so that what is missing is answered with how to get it.
$(OUT)/compiler: $(OUT)/flags
	@$(CXX) -std=c++20 -fsyntax-only -x c++ /dev/null || \
	  { echo 'The compiler $(CXX) does not run, or not as C++20. Install one with:  sudo apt-get install -y g++'; exit 1; }
	@touch $@

$(OUT)/stb: $(OUT)/compiler
	@printf '#include <stb_image.h>\n#include <stb_image_write.h>\n' | $(CXX) $(STB_FLAGS) -fsyntax-only -x c++ - 2>/dev/null || \
	  { echo '$(if $(STB_INCLUDE),There are no stb_image.h and stb_image_write.h in STB_INCLUDE=$(STB_INCLUDE).,stb is missing. Install it with:  sudo apt-get install -y libstb-dev)'; exit 1; }
	@touch $@

$(OUT)/gtest: $(OUT)/compiler
	@printf '#include <gtest/gtest.h>\nint main() {}\n' | $(CXX) -std=c++20 -pthread -x c++ - -lgtest -o $@.try 2>/dev/null || \
	  { echo 'GoogleTest is missing. Install it with:  sudo apt-get install -y libgtest-dev'; exit 1; }
	@rm -f $@.try && touch $@

$(OUT)/obj/%.o: src/%.cpp $(OUT)/flags $(OUT)/stb
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS_ALL) $(STB_FLAGS) -c $< -o $@

define kernel_rule
$(OUT)/obj/kernels/$(1)/%.o: src/kernels/%.cpp $(OUT)/flags $(OUT)/compiler
	@mkdir -p $$(@D)
	$$(CXX) $$(CXXFLAGS_ALL) $$(ISA_$(1)) -DVITRAL_ISA=$(1) -c $$< -o $$@
endef
$(foreach isa,$(ISAS),$(eval $(call kernel_rule,$(isa))))

# A weak symbol outside the kernels' own namespaces could be merged with the copy of another
# instruction set and then run where it must not.
check-isa: $(KERNELS)
	@! nm -AC $^ | grep -E ' [WVu] ' | grep -vE 'vitral::($(subst $(eval ) ,|,$(ISAS)))::|DW.ref|__(asan|tsan|ubsan)' || \
	  { echo 'check-isa: the symbols above are shared between instruction sets'; exit 1; }
	@echo 'check-isa: no symbol is shared'

# --- the plaza and the demo --------------------------------------------------------------------

$(OUT)/obj/scenes/%.o: scenes/%.cpp $(OUT)/flags $(OUT)/stb
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS_ALL) $(STB_FLAGS) -c $< -o $@

$(OUT)/plaza: $(PLAZA)
	$(CXX) $(LDFLAGS_ALL) $^ -o $@

out/plaza/plaza.obj: $(OUT)/plaza
	@mkdir -p $(@D)
	$(OUT)/plaza $(@D)

plaza: out/plaza/plaza.obj

$(OUT)/forest: $(FOREST)
	$(CXX) $(LDFLAGS_ALL) $^ -o $@

out/forest/forest.xml: $(OUT)/forest
	$(OUT)/forest out/forest/forest

forest: out/forest/forest.xml

demo: $(OUT)/vitral out/plaza/plaza.obj
	$(OUT)/vitral scenes/SceneFinal.xml -o out/final.png

figures: $(OUT)/vitral out/plaza/plaza.obj
	@mkdir -p out/figures
	for scene in scenes/*.xml; do $(OUT)/vitral $$scene -o out/figures/$$(basename $$scene .xml).png || exit 1; done

bench: $(OUT)/vitral out/plaza/plaza.obj
	$(OUT)/vitral bench scenes/SceneFinal.xml --repeat 3
	@echo
	$(OUT)/vitral bench scenes/SceneFinal.xml --repeat 3 --report

# --- tests -------------------------------------------------------------------------------------

$(OUT)/obj/tests/%.o: tests/%.cpp $(OUT)/flags $(OUT)/gtest
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS_ALL) $(STB_FLAGS) -c $< -o $@

$(OUT)/tests: $(TESTS) $(LIBRARY) $(KERNELS)
	$(CXX) $(LDFLAGS_ALL) $^ -lgtest -o $@

test: $(OUT)/vitral $(OUT)/tests $(OUT)/plaza $(OUT)/forest check-isa
	VITRAL=$(OUT)/vitral PLAZA=$(OUT)/plaza FOREST=$(OUT)/forest $(OUT)/tests

golden: $(OUT)/vitral $(OUT)/tests
	VITRAL=$(OUT)/vitral VITRAL_GOLDEN=rewrite $(OUT)/tests --gtest_filter='Golden*'

# --- housekeeping ------------------------------------------------------------------------------

install: $(OUT)/vitral out/plaza/plaza.obj
	install -D -m 755 $(OUT)/vitral $(DESTDIR)$(PREFIX)/bin/vitral

uninstall:
	rm -f $(DESTDIR)$(PREFIX)/bin/vitral

clean:
	find out -mindepth 1 -maxdepth 1 ! -name .gitignore -exec rm -rf {} +

FORCE:

-include $(patsubst %.o,%.d,$(KERNELS) $(LIBRARY) $(TESTS) $(PLAZA) $(FOREST) $(OUT)/obj/app/main.d)
