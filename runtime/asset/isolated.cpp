#include "apertura/runtime/asset/isolated.h"

#include <OpenEXR/ImfThreading.h>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "apertura/runtime/asset/error.h"

namespace apertura {
namespace {

// Limits of a process that reads a file: about twice what OBJ, STL, PLY, PNG and TIFF of 1 kB to 225 MB took. This process
// holds a second copy of what it sends.
constexpr double kSecondsAMebibyte = 2;
constexpr double kBytes = 0x1p30, kBytesAByte = 64;

// Each piece starts with one byte that says what follows: values, or the text of an error.
constexpr char kContent = '+', kFailure = '-';
// Exit code of a child that could not write to the pipe.
constexpr int kBrokenPipe = 3;

// Thrown when the pipe ends too early or claims more than it may send.
struct Broken {};

void writeAll(int to, const void* bytes, size_t size) {
    const char* data = static_cast<const char*>(bytes);
    while (size > 0) {
        const ssize_t n = write(to, data, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) _exit(kBrokenPipe);
        data += n;
        size -= size_t(n);
    }
}

void limitResources(const ResourceLimits& limits) {
    const auto seconds = rlim_t(limits.seconds);
    const rlimit processor{seconds, seconds + 1};
    setrlimit(RLIMIT_CPU, &processor);
    const rlimit noDump{0, 0};
    setrlimit(RLIMIT_CORE, &noDump);
#ifndef __SANITIZE_ADDRESS__  // its shadow memory alone takes terabytes of address space
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const auto bytes = rlim_t(double(pages) * double(sysconf(_SC_PAGESIZE)) + limits.bytes);
    const rlimit memory{bytes, bytes};
    setrlimit(RLIMIT_AS, &memory);
#endif
}

[[noreturn]] void child(int to, const ResourceLimits& limits, const std::function<void(PipeWriter&)>& read) {
    for (int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGXCPU}) std::signal(signal, SIG_DFL);
    std::signal(SIGPIPE, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // it does not outlive its parent
    const int silence = open("/dev/null", O_WRONLY);
    dup2(silence, STDERR_FILENO);
    limitResources(limits);
    // Processor time does not pass while a library waits: what waits is ended too, long after a busy machine would be done.
    std::signal(SIGALRM, SIG_DFL);
    alarm(unsigned(std::min(60 + 20 * limits.seconds, 3600.0)));
    std::string failure;
    try {
        PipeWriter writer(to);
        read(writer);
    } catch (const std::bad_alloc&) {
        failure = "asks for more memory than a file of its size can need";
    } catch (const std::exception& e) {
        // Libraries catch bad_alloc and throw an exception with its name in the text.
        failure = e.what();
        if (failure.find("bad_alloc") != std::string::npos) failure = "asks for more memory than a file of its size can need";
    }
    if (!failure.empty()) {
        writeAll(to, &kFailure, 1);
        writeAll(to, failure.data(), failure.size());
    }
    _exit(0);
}

}  // namespace

// The mark is written with every piece and not once at the start: an error may still come after some values.
void PipeWriter::write(const void* bytes, size_t size) {
    writeAll(to_, &kContent, 1);
    writeAll(to_, bytes, size);
}

void PipeReader::read(void* bytes, size_t size) {
    char mark = 0;
    size_t done = 0;
    char* const out = static_cast<char*>(bytes);
    for (bool marked = false; !marked || done < size;) {
        const ssize_t n = marked ? ::read(from_, out + done, size - done) : ::read(from_, &mark, 1);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) throw Broken{};
        if (marked) {
            done += size_t(n);
            continue;
        }
        if (mark == kFailure) {
            std::string cause;
            char c = 0;
            while (::read(from_, &c, 1) == 1) cause += c;
            throw Error(cause);
        }
        marked = true;
    }
    left_ -= double(size);
}

size_t PipeReader::takeCount(size_t element) {
    size_t count = 0;
    read(&count, sizeof count);
    if (double(count) * double(element) > left_) throw Broken{};
    return count;
}

ResourceLimits limitsFor(const std::string& path, double seconds) {
    std::error_code ignored;
    const auto size = std::filesystem::file_size(path, ignored);
    const double bytes = ignored ? 0 : double(size), machine = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    return {seconds + kSecondsAMebibyte * bytes / 0x1p20, std::min(kBytes + kBytesAByte * bytes, machine / 2)};
}

IsolatedWork::IsolatedWork(std::string path, const ResourceLimits& limits, const std::function<void(PipeWriter&)>& work)
    : path_(std::move(path)), mostBytes_(limits.bytes) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error(path_ + ": cannot be read: no pipe");
    // A forked process has none of its parent's threads and would wait for OpenEXR's for ever: fork while there are none.
    const int threads = Imf::globalThreadCount();
    Imf::setGlobalThreadCount(0);
    child_ = fork();
    if (child_ == 0) child(ends[1], limits, work);
    Imf::setGlobalThreadCount(threads);
    close(ends[1]);
    from_ = ends[0];
    if (child_ >= 0) return;
    close(from_);
    throw Error(path_ + ": cannot be read: no process");
}

IsolatedWork::~IsolatedWork() {
    if (child_ < 0) return;
    close(from_);
    kill(child_, SIGKILL);
    while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
}

void IsolatedWork::finish(const std::function<void(PipeReader&)>& receive) {
    std::string failure;
    try {
        PipeReader reader(from_, mostBytes_);
        receive(reader);
    } catch (const Broken&) {
        failure = "cannot be read: damaged";
    } catch (const Error& e) {
        failure = e.what();
    }
    close(from_);
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGALRM))
        failure = "cannot be read: takes longer than a file of its size should";
    if (!failure.empty()) throw Error(path_ + ": " + failure);
}

void runIsolated(const std::string& path, const ResourceLimits& limits, const std::function<void(PipeWriter&)>& read,
                 const std::function<void(PipeReader&)>& receive) {
    IsolatedWork(path, limits, read).finish(receive);
}

}  // namespace apertura
