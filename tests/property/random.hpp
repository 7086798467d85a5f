/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random.hpp: inputs that are the same on every machine, one in four of them where arithmetic
 * breaks first: the ends of the range, zero, powers of two, and the neighbours of these.
 */
#pragma once

#include <cstdint>

// splitmix64 (Steele, Lea and Flood 2014).
class Random {
  public:
    explicit Random(uint64_t seed) : state_(seed) {}

    uint64_t bits()
    {
        state_ += 0x9E3779B97F4A7C15U;
        uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
        return z ^ (z >> 31);
    }

    // Evenly over lowest .. highest.
    int32_t even(int32_t lowest, int32_t highest)
    {
        const uint64_t count = static_cast<uint64_t>(static_cast<int64_t>(highest) - lowest) + 1U;
        return static_cast<int32_t>(static_cast<int64_t>(bits() % count) + lowest);
    }

    // Over lowest .. highest, with the corners often.
    int32_t any(int32_t lowest, int32_t highest)
    {
        if (bits() % 4U != 0U) {
            return even(lowest, highest);
        }
        const int64_t near = static_cast<int64_t>(bits() % 3U) - 1;
        int64_t corner = 0;
        switch (bits() % 5U) {
        case 0:
            corner = lowest;
            break;
        case 1:
            corner = highest;
            break;
        case 2:
            corner = 0;
            break;
        case 3:
            corner = int64_t{1} << (bits() % 31U);
            break;
        default:
            corner = -(int64_t{1} << (bits() % 31U));
            break;
        }
        corner += near;
        return static_cast<int32_t>(corner < lowest ? lowest
                                                    : (corner > highest ? highest : corner));
    }

    double real(double lowest, double highest)
    {
        return lowest + (highest - lowest) * static_cast<double>(bits() >> 11) / 9007199254740992.0;
    }

  private:
    uint64_t state_;
};
