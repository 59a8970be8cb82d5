#pragma once
#include <string>

namespace apertura {

// A file that exists whole or not at all: written under another name beside `path` (same ending), put in
// place by commit(), removed when it goes out of scope without one. Throws Error naming `path` where the
// folder does not exist or cannot be written to, or where something that is no ordinary file stands there.
class PendingFile {
public:
    explicit PendingFile(std::string path);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    const std::string& name() const { return temporary_; }  // where to write
    void commit();

private:
    std::string path_, target_, temporary_;
};

// `text` as the whole of `path`, through a PendingFile.
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace apertura
