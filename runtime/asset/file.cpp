#include "apertura/runtime/asset/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <utility>

#include "apertura/runtime/asset/error.h"

namespace apertura {
namespace fs = std::filesystem;
namespace {

constexpr size_t kLargestFile = UINT32_MAX;  // bytes, the most that a .glb can hold
constexpr size_t kLongestName = 255;         // bytes, on the file systems in use
constexpr size_t kTagDigits = 8;
constexpr char kMark[] = ".apertura-";  // before the digits

// A file descriptor that closes itself.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }
    int release() { return std::exchange(fd_, -1); }

private:
    int fd_;
};

// Opens an ordinary file and refuses others; O_NONBLOCK avoids waiting for the other end of a pipe.
int openOrdinary(const std::string& path, struct stat& about) {
    Descriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
    if (file.get() < 0) throw Error(path + ": cannot be opened: " + std::strerror(errno));
    if (fstat(file.get(), &about) != 0) throw Error(path + ": cannot be read: " + std::strerror(errno));
    if (S_ISDIR(about.st_mode)) throw Error(path + ": is a folder");
    if (!S_ISREG(about.st_mode)) throw Error(path + ": is not an ordinary file");
    return file.release();
}

std::string randomTag() {
    std::random_device device;
    std::string out;
    for (size_t i = 0; i < kTagDigits; ++i) out += "0123456789abcdef"[device() & 15];
    return out;
}

// The beginning of temporary names of `final`; a long name is cut so that they fit.
std::string temporaryPrefix(const fs::path& final) {
    const size_t rest = 1 + std::strlen(kMark) + kTagDigits + final.extension().native().size();
    std::string stem = final.stem().string();
    if (stem.size() + rest > kLongestName) stem.resize(kLongestName - std::min(rest, kLongestName));
    return "." + stem + kMark;
}

enum class Lock { Ours, Theirs, Impossible };

// Locks a file. A file that was removed meanwhile counts as somebody else's.
Lock lockAlone(int fd) {
    struct stat about {};
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) return errno == EWOULDBLOCK ? Lock::Theirs : Lock::Impossible;
    return fstat(fd, &about) == 0 && about.st_nlink > 0 ? Lock::Ours : Lock::Theirs;
}

void removeLeftovers(const fs::path& final) {
    const std::string prefix = temporaryPrefix(final), ending = final.extension().string();
    std::error_code ignored;
    const fs::path folder = final.parent_path().empty() ? fs::path(".") : final.parent_path();
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.size() != prefix.size() + kTagDigits + ending.size() || !name.starts_with(prefix) || !name.ends_with(ending)) continue;
        if (name.find_first_not_of("0123456789abcdef", prefix.size()) < prefix.size() + kTagDigits) continue;
        Descriptor file(open(entry.path().c_str(), O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC));
        if (file.get() >= 0 && lockAlone(file.get()) == Lock::Ours) fs::remove(entry.path(), ignored);
    }
}

}  // namespace

std::vector<unsigned char> readFile(const std::string& path, std::optional<size_t> length) {
    struct stat about {};
    Descriptor file(openOrdinary(path, about));
    const size_t size = size_t(about.st_size);
    if (length && size != *length)
        throw Error(path + ": " + std::to_string(size) + " bytes where " + std::to_string(*length) + " are said to be");
    if (size > kLargestFile) throw Error(path + ": larger than 4 GiB");
    std::vector<unsigned char> out(size);
    for (size_t done = 0; done < size;) {
        const ssize_t n = read(file.get(), out.data() + done, size - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw Error(path + ": cannot be read: " + std::strerror(errno));
        if (n == 0) throw Error(path + ": cannot be read: became shorter meanwhile");
        done += size_t(n);
    }
    return out;
}

void requireOrdinaryFile(const std::string& path) {
    struct stat about {};
    Descriptor file(openOrdinary(path, about));
    if (about.st_size == 0) throw Error(path + ": the file is empty");
}

PendingFile::PendingFile(std::string path) : path_(std::move(path)) {
    std::error_code ignored;
    if (fs::is_directory(path_, ignored)) throw Error(path_ + ": is a folder");
    if (fs::exists(path_, ignored) && !fs::is_regular_file(path_, ignored)) throw Error(path_ + ": is not an ordinary file");
    if (fs::is_symlink(path_, ignored)) target_ = fs::weakly_canonical(path_, ignored).string();
    if (target_.empty()) target_ = path_;
    const fs::path final(target_);
    auto refuse = [&](int cause) { return Error(path_ + ": cannot be written: " + std::strerror(cause)); };
    if (final.filename().native().size() > kLongestName) throw refuse(ENAMETOOLONG);
    removeLeftovers(final);
    while (lock_ < 0) {
        temporary_ = (final.parent_path() / (temporaryPrefix(final) + randomTag() + final.extension().string())).string();
        Descriptor file(open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
        if (file.get() < 0 && errno != EEXIST) throw refuse(errno);
        // Another run may take the file for a leftover and remove it before it is locked: then try again. On file systems
        // without locks leftovers are never removed.
        if (file.get() >= 0 && lockAlone(file.get()) != Lock::Theirs) lock_ = file.release();
        // A replaced file keeps its permissions.
        struct stat before {};
        if (lock_ >= 0 && stat(target_.c_str(), &before) == 0) fchmod(lock_, before.st_mode & 07777);
    }
}

PendingFile::~PendingFile() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
    if (lock_ >= 0) close(lock_);
}

void PendingFile::commit() {
    std::error_code error;
    fs::rename(temporary_, target_, error);
    if (error) throw Error(path_ + ": cannot be written: " + error.message());
    temporary_.clear();
}

void PendingFile::writeAll(std::string_view bytes) {
    std::ofstream out(temporary_, std::ios::binary);
    out << bytes;
    out.close();
    if (!out) throw Error(path_ + ": cannot be written: " + std::strerror(errno));
}

void requireWritable(const std::string& path) { const PendingFile file(path); }

void writeTextFile(const std::string& path, const std::string& text) {
    PendingFile file(path);
    file.writeAll(text);
    file.commit();
}

}  // namespace apertura
