#include "app/option_table.h"

namespace vitral {
namespace {

constexpr const char* kProgram =
    "vitral renders a scene on the processor: a tile rasterizer finds what is visible, a kd-tree\n"
    "traced with SIMD packets adds shadows, reflection, refraction and ambient occlusion.\n"
    "\n"
    "  vitral [render] INPUT [-o FILE]   make a picture (PNG)\n"
    "  vitral bench INPUT                time every pass\n"
    "  vitral info INPUT                 count what is in it\n"
    "  vitral diff A B [-o FILE]         compare two PNGs\n"
    "  vitral help [COMMAND]             this page, or the page of a command\n"
    "\n"
    "INPUT is a project (.xml) or a mesh (.obj, .ply); a mesh gets a camera and a sun by itself.\n";

constexpr const char* kRenderPage =
    "vitral [render] INPUT [-o FILE]\n"
    "\n"
    "Renders a project (.xml) or a mesh (.obj, .ply) to a PNG. An option overrides the figure of the\n"
    "project; what stands in parentheses holds when nobody says otherwise.\n";

constexpr const char* kBenchPage =
    "vitral bench INPUT\n"
    "\n"
    "Loads the input, builds the trees and runs each pass over the whole picture by itself, several\n"
    "times by the clock; then the frame as a whole, without the build. Rays are counted, not estimated.\n";

constexpr const char* kInfoPage =
    "vitral info INPUT\n"
    "\n"
    "Loads the input and prints what is in it: triangles, materials, textures, lights, cameras,\n"
    "pipelines and bounds.\n";

constexpr const char* kDiffPage =
    "vitral diff A B [-o FILE]\n"
    "\n"
    "Compares the pixels of two PNGs exactly. -o writes a picture of the differences, scaled so that\n"
    "the largest is white. Exit code: 0 equal, 1 different (sizes too), 2 trouble.\n";

constexpr const char* kEnd =
    "\n"
    "--name=value and --name value are the same; -- ends the options. Warnings go to standard error.\n"
    "When that is a terminal, so do a progress bar and a one-line summary; otherwise a run that\n"
    "succeeds says nothing.\n"
    "Exit code: 0 done, 1 input or output failed, 2 wrong usage, 130 interrupted.\n"
    "An interruption (Ctrl-C) leaves no half-written file behind.\n";

// The options of some commands, under the headings of their groups.
std::string options_of(unsigned commands) {
  std::string page;
  std::string_view group;
  constexpr size_t kColumn = 28;
  for (const OptionRow& row : option_table()) {
    if (!(row.commands & commands)) continue;
    if (row.group != group) page += "\n" + std::string(row.group) + ":\n";
    group = row.group;
    std::string left = "  ";
    if (!row.short_name.empty()) left += std::string(row.short_name) + ", ";
    left += std::string(row.name);
    if (!row.value.empty()) left += " " + std::string(row.value);
    left.resize(std::max(kColumn, left.size() + 1), ' ');
    page += left;
    for (const char c : row.help) {
      page += c;
      if (c == '\n') page += std::string(kColumn, ' ');
    }
    page += '\n';
  }
  return page;
}

}  // namespace

std::string help_page(Command topic) {
  switch (topic) {
    case Command::render:
      return kRenderPage + options_of(bit(topic)) + kEnd;
    case Command::bench:
      return kBenchPage + options_of(bit(topic)) + kEnd;
    case Command::info:
      return kInfoPage + options_of(bit(topic));
    case Command::diff:
      return kDiffPage + options_of(bit(topic));
    default:
      return kProgram +
             options_of(bit(Command::render) | bit(Command::bench) | bit(Command::info) |
                        bit(Command::diff)) +
             kEnd;
  }
}

}  // namespace vitral
