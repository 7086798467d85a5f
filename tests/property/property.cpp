/* SPDX-License-Identifier: Apache-2.0 */
#include "property.hpp"

#include <cstdio>

namespace property {

namespace {

constexpr int PRINTED = 5; // counterexamples a test; the others are counted

int found = 0;
char first[1000];

} // namespace

Shown *Shown::innermost_ = nullptr;

std::string Shown::all()
{
    std::string out;
    for (const Shown *shown = innermost_; shown != nullptr; shown = shown->outer_) {
        out = "; " + std::string(shown->name_) + " = " + shown->text_(shown->value_) + out;
    }
    return out;
}

std::string number(double value)
{
    char out[40];
    std::snprintf(out, sizeof out, "%.10g", value);
    return out;
}

void record(const char *file, int line, const char *condition, const std::string &sides)
{
    found++;
    if (found > PRINTED) {
        return;
    }
    const std::string message = std::string(file) + ":" + std::to_string(line) + ": " + condition +
                                ", with " + sides + Shown::all();
    std::printf("counterexample: %s\n", message.c_str());
    if (found == 1) {
        std::snprintf(first, sizeof first, "%s", message.c_str());
    }
}

} // namespace property

void setUp()
{
    property::found = 0;
}

// The outermost level of a test: its function has returned, so no object is left to destroy.
void tearDown()
{
    static char message[sizeof property::first + 60];
    if (property::found > 0) {
        std::snprintf(message, sizeof message, "%d counterexample(s), the first: %s",
                      property::found, property::first);
        TEST_FAIL_MESSAGE(message);
    }
}
