#pragma once
// What the programs of tools/fit share, included before all else. fit.py compiles each with copies of the texts in which the constants that
// it names are `fitted`.
#include <algorithm>

inline double fitted[32];

// The program's own: the error with the constants of `fitted`. It is called many times.
double error();

extern "C" inline __attribute__((used)) double errorOf(const double* constants, int count) {
    std::copy_n(constants, count, fitted);
    return error();
}

#include "apertura/sh/models.h"
#include "tests/support.h"
