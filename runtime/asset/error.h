#pragma once
#include <stdexcept>
#include <string>

namespace apertura {

// How runtime/ and bake/ fail: one line that names the file (or the device) and the cause. A caller's
// bug is an assert; what is thrown is always the world's fault.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace apertura
