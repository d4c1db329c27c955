// Reads the table "who may include whom" of README.md and every #include "..." line of include/ and
// src/, and fails on an arrow that the table does not have. A row of the table is
//
//   | `src/math/` | what lives there | include |
//
// Its last column lists, with commas between them, the folders that may be included, single headers
// (kdtree/kdtree.h), or the word `nothing`. A folder may always include itself.
#include "scratch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace vitral {
namespace {

namespace fs = std::filesystem;

using Table = std::map<std::string, std::set<std::string>>;  // folder -> what it may include

// Without spaces and backquotes at the ends and without a slash at the last.
std::string bare(std::string text) {
  const auto strip = [&](const char* what) {
    const size_t begin = text.find_first_not_of(what), end = text.find_last_not_of(what);
    text = begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
  };
  strip(" `\t\r");
  while (!text.empty() && text.back() == '/') text.pop_back();
  return text;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

// "src/math" is the folder math, "include/vitral" the folder include.
std::string folder_name(const std::string& path) {
  if (path == "include/vitral" || path == "include") return "include";
  return path.starts_with("src/") ? path.substr(4) : "";
}

Table read_table(const std::string& markdown) {
  Table table;
  for (const std::string& line : split(markdown, '\n')) {
    const std::vector<std::string> cells = split(line, '|');  // the first one is empty
    if (cells.size() < 4 || !cells[0].empty()) continue;
    const std::string folder = folder_name(bare(cells[1]));
    if (folder.empty()) continue;
    std::set<std::string>& allowed = table[folder];
    for (const std::string& word : split(cells[3], ',')) {
      const std::string name = bare(word);
      if (name != "nothing" && name != "the standard library") allowed.insert(name);
    }
  }
  return table;
}

// The complaint about one line of a file of `folder`; empty when there is none.
std::string check_line(const Table& table, const std::string& folder, const std::string& line) {
  const size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line[hash] != '#') return "";
  const size_t word = line.find_first_not_of(" \t", hash + 1);
  if (word == std::string::npos || line.compare(word, 7, "include") != 0) return "";
  const size_t open = line.find_first_not_of(" \t", word + 7);
  if (open == std::string::npos || line[open] != '"') return "";
  const std::string header = line.substr(open + 1, line.find('"', open + 1) - open - 1);

  const size_t slash = header.find('/');
  if (slash == std::string::npos) return "\"" + header + "\" names no folder";
  const std::string first = header.substr(0, slash);
  const std::string target = first == "vitral" ? "include" : first;
  if (target == folder) return "";
  const auto row = table.find(folder);
  if (row == table.end()) return "the table has no row for " + folder;
  if (row->second.contains(target) || row->second.contains(header)) return "";
  return folder + " may not include \"" + header + "\"";
}

std::vector<fs::path> sources(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".h" || path.extension() == ".cpp") files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(Layering, CatchesAForbiddenArrow) {
  const Table table = read_table(
      "| folder | what lives there | may include |\n|---|---|---|\n"
      "| `include/vitral/` | the nouns | nothing |\n"
      "| `src/math/` | numbers | include |\n"
      "| `src/kernels/` | loops | include, `math`, kdtree/kdtree.h |\n"
      "| elsewhere | text | `src/app/` |\n");
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(check_line(table, "math", "#include \"vitral/vec.h\""), "");
  EXPECT_EQ(check_line(table, "math", "#include \"math/random.h\""), "");
  EXPECT_EQ(check_line(table, "math", "#include <kdtree/walk.h>"), "") << "not ours";
  EXPECT_EQ(check_line(table, "math", "// #include \"app/main.h\""), "");
  EXPECT_EQ(check_line(table, "kernels", "#include \"kdtree/kdtree.h\""), "");
  EXPECT_EQ(check_line(table, "math", "#include \"app/options.h\""),
            "math may not include \"app/options.h\"");
  EXPECT_NE(check_line(table, "math", "  #  include \"kdtree/kdtree.h\" // why"), "");
  EXPECT_NE(check_line(table, "include", "#include \"math/random.h\""), "");
  EXPECT_NE(check_line(table, "kernels", "#include \"kdtree/walk.h\""), "");
  EXPECT_NE(check_line(table, "kernels", "#include \"packet.h\""), "");
  EXPECT_NE(check_line(table, "elsewhere", "#include \"math/random.h\""), "") << "no row";
}

TEST(Layering, TheTableOfTheReadmeHolds) {
  ASSERT_TRUE(fs::exists("README.md")) << "run the tests in the folder of the README";
  const Table table = read_table(test::read_text("README.md"));
  ASSERT_FALSE(table.empty()) << "README.md has no table of who may include whom";

  // Every folder has its row, and every row names folders and headers that are there.
  std::set<std::string> folders{"include"};
  for (const auto& entry : fs::directory_iterator("src")) {
    if (entry.is_directory()) folders.insert(entry.path().filename().string());
  }
  for (const std::string& folder : folders)
    EXPECT_TRUE(table.contains(folder)) << folder << " is not in the table";
  for (const auto& [folder, allowed] : table) {
    EXPECT_TRUE(folders.contains(folder)) << folder << " is in the table and nowhere else";
    for (const std::string& name : allowed) {
      EXPECT_TRUE(folders.contains(name) || fs::exists("src/" + name))
          << folder << " may include " << name << "?";
      EXPECT_TRUE(name != "app" && !name.starts_with("app/")) << "nobody includes app, not " << folder;
    }
  }

  size_t files = 0, includes = 0;
  for (const char* root : {"include", "src"}) {
    for (const fs::path& file : sources(root)) {
      ++files;
      const std::string relative = file.lexically_relative(root).begin()->string();
      const std::string folder = std::string(root) == "include" ? "include" : relative;
      size_t number = 0;
      for (const std::string& line : split(test::read_text(file), '\n')) {
        ++number;
        if (line.find("#include \"") != std::string::npos) ++includes;
        const std::string complaint = check_line(table, folder, line);
        EXPECT_EQ(complaint, "") << file.string() << ":" << number;
      }
    }
  }
  EXPECT_GT(files, 20u);
  EXPECT_GT(includes, 20u);
}

}  // namespace
}  // namespace vitral
