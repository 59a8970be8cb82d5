#include "bake/isolated.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "runtime/error.h"

namespace apertura {
namespace {

void writeAll(int to, const char* data, size_t size) {
    while (size > 0) {
        const ssize_t n = write(to, data, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) _exit(3);
        data += n;
        size -= size_t(n);
    }
}

void limitResources(int seconds) {
    rlimit processor{rlim_t(seconds), rlim_t(seconds) + 1};
    setrlimit(RLIMIT_CPU, &processor);
    rlimit noDump{0, 0};
    setrlimit(RLIMIT_CORE, &noDump);
#ifndef __SANITIZE_ADDRESS__  // whose shadow alone is terabytes of address space
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t bytes = rlim_t(pages) * rlim_t(sysconf(_SC_PAGESIZE)) + (rlim_t(4) << 30);
    rlimit memory{bytes, bytes};
    setrlimit(RLIMIT_AS, &memory);
#endif
}

// The first byte says whether a message of failure or the parcel follows.
[[noreturn]] void child(int to, int seconds, const std::function<void(Parcel&)>& read) {
    for (int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGXCPU}) std::signal(signal, SIG_DFL);
    const int silence = open("/dev/null", O_WRONLY);
    dup2(silence, STDERR_FILENO);
    limitResources(seconds);
    std::string out;
    try {
        Parcel parcel;
        read(parcel);
        out = "+" + parcel.bytes;
    } catch (const std::bad_alloc&) {
        out = "-asks for more memory than it can need";
    } catch (const std::exception& e) {
        out = std::string("-") + e.what();
    }
    writeAll(to, out.data(), out.size());
    _exit(0);
}

}  // namespace

Parcel runIsolated(const std::string& path, int seconds, const std::function<void(Parcel&)>& read) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error(path + ": cannot be read: no pipe");
    const pid_t pid = fork();
    if (pid < 0) throw Error(path + ": cannot be read: no process");
    if (pid == 0) child(ends[1], seconds, read);
    close(ends[1]);

    std::string in;
    std::vector<char> buffer(1 << 20);
    for (;;) {
        const ssize_t n = ::read(ends[0], buffer.data(), buffer.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        in.append(buffer.data(), size_t(n));
    }
    close(ends[0]);
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
        throw Error(path + ": cannot be read: damaged, its reader does not come to an end");
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || in.empty())
        throw Error(path + ": cannot be read: damaged");
    if (in[0] == '-') throw Error(path + ": " + in.substr(1));
    Parcel parcel;
    parcel.bytes = in.substr(1);
    return parcel;
}

int secondsFor(const std::string& path, int base) {
    std::error_code ignored;
    const auto size = std::filesystem::file_size(path, ignored);
    return base + (ignored ? 0 : int(2 * size >> 20));
}

}  // namespace apertura
