// ModbusPeer: a Modbus/TCP server in a process of its own, told by lines what to do.
// Owned by the test that starts it; ends with it.
// One thread.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace stationd {

class ModbusPeer {
 public:
  /// Starts `arguments[0]`; its first line of output is the port that it serves.
  explicit ModbusPeer(const std::vector<std::string>& arguments) {
    int to[2], from[2];
    if (pipe(to) != 0 || pipe(from) != 0) throw std::runtime_error("pipe");
    child_ = fork();
    if (child_ == 0) run(arguments, to, from);
    ::close(to[0]);
    ::close(from[1]);
    in_ = fdopen(to[1], "w");
    out_ = fdopen(from[0], "r");
    const std::string first = line();
    port_ = first.empty() ? 0 : std::stoi(first);
  }
  ~ModbusPeer() {
    fclose(in_);
    fclose(out_);
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
  ModbusPeer(const ModbusPeer&) = delete;
  ModbusPeer& operator=(const ModbusPeer&) = delete;

  int port() const noexcept { return port_; }
  /// Sends a line, returns the answer.
  std::string ask(const std::string& command) {
    fprintf(in_, "%s\n", command.c_str());
    fflush(in_);
    return line();
  }

 private:
  [[noreturn]] static void run(const std::vector<std::string>& arguments, const int* to, const int* from) {
    dup2(to[0], STDIN_FILENO);
    dup2(from[1], STDOUT_FILENO);
    for (int fd = 3; fd < 1024; ++fd) ::close(fd);
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(127);
  }

  std::string line() {
    std::string out;
    for (int c = fgetc(out_); c != EOF && c != '\n'; c = fgetc(out_)) out += static_cast<char>(c);
    return out;
  }

  pid_t child_ = -1;
  FILE* in_ = nullptr;
  FILE* out_ = nullptr;
  int port_ = 0;
};

}  // namespace stationd
