#include "app/commands.h"
#include "app/interrupt.h"
#include "app/options.h"

#include <cstdio>
#include <exception>
#include <new>

namespace vitral {
namespace {

int run(const Options& options) {
  switch (options.command) {
    case Command::render:
      return run_render(options);
    case Command::bench:
      return run_bench(options);
    case Command::info:
      return run_info(options);
    case Command::diff:
      return run_diff(options);
    case Command::help:
      print(help_page(options.help_topic));
      break;
    case Command::version:
      print(std::string(kVersion) + "\n");
      break;
  }
  return kDone;
}

// One line on standard error, whatever the names of files hold.
int complain(const char* reason, ExitCode code) {
  std::string line = std::string("vitral: ") + reason;
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  std::fprintf(stderr, "%s\n", line.c_str());
  return code;
}

int run_guarded(const std::vector<std::string>& words) {
  ExitCode failure = kFailed;
  try {
    const Options options = parse_options(words);
    if (options.command == Command::diff) failure = kTrouble;
    return run(options);
  } catch (const UsageError& error) {
    return complain(error.what(), kWrongUsage);
  } catch (const Interrupted& error) {
    return complain(error.what(), kInterrupted);
  } catch (const std::bad_alloc&) {
    return complain("out of memory", failure);
  } catch (const std::exception& error) {
    return complain(error.what(), failure);
  }
}

}  // namespace
}  // namespace vitral

int main(int argc, char** argv) {
  vitral::install_signal_handlers();
  return vitral::run_guarded({argv + (argc > 0 ? 1 : 0), argv + argc});
}
