#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace apertura {

// Reads a whole ordinary file: links are followed, folders, pipes and devices refused. Throws Error "PATH: cause" if it
// cannot be read, is larger than 4 GiB, or is not of `length` bytes where that is given.
std::vector<unsigned char> readFile(const std::string& path, std::optional<size_t> length = {});

// Throws Error "PATH: cause" unless `path` is an ordinary file that can be read and is not empty.
void requireOrdinaryFile(const std::string& path);

// A file that appears whole or not at all. It is written under a temporary name beside `path`, with the same ending;
// commit() moves it to `path`, and the destructor removes it if there was no commit. The temporary file is locked (flock)
// while it is in use: one that a killed process left is not, and the next PendingFile of the same path removes it.
// Throws Error naming `path` if the folder does not exist or cannot be written to, if the name is too long, or if
// something other than an ordinary file is there.
class PendingFile {
public:
    explicit PendingFile(std::string path);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    const std::string& name() const { return temporary_; }  // the temporary name, to write to
    void writeAll(std::string_view bytes);                  // replaces the content; throws Error naming `path`
    void commit();                                          // throws Error naming `path`

private:
    std::string path_, target_, temporary_;
    int lock_ = -1;
};

// Throws what a PendingFile of `path` would: to be asked before the work whose result goes there.
void requireWritable(const std::string& path);

// Writes `text` to `path` through a PendingFile. Throws as that does.
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace apertura
