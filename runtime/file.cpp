#include "runtime/file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "runtime/error.h"

namespace apertura {
namespace fs = std::filesystem;

PendingFile::PendingFile(std::string path) : path_(std::move(path)) {
    std::error_code ignored;
    if (fs::is_directory(path_, ignored)) throw Error(path_ + ": is a folder");
    if (fs::exists(path_, ignored) && !fs::is_regular_file(path_, ignored)) throw Error(path_ + ": is not an ordinary file");
    if (fs::is_symlink(path_, ignored) && fs::exists(path_, ignored)) target_ = fs::canonical(path_, ignored).string();
    if (target_.empty()) target_ = path_;
    const fs::path final(target_);
    fs::path name(".");
    name += final.stem();
    name += "." + std::to_string(getpid());
    name += final.extension();
    temporary_ = (final.parent_path() / name).string();
    errno = 0;
    if (!std::ofstream(temporary_, std::ios::binary)) {
        const std::string cause = std::strerror(errno);
        throw Error(path_ + ": cannot be written: " + cause);
    }
}

PendingFile::~PendingFile() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void PendingFile::commit() {
    std::error_code error;
    fs::rename(temporary_, target_, error);
    if (error) throw Error(path_ + ": cannot be written: " + error.message());
    temporary_.clear();
}

void writeTextFile(const std::string& path, const std::string& text) {
    PendingFile file(path);
    std::ofstream out(file.name(), std::ios::binary);
    out << text;
    out.close();
    if (!out) throw Error(path + ": cannot be written: " + std::strerror(errno));
    file.commit();
}

}  // namespace apertura
