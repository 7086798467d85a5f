/* SPDX-License-Identifier: Apache-2.0 */
// What regen_table says about the best braking torque and the currents of any torque, against the
// circuit laws solved a second time (circuit.hpp), for two hundred random drives.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "limits.hpp"
#include "property.hpp"

namespace {

using circuit::Circuit;
using circuit::Form;
using circuit::PI;
using circuit::Vector2d;
using limits::braking_limits;
using limits::joined;
using limits::torque_limit_Nm;
using values::Drive;

// A thousandth is promised. What is a formula holds to rounding; a search places an optimum worse
// than its power, which is flat there.
constexpr double EXACT = 1e-7;
constexpr double SEARCHED = 1e-3;
constexpr double SEARCHED_POWER = 1e-6;

#ifdef HUBFOC_SLOW_BUILD
constexpr int EVERY = 8;
#else
constexpr int EVERY = 1;
#endif
constexpr int STARTS = 64;

// Within a share of what is expected, or, where that is close to zero, of the drive's own size.
void check_close(const char *quantity, double found, double expected, double share, double size)
{
    SHOW(quantity);
    SHOW(found);
    SHOW(expected);
    CHECK(std::abs(found - expected) <= share * std::abs(expected) + 1e-3 * share * size);
}

Form no_d_current(const Drive &drive)
{
    Form out;
    out.linear << 1.0 / drive.max_current_A, 0.0;
    return out;
}

// What bounds an operating point: phase current, and phase voltage u_oc / sqrt(3).
std::vector<Form> electrical_limits(const Drive &drive, const Circuit &at)
{
    const double voltage_square = drive.open_circuit_V * drive.open_circuit_V / 3.0;
    const double current_square = drive.max_current_A * drive.max_current_A;
    return {1.0 / current_square * at.current_square_A2 + -1.0,
            1.0 / voltage_square * at.voltage_square_V2 + -1.0};
}

template <typename Record> Circuit circuit_of(const Record &record)
{
    return {values::DRIVES[values::SHIPPED + record.drive], record.speed_rpm * PI / 30.0,
            record.winding_temperature_c};
}

template <typename Record> const Drive &drive_of(const Record &record)
{
    return values::DRIVES[values::SHIPPED + record.drive];
}

struct Breakdown {
    double d_A, q_A, dc_W, battery_W, copper_W, iron_W, inverter_W, loss_battery_W;
};

void check_breakdown(const Drive &drive, const Circuit &at, const Vector2d &i,
                     const Breakdown &result, double share, double power_share)
{
    const double power = at.dc_power_W(i);
    const circuit::Pack pack = circuit::pack(drive, drive.driven_wheels * power);
    const double all_W = drive.max_power_W;
    // Where the current limit is the strongest torque, the torque does not tell i_d from a little
    // more or less of it.
    check_close("current_error_A", (Vector2d(result.d_A, result.q_A) - i).norm(), 0.0, 1.0,
                1e3 * share * i.norm() + EXACT * drive.max_current_A);
    check_close("dc_W", result.dc_W, power, power_share, all_W);
    check_close("battery_W", result.battery_W, pack.chemical_W, power_share, all_W);
    check_close("loss_battery_W", result.loss_battery_W, pack.loss_W, share, all_W);
    check_close("copper_W", result.copper_W, at.copper_W(i), share, all_W);
    check_close("iron_W", result.iron_W, at.iron_W(i), share, all_W);
    check_close("inverter_W", result.inverter_W, at.inverter_W(i), share, all_W);
}

Breakdown breakdown(const values::Solved &s)
{
    return {s.current_d_a,   s.current_q_a, s.dc_power_w,      s.battery_power_w,
            s.loss_copper_w, s.loss_iron_w, s.loss_inverter_w, s.loss_battery_w};
}

Breakdown limited(const values::Solved &s)
{
    return {s.current_d_a_limited,     s.current_q_a_limited,   s.dc_power_w_limited,
            s.battery_power_w_limited, s.loss_copper_w_limited, s.loss_iron_w_limited,
            s.loss_inverter_w_limited, s.loss_battery_w_limited};
}

Breakdown breakdown(const values::Evaluated &e)
{
    return {e.current_d_a,   e.current_q_a, e.dc_power_w,      e.battery_power_w,
            e.loss_copper_w, e.loss_iron_w, e.loss_inverter_w, e.loss_battery_w};
}

void check_closed_form(const values::Solved &result)
{
    const Drive &drive = drive_of(result);
    const Circuit at = circuit_of(result);
    const std::string name = drive.name;
    SHOW(name);
    const auto best = at.best_without_d_current();
    const Vector2d i = best.value_or(Vector2d(0.0, 0.0));
    CHECK(result.regeneration_possible == best.has_value());
    check_close("torque_optimal_nm", result.torque_optimal_nm, at.torque_Nm(i), EXACT,
                drive.max_torque_Nm);
    check_close("torque_idle_nm", result.torque_idle_nm, at.torque_Nm(Vector2d::Zero()), EXACT,
                drive.max_torque_Nm);
    check_breakdown(drive, at, i, breakdown(result), EXACT, EXACT);
    if (best) {
        const auto zero = circuit::minimum(
            at.direction() * at.torque_Nm, {},
            {no_d_current(drive), 1.0 / drive.max_power_W * at.dc_power_W}, 3.0 * i.norm(), STARTS);
        if (CHECK(zero.has_value())) {
            check_close("torque_zero_nm", result.torque_zero_nm, at.torque_Nm(zero->at), EXACT,
                        drive.max_torque_Nm);
        }
    }
    const double strongest = torque_limit_Nm(drive, result.speed_rpm * PI / 30.0);
    const double clamped = std::clamp(at.torque_Nm(i), -strongest, strongest);
    const auto clamped_i = at.of_torque_without_d_current(clamped);
    if (!CHECK(clamped_i.has_value())) {
        return;
    }
    check_close("torque_optimal_limited_nm", result.torque_optimal_limited_nm, clamped, EXACT,
                drive.max_torque_Nm);
    check_breakdown(drive, at, *clamped_i, limited(result), EXACT, EXACT);
}

void check_joint(const values::Solved &result)
{
    const Drive &drive = drive_of(result);
    const Circuit at = circuit_of(result);
    const std::string name = drive.name;
    SHOW(name);
    const std::vector<Form> electrical = electrical_limits(drive, at);
    const double speed = result.speed_rpm * PI / 30.0;
    const auto best = circuit::minimum(
        at.dc_power_W, joined(electrical, braking_limits(drive, at, 1e3 * drive.max_torque_Nm)), {},
        drive.max_current_A, STARTS);
    if (!CHECK(best.has_value())) {
        return;
    }
    CHECK(result.regeneration_possible == (best->value < 0.0));
    check_close("torque_optimal_nm", result.torque_optimal_nm, at.torque_Nm(best->at), SEARCHED,
                drive.max_torque_Nm);
    check_breakdown(drive, at, best->at, breakdown(result), SEARCHED, SEARCHED_POWER);
    const auto clamped = circuit::minimum(
        at.dc_power_W, joined(electrical, braking_limits(drive, at, torque_limit_Nm(drive, speed))),
        {}, drive.max_current_A, STARTS);
    if (!CHECK(clamped.has_value())) {
        return;
    }
    check_close("torque_optimal_limited_nm", result.torque_optimal_limited_nm,
                at.torque_Nm(clamped->at), SEARCHED, drive.max_torque_Nm);
    check_breakdown(drive, at, clamped->at, limited(result), SEARCHED, SEARCHED_POWER);
    const auto edge =
        circuit::minimum(at.direction() / drive.max_torque_Nm * at.torque_Nm,
                         joined(electrical, {1.0 / drive.max_power_W * at.dc_power_W}), {},
                         drive.max_current_A, STARTS);
    if (CHECK(edge.has_value())) {
        check_close("torque_zero_nm", result.torque_zero_nm, at.torque_Nm(edge->at), SEARCHED,
                    drive.max_torque_Nm);
    }
}

} // namespace

