#pragma once
// Runs the program as a user does.
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "tests/support.h"

namespace apertura::test {

struct Result {
    int code = 0;
    std::string out, error;
};

inline std::string slurp(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// `before`: words before the program, as of a program that runs it.
inline Result run(const std::string& arguments, const std::string& before = "") {
    const Folder folder;
    const std::string command = before + " " APERTURA_PROGRAM " " + arguments + " >" + (folder / "out") + " 2>" + (folder / "err");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), slurp(folder / "out"), slurp(folder / "err")};
}

inline long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

// What it says on standard error, without the lines that tell how far a long work is.
inline std::string withoutProgress(const std::string& error) {
    std::istringstream in(error);
    std::string out;
    for (std::string line; std::getline(in, line);)
        if (line.find(" % after ") == std::string::npos) out += line + "\n";
    return out;
}

// Expects the exit code `code`, one line on standard error that contains `name`, and nothing on standard output.
inline void expectRefusal(const std::string& arguments, int code, const std::string& name) {
    const Result r = run(arguments);
    EXPECT_EQ(r.code, code) << arguments << "\n" << r.error;
    EXPECT_EQ(lines(withoutProgress(r.error)), 1) << arguments << "\n" << r.error;
    EXPECT_NE(r.error.find(name), std::string::npos) << arguments << "\n" << r.error;
    EXPECT_TRUE(r.out.empty()) << r.out;
}

}  // namespace apertura::test
