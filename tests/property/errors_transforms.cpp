/* SPDX-License-Identifier: Apache-2.0 */
#include "errors.hpp"

#include <algorithm>
#include <cmath>

#include "measure.hpp"
#include "twin.hpp"

namespace {

using twin::ONE;
using twin::vector;
using twin::Vector2d;
using twin::Vector3d;

Vector2d exact_cos_sin(double theta_turn)
{
    return ONE * Vector2d(std::cos(twin::radians(theta_turn)), std::sin(twin::radians(theta_turn)));
}

// Every angle. Table and correction are each rounded down by less than 1, one against the other;
// what else is neglected is below 0.02, and nowhere do the ends of all three meet.
Measured sine_cosine()
{
    Largest largest;
    for (int theta = 0; theta < 65536; theta++) {
        largest.see(vector(kernel_cos_sin(static_cast<uint16_t>(theta))) - exact_cos_sin(theta));
    }
    return {"angle_sincos", largest.value, 1.0, "LSB"};
}

// As in sense_step.
Measured clarke(int64_t count)
{
    Random random(1);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const triple_t x = balanced_phases(random);
        largest.see(vector(kernel_clarke(x)) - twin::saturated(twin::clarke(vector(x))));
    }
    return {"Clarke in sense_step", largest.value, 0.53, "LSB"};
}

// The rotation by itself: sine and cosine as they are, one rounding.
Measured park(int64_t count)
{
    Random random(2);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const pair_t x = kernel_clarke(balanced_phases(random));
        const pair_t angle = kernel_cos_sin(any_angle(random));
        const Vector2d c = vector(angle) / ONE;
        const Vector2d v = vector(x);
        const Vector2d exact(v.x() * c.x() + v.y() * c.y(), v.y() * c.x() - v.x() * c.y());
        largest.see(vector(kernel_park(x, angle)) - twin::saturated(exact));
    }
    return {"transforms_park", largest.value, 1.0, "LSB"};
}

Measured inverse_park(int64_t count)
{
    Random random(3);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const pair_t x = inside_circle(random);
        const pair_t angle = kernel_cos_sin(any_angle(random));
        const Vector2d c = vector(angle) / ONE;
        const Vector2d v = vector(x);
        largest.see(vector(kernel_inverse_park(x, angle)) -
                    Vector2d(v.x() * c.x() - v.y() * c.y(), v.y() * c.x() + v.x() * c.y()));
    }
    return {"transforms_inverse_park", largest.value, 1.0, "LSB"};
}

// From phases and angle to dq against an exact rotation: sine and cosine are up to 1 LSB off, which
// a vector of length 1.15 turns into at most 1.15 sqrt 2; one for the rounding of each box.
Measured phases_to_dq(int64_t count)
{
    Random random(4);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const triple_t x = balanced_phases(random);
        const auto theta = any_angle(random);
        const pair_t dq = kernel_park(kernel_clarke(x), kernel_cos_sin(theta));
        const Vector2d ab = twin::saturated(twin::clarke(vector(x)));
        largest.see(vector(dq) - twin::saturated(twin::park(ab, twin::radians(theta))));
    }
    return {"phases to dq", largest.value, 3.7, "LSB"};
}

Measured advance(int64_t count)
{
    Random random(5);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const auto theta = any_angle(random);
        const auto by = static_cast<uint16_t>(
            random.any(-8192, 8192)); // an eighth of a turn: 1.5 periods at 1.3 times the base
        const pair_t out = kernel_advance(kernel_cos_sin(theta), kernel_cos_sin(by));
        largest.see(vector(out) - exact_cos_sin(static_cast<uint16_t>(theta + by)));
    }
    return {"transforms_advance", largest.value, 1.0 * 2.0 * std::sqrt(2.0) + 1.0, "LSB"};
}

Measured circle_excess()
{
    double largest = 0.0;
    for (int32_t x = -32768; x <= 32768; x++) {
        const double exact = std::sqrt(ONE * ONE - static_cast<double>(x) * x);
        largest = std::max(largest, kernel_circle_other_q15(x) - exact);
    }
    return {"circle_other_q15, too long", largest, 1.0, "LSB"};
}

// The chord of the square root over a segment of 1/64 lies at most h^2/8 |f''| below it: 0.8 %
// where |x| < 0.97.
Measured circle_shortfall()
{
    double largest = 0.0;
    for (int32_t x = -31784; x <= 31784; x++) {
        const double exact = std::sqrt(ONE * ONE - static_cast<double>(x) * x);
        largest = std::max(largest, 100.0 * (1.0 - kernel_circle_other_q15(x) / exact));
    }
    return {"circle_other_q15, too short", largest, 0.8, "%"};
}

Measured circle_of_any_radius(int64_t count)
{
    Random random(6);
    double largest = 0.0;
    for (int64_t n = 0; n < count; n++) {
        const int32_t radius = random.any(164, HIGHEST);
        const int32_t x = random.any(-radius, radius);
        largest = std::max(largest, std::hypot(x, kernel_circle_other(radius, x)) - radius);
    }
    return {"circle_other, too long", largest, 1.0, "LSB"};
}

Measured reciprocal()
{
    Largest largest;
    for (int n = 1; n <= 65535; n++) {
        largest.see(1e6 * (kernel_reciprocal(static_cast<uint16_t>(n)) * n - 1.0));
    }
    return {"reciprocal_scale", largest.value, 80.0, "ppm"};
}

} // namespace

std::vector<Measured> measure_transforms(int64_t count)
{
    return {sine_cosine(),       clarke(count),       park(count),
            inverse_park(count), phases_to_dq(count), advance(count),
            circle_excess(),     circle_shortfall(),  circle_of_any_radius(count),
            reciprocal()};
}
