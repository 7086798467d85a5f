/* SPDX-License-Identifier: Apache-2.0 */
/*
 * errors.hpp: the largest error of every kernel of the fast loop against its double-precision
 * twin.
 */
#pragma once

#include <cstdint>
#include <string>
#include <vector>

struct Measured {
    std::string kernel;
    double error; // the largest found
    double bound; // what the design allows, derived where it is measured
    std::string unit;
};

// count: random inputs for each kernel whose inputs are too many to try all.
std::vector<Measured> measure_transforms(int64_t count);
std::vector<Measured> measure_loop(int64_t count);
