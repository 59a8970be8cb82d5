#pragma once
#include <stdexcept>
#include <string>

namespace apertura {

// How runtime/ and bake/ fail: one line that names the file (or the device) and the cause. It reports bad input and
// failures of the machine; a caller's bug is an assert.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace apertura
