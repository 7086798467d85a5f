/* SPDX-License-Identifier: Apache-2.0 */
// property.hpp by itself: fails on purpose, and CTest expects exactly this output. A CHECK that
// does not hold goes on, runs every destructor, shows the values in scope and fails its test, and
// only its own.
#include <cstdio>
#include <memory>
#include <vector>

#include "property.hpp"

namespace {

struct Announces {
    ~Announces() { std::puts("destroyed"); }
};

} // namespace

static void test_counterexample_fails_its_test_after_the_destructors()
{
    const Announces object;
    const std::vector<double> currents_A = {1.0, 2.5};
    for (const double current_A : currents_A) {
        SHOW(current_A);
        CHECK(2.0 * current_A < 3.0);
    }
    std::puts("went on");
}

static void test_without_a_counterexample_passes()
{
    const double current_A = 1.0;
    SHOW(current_A);
    CHECK(current_A == 1.0);
    CHECK(current_A <= 1.0);
    CHECK(current_A >= 1.0);
    CHECK(current_A < 2.0);
    CHECK(current_A > 0.0);
    CHECK(true);
}

static void test_each_comparison_can_fail()
{
    CHECK(1 == 2);
    CHECK(2 <= 1);
    CHECK(1 >= 2);
    CHECK(1 < 1);
    CHECK(1 > 1);
    CHECK(false);
    CHECK(std::nan("") <= 1.0);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_counterexample_fails_its_test_after_the_destructors);
    RUN_TEST(test_without_a_counterexample_passes);
    RUN_TEST(test_each_comparison_can_fail);
    return UNITY_END();
}
