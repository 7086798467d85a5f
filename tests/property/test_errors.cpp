/* SPDX-License-Identifier: Apache-2.0 */
// Every kernel of the fast loop against its double-precision twin; the numbers in
// firmware/foc/README.md are these.
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "errors.hpp"
#include "property.hpp"

namespace {

#ifdef HUBFOC_SLOW_BUILD
constexpr int64_t COUNT = 100000;
constexpr bool EXACT = false; // fewer inputs: errors can only be smaller than those in the table
#else
constexpr int64_t COUNT = 4000000;
constexpr bool EXACT = true;
#endif

// Rows of the table: | `kernel` | inputs | largest error | unit |
std::map<std::string, std::pair<double, std::string>> stated_errors()
{
    std::ifstream file(HUBFOC_FOC_README);
    const std::string readme = HUBFOC_FOC_README;
    SHOW(readme);
    CHECK(file.good());
    std::map<std::string, std::pair<double, std::string>> rows;
    std::string line;
    bool in_table = false;
    while (std::getline(file, line)) {
        if (line.rfind("| kernel |", 0) == 0) {
            in_table = true;
        } else if (in_table && line.rfind("|--", 0) != 0) {
            std::stringstream cells(line);
            std::string empty, kernel, inputs, error, unit;
            if (!std::getline(cells, empty, '|') || !std::getline(cells, kernel, '|') ||
                !std::getline(cells, inputs, '|') || !std::getline(cells, error, '|') ||
                !std::getline(cells, unit, '|')) {
                break;
            }
            const auto trimmed = [](const std::string &s) {
                const auto first = s.find_first_not_of(" `");
                return first == std::string::npos
                           ? std::string()
                           : s.substr(first, s.find_last_not_of(" `") - first + 1);
            };
            rows[trimmed(kernel)] = {std::stod(error), trimmed(unit)};
        }
    }
    return rows;
}

std::vector<Measured> all_measured()
{
    std::vector<Measured> all = measure_transforms(COUNT);
    const std::vector<Measured> loop = measure_loop(COUNT);
    all.insert(all.end(), loop.begin(), loop.end());
    return all;
}

} // namespace

static void test_every_kernel_stays_within_its_bound_and_the_readme_states_the_largest_error()
{
    const auto stated = stated_errors();
    const auto measured = all_measured();
    CHECK(stated.size() == measured.size());
    for (const Measured &m : measured) {
        SHOW(m.kernel);
        SHOW(m.error);
        CHECK(m.error <= m.bound);
        const auto row = stated.find(m.kernel);
        const bool has_a_row = row != stated.end();
        if (!CHECK(has_a_row)) {
            continue;
        }
        CHECK(row->second.second == m.unit);
        // Stated with two decimals, rounded up.
        CHECK(m.error <= row->second.first + 1e-9);
        if (EXACT) {
            CHECK(row->second.first - m.error < 0.0101);
        }
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_every_kernel_stays_within_its_bound_and_the_readme_states_the_largest_error);
    return UNITY_END();
}
