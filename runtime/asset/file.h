#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace apertura {

// The whole of an ordinary file (links followed; no folder, pipe or device), or Error "PATH: cause" where it cannot be
// read. One of another size than `length`, where that is given, or of more than 4 GiB is not read.
std::vector<unsigned char> readFile(const std::string& path, std::optional<size_t> length = {});

// Throws Error "PATH: cause" unless an ordinary file that is not empty can be read there.
void requireOrdinaryFile(const std::string& path);

// A file that exists whole or not at all: written under another name beside `path` (same ending), put in
// place by commit(), removed when it goes out of scope without one. While it exists the other name is locked
// (flock); what a process that was killed left behind is not, and goes when the next file of that name is begun.
// Throws Error naming `path` where the folder does not exist or cannot be written to, where its name is too long, or
// where something that is no ordinary file stands there.
class PendingFile {
public:
    explicit PendingFile(std::string path);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    const std::string& name() const { return temporary_; }  // where to write
    void writeAll(std::string_view bytes);                  // all that it holds
    void commit();

private:
    std::string path_, target_, temporary_;
    int lock_ = -1;
};

// `text` as the whole of `path`, through a PendingFile.
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace apertura
