/* SPDX-License-Identifier: Apache-2.0 */
// Every kernel of the fast loop against its double-precision twin. Prints the largest errors, which
// are those of the table in firmware/foc/DERIVATIONS.md, Errors.
#include <cstdio>

#include "errors.hpp"
#include "property.hpp"

namespace {

#ifdef HUBFOC_SLOW_BUILD
constexpr int64_t COUNT = 100000;
#else
constexpr int64_t COUNT = 4000000;
#endif

std::vector<Measured> all_measured()
{
    std::vector<Measured> all = measure_transforms(COUNT);
    const std::vector<Measured> loop = measure_loop(COUNT);
    all.insert(all.end(), loop.begin(), loop.end());
    return all;
}

} // namespace

static void test_every_kernel_stays_within_its_bound()
{
    for (const Measured &m : all_measured()) {
        std::printf("%s: %.3f of at most %.2f %s\n", m.kernel.c_str(), m.error, m.bound,
                    m.unit.c_str());
        SHOW(m.kernel);
        SHOW(m.error);
        CHECK(m.error <= m.bound);
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_every_kernel_stays_within_its_bound);
    return UNITY_END();
}
