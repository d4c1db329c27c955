#include "app/options.h"

#include "app/option_table.h"

#include <algorithm>
#include <utility>

namespace vitral {
namespace {

constexpr std::pair<std::string_view, Command> kCommands[] = {{"render", Command::render},
                                                              {"bench", Command::bench},
                                                              {"diff", Command::diff},
                                                              {"info", Command::info},
                                                              {"help", Command::help}};

std::optional<Command> find_command(std::string_view word) {
  for (const auto& [name, command] : kCommands) {
    if (word == name) return command;
  }
  return {};
}

const char* name_of(Command command) {
  for (const auto& [name, value] : kCommands) {
    if (value == command) return name.data();
  }
  return "version";
}

std::string suggestion(std::string_view word, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(word, names);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

const OptionRow& find_option(const std::string& name) {
  std::vector<std::string> names;
  for (const OptionRow& row : option_table()) {
    if (name == row.name || (!row.short_name.empty() && name == row.short_name)) return row;
    names.emplace_back(row.name);
  }
  throw UsageError("unknown option " + name + suggestion(name, names));
}

bool is_option_name(const std::string& word) {
  const std::span<const OptionRow> table = option_table();
  return std::any_of(table.begin(), table.end(), [&](const OptionRow& row) {
    return word == row.name || (!row.short_name.empty() && word == row.short_name);
  });
}

// An option with its value, before it is known which command it belongs to.
struct Given {
  const OptionRow* row;
  std::string value;
};

// `--name value`, `--name=value`, `-o value`. Moves `i` past a value that is a word of its own.
Given read_option(const std::vector<std::string>& words, size_t& i) {
  const std::string& word = words[i];
  const size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
  const OptionRow& row = find_option(word.substr(0, equals));
  const bool takes_value = !row.value.empty();
  if (equals != std::string::npos) {
    if (!takes_value) throw UsageError(std::string(row.name) + " takes no value");
    return {&row, word.substr(equals + 1)};
  }
  if (!takes_value) return {&row, {}};
  if (i + 1 == words.size() || is_option_name(words[i + 1])) {
    throw UsageError(std::string(row.name) + " needs a value: " + std::string(row.value));
  }
  return {&row, words[++i]};
}

void check_inputs(const Options& options) {
  const size_t needed = options.command == Command::diff ? 2 : 1;
  const std::vector<std::string>& inputs = options.inputs;
  if (inputs.size() < needed) {
    throw UsageError(needed == 2 ? "diff compares two pictures: vitral diff A B"
                                 : "there is no input: vitral INPUT, a project .xml or a mesh .obj or .ply");
  }
  if (inputs.size() > needed) {
    std::vector<std::string> commands;
    for (const auto& [name, command] : kCommands) commands.emplace_back(name);
    const std::string meant = suggestion(inputs[0], commands);
    if (!meant.empty()) throw UsageError("unknown command '" + inputs[0] + "'" + meant);
    throw UsageError("one input too many: '" + inputs[needed] + "'");
  }
  for (const std::string& input : inputs) {
    if (input.empty()) throw UsageError("the name of the input is empty");
  }
}

}  // namespace

// The first plain word is the command if it is the name of one; the other plain words are inputs.
// `--` ends the options, and a word after it is never a command.
Options parse_options(const std::vector<std::string>& words) {
  Options options;
  std::vector<Given> given;
  bool seen_command = false;
  bool wants_help = false, wants_version = false;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--") {
      options.inputs.insert(options.inputs.end(), words.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                            words.end());
      break;
    }
    if (words[i].size() > 1 && words[i][0] == '-') {
      given.push_back(read_option(words, i));
      wants_help = wants_help || given.back().row->name == "--help";
      wants_version = wants_version || given.back().row->name == "--version";
      continue;
    }
    const std::optional<Command> command = find_command(words[i]);
    if (command && !seen_command && options.inputs.empty()) {
      options.command = *command;
      seen_command = true;
    } else {
      options.inputs.push_back(words[i]);
    }
  }

  if (wants_version) {
    options.command = Command::version;
    return options;
  }
  if (wants_help || options.command == Command::help) {
    options.help_topic = seen_command ? options.command : Command::help;
    if (options.command == Command::help && !options.inputs.empty()) {
      const std::optional<Command> topic = find_command(options.inputs[0]);
      if (!topic) throw UsageError("there is no command '" + options.inputs[0] + "'");
      options.help_topic = *topic;
    }
    options.command = Command::help;
    return options;
  }

  for (const Given& option : given) {
    if (!(option.row->commands & bit(options.command))) {
      throw UsageError(std::string(option.row->name) + " is not an option of " + name_of(options.command));
    }
    option.row->set(options, *option.row, option.value);
  }
  check_inputs(options);
  return options;
}

std::string nearest_name(std::string_view word, const std::vector<std::string>& names) {
  // Levenshtein's distance, one row of the table at a time; long words are nobody's slip.
  constexpr size_t kLongestWord = 64;
  if (word.size() > kLongestWord) return "";
  std::string nearest;
  size_t least = word.size() / 3 + 1;  // a name further than this is another name
  for (const std::string& name : names) {
    std::vector<size_t> row(name.size() + 1);
    for (size_t j = 0; j <= name.size(); ++j) row[j] = j;
    for (size_t i = 1; i <= word.size(); ++i) {
      size_t diagonal = std::exchange(row[0], i);
      for (size_t j = 1; j <= name.size(); ++j) {
        const size_t substituted = diagonal + (word[i - 1] == name[j - 1] ? 0 : 1);
        diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, substituted}));
      }
    }
    if (row[name.size()] <= least) {
      if (row[name.size()] < least || nearest.empty()) nearest = name;
      least = row[name.size()];
    }
  }
  return nearest;
}

}  // namespace vitral
