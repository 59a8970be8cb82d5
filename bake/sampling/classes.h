#pragma once
// Joins elements 0 .. n-1 into classes.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace apertura {

class Classes {
public:
    explicit Classes(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
    // The least element of i's class.
    uint32_t find(uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(uint32_t a, uint32_t b) {
        a = find(a), b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<uint32_t> parent_;
};

}  // namespace apertura