static void test_solve_without_d_current_gives_the_stationary_points_of_the_circuit()
{
    int possible = 0, asked = 0;
    for (const values::Solved &result : values::SOLVED) {
        if (!result.free_d_current) {
            check_closed_form(result);
            asked++;
            possible += result.regeneration_possible ? 1 : 0;
        }
    }
    CHECK(asked == 200);
    CHECK(possible > 180);
}

static void test_solve_with_both_currents_gives_the_least_power_inside_all_limits()
{
    int asked = 0;
    for (const values::Solved &result : values::SOLVED) {
        if (result.free_d_current && asked++ % EVERY == 0) {
            check_joint(result);
        }
    }
    CHECK(asked == 200);
}

static void test_evaluate_gives_the_least_power_that_makes_a_torque()
{
    int asked = 0, driving = 0;
    for (const values::Evaluated &result : values::EVALUATED) {
        if (result.free_d_current && !result.inside_limits) {
            continue; // no currents inside the limits make it: nothing is promised but that it is
                      // stated
        }
        if (asked++ % EVERY != 0) {
            continue;
        }
        const Drive &drive = drive_of(result);
        const Circuit at = circuit_of(result);
        const std::string name = drive.name;
        SHOW(name);
        std::optional<Vector2d> i = at.of_torque_without_d_current(result.torque_nm);
        if (result.free_d_current) {
            const Form asked_for =
                1.0 / drive.max_torque_Nm * at.torque_Nm + -result.torque_nm / drive.max_torque_Nm;
            const auto best = circuit::minimum(at.dc_power_W, electrical_limits(drive, at),
                                               {asked_for}, drive.max_current_A, STARTS);
            if (!CHECK(best.has_value())) {
                continue;
            }
            i = best->at;
        }
        if (!CHECK(i.has_value())) {
            continue;
        }
        driving += result.torque_nm * result.speed_rpm > 0.0 ? 1 : 0;
        const double share = result.free_d_current ? SEARCHED : EXACT;
        check_breakdown(drive, at, *i, breakdown(result), share,
                        result.free_d_current ? SEARCHED_POWER : EXACT);
        check_close("voltage_d_v", result.voltage_d_v, at.voltage_V(*i)[0], share,
                    drive.open_circuit_V);
        check_close("voltage_q_v", result.voltage_q_v, at.voltage_V(*i)[1], share,
                    drive.open_circuit_V);
    }
    CHECK(asked > 300);
    CHECK(driving * EVERY > 100);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_solve_without_d_current_gives_the_stationary_points_of_the_circuit);
    RUN_TEST(test_solve_with_both_currents_gives_the_least_power_inside_all_limits);
    RUN_TEST(test_evaluate_gives_the_least_power_that_makes_a_torque);
    return UNITY_END();
}
