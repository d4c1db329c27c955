// Runs the built program as a user would: environment variable VITRAL names it.
#pragma once
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace vitral::test {

// Fixed when the tests start, before anybody changes the folder; empty when VITRAL is not set.
inline std::string program() {
  const char* path = std::getenv("VITRAL");
  return path && *path ? std::filesystem::absolute(path).string() : "";
}

struct Finished {
  int code = -1;  // exit code, or 1000 + the signal that ended it
  std::string out, err;

  // Lines of standard error.
  size_t lines() const {
    size_t count = 0;
    for (const char c : err) count += c == '\n';
    return count;
  }
};

// A child with its standard output and error on descriptors of ours, in `folder`. It is stopped when
// it lasts longer than a minute.
class Process {
 public:
  // `out` and `err`, where not negative, are given to the child in place of pipes.
  Process(const std::string& file, const std::vector<std::string>& words, const std::filesystem::path& folder,
          int out = -1, int err = -1) {
    int out_pipe[2] = {-1, -1}, err_pipe[2] = {-1, -1};
    if (pipe(out_pipe) != 0 || pipe(err_pipe) != 0) return;
    std::vector<std::string> storage{file};
    storage.insert(storage.end(), words.begin(), words.end());
    std::vector<char*> arguments;
    for (std::string& word : storage) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    child_ = fork();
    if (child_ == 0) {
      alarm(60);
      if (chdir(folder.c_str()) != 0) _exit(126);
      const int input = open("/dev/null", O_RDONLY);
      dup2(input, STDIN_FILENO);
      dup2(out >= 0 ? out : out_pipe[1], STDOUT_FILENO);
      dup2(err >= 0 ? err : err_pipe[1], STDERR_FILENO);
      for (const int end : {out_pipe[0], out_pipe[1], err_pipe[0], err_pipe[1]}) close(end);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(out_pipe[1]);
    close(err_pipe[1]);
    out_ = out_pipe[0];
    err_ = err_pipe[0];
  }
  ~Process() {
    if (child_ > 0) wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void interrupt() const { kill(child_, SIGINT); }

  // Reads both streams to their ends, in turn, so that neither pipe fills up.
  Finished wait() {
    Finished result;
    pollfd streams[2] = {{out_, POLLIN, 0}, {err_, POLLIN, 0}};
    std::string* texts[2] = {&result.out, &result.err};
    for (int open_streams = 2; open_streams > 0;) {
      if (poll(streams, 2, -1) < 0) continue;
      for (int i = 0; i < 2; ++i) {
        if (streams[i].fd < 0 || streams[i].revents == 0) continue;
        char bytes[4096];
        const ssize_t count = read(streams[i].fd, bytes, sizeof bytes);
        if (count > 0) {
          texts[i]->append(bytes, static_cast<size_t>(count));
        } else {
          close(streams[i].fd);
          streams[i].fd = -1;
          --open_streams;
        }
      }
    }
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    return result;
  }

 private:
  pid_t child_ = -1;
  int out_ = -1, err_ = -1;
};

}  // namespace vitral::test
