// The rows of the command line's table (options.h).
#pragma once
#include "app/options.h"

#include <span>
#include <string_view>

namespace vitral {

constexpr unsigned bit(Command command) {
  return 1u << static_cast<unsigned>(command);
}

struct OptionRow {
  std::string_view group;       // heading of the help page
  std::string_view name;        // with its dashes
  std::string_view short_name;  // empty: none
  std::string_view value;       // how the value is written; empty: it takes none
  unsigned commands;            // sum of bit(command)
  std::string_view help;        // one line, or several
  void (*set)(Options&, const OptionRow&, const std::string& value);  // throws UsageError
};

// In the order of the help page; rows of a group stand together.
std::span<const OptionRow> option_table();

}  // namespace vitral
